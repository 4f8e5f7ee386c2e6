#pragma once

/// Small model files in a directory of their own, for the tests of the loaders.

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <string>

#include "core/hand/scenario.h"

namespace regrasp {

namespace fs = std::filesystem;

inline const char* const kHandUrdf = R"(<robot name="mini">
  <link name="palm"/>
  <link name="upper">
    <inertial><origin xyz="0 0 0.02"/><mass value="0.03"/>
      <inertia ixx="4e-6" ixy="0" ixz="0" iyy="4e-6" iyz="0" izz="1e-6"/></inertial>
    <collision><geometry><box size="0.01 0.01 0.04"/></geometry></collision>
  </link>
  <link name="tip">
    <inertial><mass value="0.01"/><inertia ixx="2e-6" ixy="0" ixz="0" iyy="2e-6" iyz="0" izz="1e-6"/></inertial>
    <collision><origin xyz="0 0 0.01"/><geometry><cylinder radius="0.005" length="0.02"/></geometry></collision>
  </link>
  <joint name="A" type="revolute"><parent link="palm"/><child link="upper"/><origin xyz="0 0 0.1"/>
    <axis xyz="2 0 0"/><limit lower="0" upper="1.5" effort="2" velocity="10"/><dynamics damping="0.05"/></joint>
  <joint name="B" type="revolute"><parent link="upper"/><child link="tip"/><origin xyz="0 0 0.04"/>
    <axis xyz="1 0 0"/><limit lower="-0.5" upper="1.5" effort="1" velocity="10"/></joint>
</robot>
)";

inline const char* const kScenarioToml = R"(object = "ball"
gravity_m_s2 = [0, 0, -9.81]
armature_kg_m2 = 1e-4
[object_pose]
position_m = [0, -0.05, 0.1]
[[finger]]
name = "only"
tip_link = "tip"
[q_preshape_deg]
A = 10
B = 20.5
[q_closed_deg]
A = 60
B = 70
)";

inline const char* const kBallUrdf = R"(<robot name="ball"><link name="object">
  <inertial><mass value="0.08"/><inertia ixx="2e-5" ixy="0" ixz="0" iyy="2e-5" iyz="0" izz="2e-5"/></inertial>
  <collision><geometry><sphere radius="0.025"/></geometry></collision>
</link></robot>
)";

inline const char* const kTetrahedron = R"(v 0 0 0
v 0.03 0 0
v 0 0.03 0
v 0 0 0.03
f 1 3 2
f 1 2 4
f 1 4 3
f 2 3 4
)";

inline std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// A models directory of its own, with a hand "mini" and an object "ball".
class LoaderTest : public testing::Test {
 protected:
  LoaderTest() {
    std::string name = (fs::temp_directory_path() / "regrasp_loader_XXXXXX").string();
    EXPECT_NE(mkdtemp(name.data()), nullptr);
    root_ = name;
    fs::create_directories(root_ / "hands");
    fs::create_directories(root_ / "objects");
    Write("hands/mini.urdf", kHandUrdf);
    Write("hands/mini.toml", kScenarioToml);
    Write("objects/ball.urdf", kBallUrdf);
  }
  ~LoaderTest() override { fs::remove_all(root_); }

  void Write(const std::string& file, const std::string& text) {
    std::ofstream(root_ / file) << text;
  }
  void EditHand(const std::string& from, const std::string& to) {
    Write("hands/mini.urdf", Replaced(kHandUrdf, from, to));
  }
  void EditScenario(const std::string& from, const std::string& to) {
    Write("hands/mini.toml", Replaced(kScenarioToml, from, to));
  }
  void EditBall(const std::string& from, const std::string& to) {
    Write("objects/ball.urdf", Replaced(kBallUrdf, from, to));
  }
  LoadedScenario Load(const std::string& hand = "mini", const std::string& object = "") const {
    return LoadScenario(hand, object, {root_});
  }
  /// Loading must throw a ModelError that contains every one of `words`.
  void ExpectRefused(std::initializer_list<const char*> words, const std::string& hand = "mini",
                     const std::string& object = "") const {
    const std::string said = Refusal(hand, object);
    for (const char* word : words)
      EXPECT_NE(said.find(word), std::string::npos) << word << " not in: " << said;
  }
  /// What loading is refused with.
  std::string Refusal(const std::string& hand = "mini", const std::string& object = "") const {
    try {
      Load(hand, object);
      ADD_FAILURE() << "was not refused";
    } catch (const ModelError& error) {
      return error.what();
    }
    return "";
  }

  fs::path root_;
};

}  // namespace regrasp
