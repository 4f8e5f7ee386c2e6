#include "core/control/estimate.h"

#include <algorithm>

#include "core/quality/manipulability.h"

namespace regrasp {
namespace {

/// Weight of the new sample in a first-order low pass.
double Gain(double dt, double time_constant) { return dt / (time_constant + dt); }

/// The point of the fingertip's surface whose outward direction is -n_L, next to p_L: the tip is a
/// capsule of known size, pressed in by `yield` [m], and 2 degrees of normal noise move the point
/// far less than 1 mm of position noise. Links without a capsule keep p_L.
Vector3d OnFingertip(const Link& tip, const Vector3d& p_L, const Vector3d& n_L, double yield) {
  for (const Shape& shape : tip.shapes) {
    if (shape.kind != Shape::Kind::kCapsule) continue;
    const Vector3d d = shape.b_L - shape.a_L;
    const double length2 = d.squaredNorm();
    const double s = length2 > 0 ? std::clamp((p_L - shape.a_L).dot(d) / length2, 0.0, 1.0) : 0.0;
    return shape.a_L + s * d - std::max(0.5 * shape.radius, shape.radius - yield) * n_L;
  }
  return p_L;
}

}  // namespace

RigidStep StateEstimator::StepOf(const JointVector& dq, FingerSet holding) const {
  FixedVector<MovedPoint, kMaxFingers> points;
  for (int i : holding) {
    const FingerEstimate& f = estimate_.fingers[i];
    if (!f.in_contact) continue;
    Vector3d dp_W = Vector3d::Zero();
    const std::vector<int>& joints = hand_->fingers[i].joints;
    for (std::size_t j = 0; j < joints.size(); ++j) dp_W += f.J.col(j) * dq[joints[j]];
    points.push_back({f.p_WC, dp_W});
  }
  return FitStep({points.data(), points.size()});
}

void StateEstimator::UpdatePose(const SensorReading& reading, const ControlParameters& parameters,
                                const RigidStep& step) {
  Estimate& e = estimate_;
  double gain = Gain(dt_, parameters.pose_filter_s);
  Vector3d late_p = Vector3d::Zero(), late_turn = Vector3d::Zero();
  if (reading.object_rate_hz > 0) {
    const double velocity_gain = Gain(dt_, parameters.slow_pose_velocity_s);
    e.p_WO += step.At(e.p_WO);
    e.q_WO = FromRotationVector(step.turn_W) * e.q_WO;
    velocity_W_ += velocity_gain * (step.At(e.p_WO) / dt_ - velocity_W_);
    spin_W_ += velocity_gain * (step.turn_W / dt_ - spin_W_);
    if (reading.object_tick != pose_tick_) {
      const double age_s = static_cast<double>(reading.tick - reading.object_tick) * dt_;
      gain = std::max(Gain(1 / reading.object_rate_hz, parameters.slow_pose_filter_s),
                      1.0 / (num_poses_ + 1));
      late_p = age_s * velocity_W_;
      late_turn = age_s * spin_W_;
    } else {
      gain = 0;
    }
  }
  if (gain > 0) num_poses_ = std::min(num_poses_ + 1, kManyPoses);
  pose_tick_ = reading.object_tick;
  e.p_WO += gain * (reading.p_WO + late_p - e.p_WO);
  e.q_WO = FromRotationVector(gain * RotationVector(FromRotationVector(late_turn) * reading.q_WO *
                                                    e.q_WO.conjugate())) *
           e.q_WO;
  e.q_WO.normalize();
}

Vector3d StateEstimator::NormalFromTaxel(int i, const Vector3d& p_L, const SensorReading& reading,
                                         bool fresh, const RigidStep& step,
                                         const Vector3d& p_WF_before) {
  const FingerEstimate& f = estimate_.fingers[i];
  Vector3d normal_W = f.p_WF - estimate_.p_WO;
  const double radius = std::max(1e-3, normal_W.norm());
  if (fresh) {
    normal_W /= radius;
  } else {
    const Vector3d before = f.normal_W + step.turn_W.cross(f.normal_W);
    const Vector3d way = f.p_WF - p_WF_before - step.At(p_WF_before);
    normal_W = (before + TangentPart(way, before) / radius).normalized();
  }
  TaxelContact& taxels = taxels_[static_cast<std::size_t>(i)];
  if (taxels.pitch() != reading.taxel_pitch_m)
    taxels = TaxelContact(MakeTipAxes(*hand_, i), reading.taxel_pitch_m);
  const Isometry3d& X_WL = estimate_.kinematics.X_WL[hand_->fingers[i].tip_link];
  return taxels.IntoCell(p_L, X_WL.linear().transpose() * normal_W);
}

const Estimate& StateEstimator::Update(const SensorReading& reading,
                                       const ControlParameters& parameters, FingerSet holding) {
  Estimate& e = estimate_;
  if (!started_) {
    e.q = reading.q;
    e.p_WO = reading.p_WO;
    e.q_WO = reading.q_WO;
    e.fingers.resize(hand_->fingers.size());
    started_ = true;
  }
  const JointVector dq = Gain(dt_, parameters.joint_filter_s) * (reading.q - e.q);
  e.q += dq;
  const bool followed = reading.object_rate_hz > 0 || reading.taxel_pitch_m > 0;
  const RigidStep step = followed ? StepOf(dq, holding) : RigidStep();
  ForwardKinematics(*hand_, e.q, &e.kinematics);
  UpdatePose(reading, parameters, step);

  const double contact_gain = Gain(dt_, parameters.contact_filter_s);
  const double force_gain = Gain(dt_, parameters.force_filter_s);
  double scale_sum = 0;
  int touching = 0;
  for (std::size_t i = 0; i < e.fingers.size(); ++i) {
    FingerEstimate& f = e.fingers[i];
    const FingertipReading& r = reading.fingertips[i];
    const Isometry3d& X_WL = e.kinematics.X_WL[hand_->fingers[i].tip_link];
    ContactFilter& filter = contact_[i];
    const Vector3d p_WF_before = f.p_WF;
    f.p_WF = FingertipCentre(*hand_, e.kinematics, static_cast<int>(i));
    f.in_contact = r.in_contact;
    f.force += force_gain * ((r.in_contact ? r.force : 0.0) - f.force);
    if (r.in_contact) {
      const Vector3d p_L = X_WL.inverse() * r.p_WC;
      const Vector3d n_L = X_WL.linear().transpose() * r.normal_W;
      const bool fresh =
          !f.ever_in_contact || f.ticks_without_contact * dt_ > parameters.contact_filter_s;
      if (fresh) {
        filter.p_L = p_L;
        filter.n_L = n_L;
        f.ticks_in_contact = 0;
      }
      // A fresh contact is averaged from its first sample on, so that the filter starts unbiased.
      const double gain = std::max(contact_gain, 1.0 / (1.0 + f.ticks_in_contact));
      filter.p_L += gain * (p_L - filter.p_L);
      filter.n_L += gain * (n_L - filter.n_L);
      if (reading.taxel_pitch_m > 0 && parameters.contact_from_normal)
        filter.n_L = NormalFromTaxel(static_cast<int>(i), p_L, reading, fresh, step, p_WF_before);
      f.ever_in_contact = true;
      f.ticks_without_contact = 0;
      ++f.ticks_in_contact;
    } else {
      ++f.ticks_without_contact;
    }
    f.lost = f.ticks_without_contact * dt_ > parameters.contact_lost_s - 0.5 * dt_;
    if (f.ever_in_contact) {
      const Vector3d n_L = filter.n_L.normalized();
      f.normal_W = X_WL.linear() * n_L;
      f.p_WC = X_WL * (parameters.contact_from_normal
                           ? OnFingertip(hand_->links[hand_->fingers[i].tip_link], filter.p_L, n_L,
                                         f.force / parameters.fingertip_stiffness)
                           : filter.p_L);
    } else {
      f.p_WC = f.p_WF;
    }
    f.J = PointJacobian(*hand_, e.kinematics, static_cast<int>(i), f.p_WC);
    f.manipulability = Manipulability(f.J) / kManipulabilityUnit;
    if (f.in_contact) {
      scale_sum += (f.p_WC - e.p_WO).norm();
      ++touching;
    }
  }
  if (touching > 0) {
    const double scale = std::max(0.005, scale_sum / touching);
    e.object_scale += Gain(dt_, parameters.pose_filter_s) * (scale - e.object_scale);
  }
  return e;
}

void StateEstimator::Derive() {
  Estimate& e = estimate_;
  ForwardKinematics(*hand_, e.q, &e.kinematics);
  for (std::size_t i = 0; i < e.fingers.size(); ++i) {
    FingerEstimate& f = e.fingers[i];
    f.p_WF = FingertipCentre(*hand_, e.kinematics, static_cast<int>(i));
    f.J = PointJacobian(*hand_, e.kinematics, static_cast<int>(i), f.p_WC);
    f.manipulability = Manipulability(f.J) / kManipulabilityUnit;
  }
}

Grasp GraspOf(const Estimate& estimate, FingerSet fingers, double mu) {
  Grasp grasp;
  for (int i : fingers) {
    const FingerEstimate& f = estimate.fingers[i];
    if (!f.ever_in_contact || f.lost) continue;
    grasp.push_back({f.p_WC - estimate.p_WO, -f.normal_W, mu});
  }
  return grasp;
}

}  // namespace regrasp
