#include "core/gait/forgiveness.h"

namespace regrasp {

void Forgiveness::Start(const ObjectWrench& wrench) {
  *this = Forgiveness();
  q_start_ = wrench.q_ref();
  p_start_ = wrench.p_ref();
}

void Forgiveness::Watch(const ControlTick& tick, double held_s) {
  if (held_s >= tick.gait.recover_limit_s - tick.gait.still_s) return;
  p_still_ = tick.estimate.p_WO;
  q_still_ = tick.estimate.q_WO;
}

double Forgiveness::Forgive(const ControlTick& tick, const Vector3d& axis_W, bool held,
                            ObjectWrench* wrench) {
  const GaitParameters& gait = tick.gait;
  const Estimate& estimate = tick.estimate;
  const Vector3d position = wrench->p_ref() - estimate.p_WO;
  const Vector3d rotation = RotationVector(wrench->q_ref() * estimate.q_WO.conjugate());
  const bool disturbed = position.norm() > gait.recovered * gait.abort_position ||
                         rotation.norm() > gait.recovered * gait.abort_rotation;
  const bool still =
      held && (estimate.p_WO - p_still_).norm() < gait.still_position &&
      RotationVector(estimate.q_WO * q_still_.conjugate()).norm() < gait.still_rotation;
  if (!gait.forgive || !disturbed || (tick.margins.all < gait.forgive_margin && !still)) return 0;
  const Vector3d kept = LimitNorm(rotation, gait.forgive_rotation);
  const Quaterniond q_new = (FromRotationVector(kept) * estimate.q_WO).normalized();
  const double turned = RotationVector(q_new * wrench->q_ref().conjugate()).dot(axis_W);
  wrench->SetReference(estimate.p_WO + LimitNorm(position, gait.forgive_position), q_new);
  ++times_;
  return turned;
}

Vector3d Forgiveness::TiltOwed(const ObjectWrench& wrench, const Vector3d& axis_W,
                               double turned) const {
  const Quaterniond ideal = FromRotationVector(turned * axis_W) * q_start_;
  return TangentPart(RotationVector(ideal * wrench.q_ref().conjugate()), axis_W);
}

double Forgiveness::tilt_owed(const ObjectWrench& wrench, const Vector3d& axis_W,
                              double turned) const {
  return TiltOwed(wrench, axis_W, turned).norm();
}

ObjectMotion Forgiveness::WinBack(const GaitParameters& gait, const ObjectWrench& wrench,
                                  const Vector3d& axis_W, double turned, double step) const {
  ObjectMotion per_rad;
  per_rad.w_W = LimitNorm(TiltOwed(wrench, axis_W, turned), gait.win_back_rotation) / step;
  per_rad.v_W = LimitNorm(Vector3d(p_start_ - wrench.p_ref()), gait.win_back_position) / step;
  return per_rad;
}

}  // namespace regrasp
