#pragma once

/// Objects as strangers bring them, for the tests of the loaders.

#include <array>
#include <string>
#include <vector>

#include "core/hand/solid.h"
#include "tests/unit/hand/model_files.h"

namespace regrasp {

using Corners = std::array<Vector3d, 3>;

/// Triangles of an L of 20 x 20 mm section, 60 mm long and 40 mm high: concave.
inline std::vector<Corners> Ell() {
  const Eigen::Vector2d outline[] = {{0, 0}, {60, 0}, {60, 20}, {20, 20}, {20, 40}, {0, 40}};
  const int faces[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}};
  const auto at = [&](int i, double z) {
    return Vector3d(outline[i].x() - 25, outline[i].y() - 15, z - 10);
  };
  std::vector<Corners> triangles;
  for (const auto& f : faces) {
    triangles.push_back({at(f[0], 20), at(f[1], 20), at(f[2], 20)});
    triangles.push_back({at(f[0], 0), at(f[2], 0), at(f[1], 0)});
  }
  for (int i = 0; i < 6; ++i) {
    const int j = (i + 1) % 6;
    triangles.push_back({at(i, 0), at(j, 0), at(j, 20)});
    triangles.push_back({at(i, 0), at(j, 20), at(i, 20)});
  }
  return triangles;
}
inline constexpr double kEllVolume = 60 * 20 * 20 + 20 * 20 * 20;  // [mm³]

class WildTest : public LoaderTest {
 protected:
  /// An object of 40 g whose <link> holds `more` beside its mesh.
  ObjectModel Load(const std::string& mesh, const std::string& more = "",
                   const std::string& robot = "") {
    Write(
        "objects/thing.urdf",
        R"(<?xml version="1.0"?><robot xmlns:xacro="http://ros.org/wiki/xacro" name="thing">)" +
            robot +
            R"(<link name="object"><inertial><mass value="0.04"/><inertia ixx="1e-5" ixy="0" ixz="0" iyy="1e-5" iyz="0" izz="1e-5"/></inertial>
<collision><geometry>)" +
            mesh + "</geometry></collision>" + more + "</link></robot>");
    LoadOptions options;
    options.inertia_from_shape = true;
    return LoadObject((root_ / "objects/thing.urdf").string(), {}, options);
  }
  std::string Refusal(const std::string& mesh, const std::string& more = "",
                      const std::string& robot = "") {
    try {
      Load(mesh, more, robot);
    } catch (const ModelError& error) {
      return error.what();
    }
    return "taken";
  }
  void ExpectEll(const ObjectModel& object) const {
    EXPECT_EQ(object.triangles.size(), 20u);
    EXPECT_NEAR(ObjectSolid(object).volume, kEllVolume * 1e-9, 1e-6 * kEllVolume * 1e-9);
  }
  static constexpr const char* kMillimetres = R"( scale="0.001 0.001 0.001"/>)";
};

}  // namespace regrasp
