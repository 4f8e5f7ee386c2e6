#include "core/session/session_impl.h"

namespace regrasp {

void Session::Impl::Feel(const SensorReading& reading) {
  const ShapeParameters& shape = parameters.shape;
  if (tick % Ticks(shape.interval_s, dt) != 0) return;
  if (!parameters.gait.map) felt.Reset();
  const Estimate& e = estimator.estimate();
  // The sensed pose lags behind the contacts, which move with the joint angles.
  const double late_s = reading.object_rate_hz > 0  // the estimator makes up for it
                            ? 0
                            : parameters.control.pose_filter_s - parameters.control.joint_filter_s;
  const Quaterniond q_OW = (FromRotationVector(late_s * motion.w_W) * e.q_WO).conjugate();
  const Vector3d p_WO = e.p_WO + late_s * motion.v_W;
  for (const FingerEstimate& f : e.fingers)
    if (f.in_contact && f.force >= shape.least_force && f.ticks_in_contact * dt >= shape.settled_s)
      // Without the map the present contacts are all that is known, and known for sure.
      felt.Add(q_OW * (f.p_WC - p_WO), q_OW * f.normal_W, parameters.gait.map ? 1 : shape.full);
}

void Session::Impl::FeelFriction() {
  const bool known = felt_friction.known(parameters.control);
  felt_friction.Update(hand, estimator.estimate(), tasks, torque, parameters.gravity_W,
                       parameters.control, dt);
  if (known || !felt_friction.known(parameters.control)) return;
  CountOn();
  log.Emit(tick, EventKind::kFriction, -1, felt_friction.felt(),
           "friction felt: %.2f; the controller counts on %.2f", felt_friction.felt(),
           control.friction_estimate);
}

void Session::Impl::CountOn() {
  control = parameters.control;
  felt.Use(parameters.shape);
  if (!parameters.gait.plan || parameters.gait.friction_share <= 0) return;
  const Activity* running = Running(state);
  if (running && running->Dares(parameters.gait)) control.feel_most = 1;
  control.friction_estimate = felt_friction.Counted(parameters.gait.friction_share, control);
}

}  // namespace regrasp
