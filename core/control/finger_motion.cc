#include "core/control/finger_motion.h"

#include <Eigen/Cholesky>

namespace regrasp {
namespace {

/// Lever arms well below it do not tell a rotation [m].
constexpr double kLeastArm = 0.002;

}  // namespace

RigidStep FitStep(std::span<const MovedPoint> points) {
  RigidStep step;
  if (points.empty()) return step;
  const double share = 1.0 / static_cast<double>(points.size());
  for (const MovedPoint& point : points) {
    step.about_W += share * point.p_W;
    step.dp_W += share * point.dp_W;
  }
  Matrix3d inertia = kLeastArm * kLeastArm * Matrix3d::Identity();
  Vector3d moment = Vector3d::Zero();
  for (const MovedPoint& point : points) {
    const Vector3d arm = point.p_W - step.about_W;
    inertia += share * (arm.squaredNorm() * Matrix3d::Identity() - arm * arm.transpose());
    moment += share * arm.cross(point.dp_W - step.dp_W);
  }
  step.turn_W = inertia.llt().solve(moment);
  return step;
}

}  // namespace regrasp
