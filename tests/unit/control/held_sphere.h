#pragma once

/// Noise-free readings of a hand whose fingertips all touch a sphere, made without a simulator.

#include <utility>

#include "core/control/estimate.h"
#include "core/hand/scenario.h"
#include "tests/physics/grasp_posture.h"

namespace regrasp {

inline LoadedScenario ShadowHand() { return LoadScenario("shadow", "sphere", ModelSearchPath()); }

/// Readings at the joint angles `q` [rad]: each fingertip touches at the point of its rounding
/// sphere that is nearest to the object's centre, with `force` [N].
inline SensorReading TouchingReading(const HandModel& hand, const JointVector& q, double force) {
  SensorReading reading;
  reading.q = q;
  reading.p_WO = GraspObjectPose().translation();
  KinematicsData kinematics;
  ForwardKinematics(hand, q, &kinematics);
  for (int i = 0; i < hand.num_fingers(); ++i) {
    const Vector3d tip = FingertipCentre(hand, kinematics, i);
    FingertipReading r;
    r.in_contact = true;
    r.normal_W = (tip - reading.p_WO).normalized();
    r.p_WC = tip - hand.fingers[static_cast<std::size_t>(i)].tip_radius * r.normal_W;
    r.force = force;
    reading.fingertips.push_back(r);
  }
  return reading;
}

/// Parameters without any filter: what is sensed is believed.
inline ControlParameters UnfilteredParameters() {
  ControlParameters p;
  p.joint_filter_s = p.force_filter_s = p.contact_filter_s = p.pose_filter_s = 0;
  p.contact_from_normal = false;
  return p;
}

/// What the estimator makes of TouchingReading() without filters.
inline Estimate TouchingEstimate(const HandModel& hand, const JointVector& q) {
  StateEstimator estimator(hand, 1e-3);
  return estimator.Update(TouchingReading(hand, q, 1.0), UnfilteredParameters());
}

}  // namespace regrasp
