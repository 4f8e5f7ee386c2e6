#pragma once

/// A hand made up for tests: equal fingers around a circle, bending towards its axis.

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "core/common/frames.h"

namespace regrasp {

/// `fingers` fingers of three joints (sideways, bend, bend) and rods of 50 and 40 mm on a circle of
/// 45 mm about the root's axis `R`.z. Links are named arm1a, arm1b, arm1c and so on. `wrist`: the
/// whole hand on one more joint.
inline std::string RadialHandUrdf(int fingers, const Matrix3d& R = Matrix3d::Identity(),
                                  bool wrist = false) {
  const auto rpy = [](const Matrix3d& M) {
    const double pitch = std::asin(-M(2, 0));
    return fmt::format("{:.9f} {:.9f} {:.9f}", std::atan2(M(2, 1), M(2, 2)), pitch,
                       std::atan2(M(1, 0), M(0, 0)));
  };
  const auto link = [](const std::string& name, double length, double radius) {
    return fmt::format(
        R"(<link name="{}"><inertial><origin xyz="0 0 {}"/><mass value="0.02"/>
<inertia ixx="5e-6" ixy="0" ixz="0" iyy="5e-6" iyz="0" izz="1e-6"/></inertial>
<collision><origin xyz="0 0 {}"/><geometry><cylinder radius="{}" length="{}"/></geometry></collision></link>
)",
        name, 0.5 * length, 0.6 * length, radius, 0.6 * length);
  };
  const auto joint = [](const std::string& name, const std::string& parent,
                        const std::string& child, const std::string& xyz, const std::string& turn,
                        const std::string& axis, double lower, double upper) {
    return fmt::format(
        R"(<joint name="{}" type="revolute"><parent link="{}"/><child link="{}"/>
<origin xyz="{}" rpy="{}"/><axis xyz="{}"/><limit lower="{}" upper="{}" effort="1" velocity="5"/></joint>
)",
        name, parent, child, xyz, turn, axis, lower, upper);
  };
  std::string text = "<robot name=\"radial\"><link name=\"palm\"/>\n";
  std::string base = "palm";
  if (wrist) {
    base = "carpus";
    text +=
        "<link name=\"carpus\"><inertial><mass value=\"0.1\"/><inertia ixx=\"1e-4\" ixy=\"0\" "
        "ixz=\"0\" iyy=\"1e-4\" iyz=\"0\" izz=\"1e-4\"/></inertial></link>\n" +
        joint("W", "palm", "carpus", "0 0 0", "0 0 0", "1 0 0", -0.5, 0.5);
  }
  for (int f = 0; f < fingers; ++f) {
    const double angle = 2 * M_PI * f / fingers;
    const Vector3d p = R * Vector3d(0.045 * std::cos(angle), 0.045 * std::sin(angle), 0);
    // x outward, so that turning about -y bends towards the axis.
    const Matrix3d turn = R * Eigen::AngleAxisd(angle, Vector3d::UnitZ()).toRotationMatrix();
    const std::string n = fmt::format("arm{}", f + 1);
    text += fmt::format(
                "<link name=\"{}a\"><inertial><mass value=\"0.01\"/><inertia ixx=\"1e-6\" "
                "ixy=\"0\" ixz=\"0\" iyy=\"1e-6\" iyz=\"0\" izz=\"1e-6\"/></inertial></link>\n",
                n) +
            link(n + "b", 0.05, 0.008) + link(n + "c", 0.04, 0.008);
    text +=
        joint(n + "_side", base, n + "a", fmt::format("{:.9f} {:.9f} {:.9f}", p.x(), p.y(), p.z()),
              rpy(turn), "1 0 0", -0.6, 0.6) +
        joint(n + "_near", n + "a", n + "b", "0 0 0.01", "0 0 0", "0 -1 0", -0.3, 1.5) +
        joint(n + "_far", n + "b", n + "c", "0 0 0.05", "0 0 0", "0 -1 0", -0.2, 1.7);
  }
  return text + "</robot>\n";
}

}  // namespace regrasp
