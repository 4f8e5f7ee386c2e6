#include "cli/hand/held_ball.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "core/hand/scenario.h"

namespace regrasp::hand {
namespace {

/// The one that ships, or "".
const char* Shipped(double size_mm) {
  struct Ball {
    const char* name;
    double size_mm;
  };
  static constexpr Ball kBalls[] = {
      {"sphere_40mm", 40}, {"sphere_45mm", 45}, {"sphere", 50}, {"sphere_60mm", 60}};
  for (const Ball& ball : kBalls)
    if (std::abs(ball.size_mm - size_mm) < 0.01) return ball.name;
  return "";
}

}  // namespace

HeldBall BallOf(double size_mm, const std::string& file) {
  HeldBall ball;
  ball.name = Shipped(size_mm);
  if (!ball.name.empty()) {
    ball.model = LoadObject(ball.name, ModelSearchPath());
    return ball;
  }
  ball.name = file;
  ObjectModel& model = ball.model;
  model.name = std::filesystem::path(file).stem().string();
  model.radius = model.bounding_radius = 0.5e-3 * size_mm;
  model.mass = kBallMass;
  const std::string moment = fmt::format("{:.10g}", 0.4 * model.mass * model.radius * model.radius);
  model.I_OCom = std::stod(moment) * Matrix3d::Identity();
  ball.urdf = fmt::format(
      R"(<?xml version="1.0"?>
<!-- Homogeneous ball, {:g} mm in diameter, {:g} g. SI units. Made by `regrasp hand new`. -->
<robot name="ball">
  <link name="object">
    <inertial>
      <mass value="{}"/>
      <inertia ixx="{}" ixy="0" ixz="0" iyy="{}" iyz="0" izz="{}"/>
    </inertial>
    <collision>
      <geometry><sphere radius="{}"/></geometry>
    </collision>
  </link>
</robot>
)",
      size_mm, 1e3 * model.mass, model.mass, moment, moment, moment, model.radius);
  return ball;
}

}  // namespace regrasp::hand
