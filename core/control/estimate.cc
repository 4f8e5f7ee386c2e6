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

const Estimate& StateEstimator::Update(const SensorReading& reading,
                                       const ControlParameters& parameters) {
  Estimate& e = estimate_;
  if (!started_) {
    e.q = reading.q;
    e.p_WO = reading.p_WO;
    e.q_WO = reading.q_WO;
    e.fingers.resize(hand_->fingers.size());
    started_ = true;
  }
  e.q += Gain(dt_, parameters.joint_filter_s) * (reading.q - e.q);
  ForwardKinematics(*hand_, e.q, &e.kinematics);
  const double pose_gain = Gain(dt_, parameters.pose_filter_s);
  e.p_WO += pose_gain * (reading.p_WO - e.p_WO);
  e.q_WO =
      FromRotationVector(pose_gain * RotationVector(reading.q_WO * e.q_WO.conjugate())) * e.q_WO;
  e.q_WO.normalize();

  const double contact_gain = Gain(dt_, parameters.contact_filter_s);
  const double force_gain = Gain(dt_, parameters.force_filter_s);
  double scale_sum = 0;
  int touching = 0;
  for (std::size_t i = 0; i < e.fingers.size(); ++i) {
    FingerEstimate& f = e.fingers[i];
    const FingertipReading& r = reading.fingertips[i];
    const Isometry3d& X_WL = e.kinematics.X_WL[hand_->fingers[i].tip_link];
    ContactFilter& filter = contact_[i];
    f.in_contact = r.in_contact;
    f.force += force_gain * ((r.in_contact ? r.force : 0.0) - f.force);
    if (r.in_contact) {
      const Vector3d p_L = X_WL.inverse() * r.p_WC;
      const Vector3d n_L = X_WL.linear().transpose() * r.normal_W;
      if (!f.ever_in_contact || f.ticks_without_contact * dt_ > parameters.contact_filter_s) {
        filter.p_L = p_L;
        filter.n_L = n_L;
        f.ticks_in_contact = 0;
      }
      // A fresh contact is averaged from its first sample on, so that the filter starts unbiased.
      const double gain = std::max(contact_gain, 1.0 / (1.0 + f.ticks_in_contact));
      filter.p_L += gain * (p_L - filter.p_L);
      filter.n_L += gain * (n_L - filter.n_L);
      f.ever_in_contact = true;
      f.ticks_without_contact = 0;
      ++f.ticks_in_contact;
    } else {
      ++f.ticks_without_contact;
    }
    f.lost = f.ticks_without_contact * dt_ > parameters.contact_lost_s - 0.5 * dt_;
    f.p_WF = FingertipCentre(*hand_, e.kinematics, static_cast<int>(i));
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
    e.object_scale += pose_gain * (scale - e.object_scale);
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
