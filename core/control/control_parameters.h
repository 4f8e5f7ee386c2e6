#pragma once

#include "core/hand/reach_rule.h"
#include "core/quality/measures.h"

namespace regrasp {

/// Constants of the sensing filters, the object-level force control and the joint control. Unit,
/// range and source of each stand in the parameter table (core/session/parameters.cc).
struct ControlParameters {
  // Filters: time constants of first-order low passes [s].
  double joint_filter_s = 0.010;
  double force_filter_s = 0.010;
  double contact_filter_s = 0.030;
  double pose_filter_s = 0.050;
  double slow_pose_filter_s = 1.0;    ///< object pose from a sensor with a rate
  double slow_pose_velocity_s = 0.2;  ///< the object's motion by which its late pose is advanced
  double margin_filter_s = 0.050;     ///< load margins
  /// Contact point from the sensed normal and the fingertip's known shape.
  bool contact_from_normal = true;
  double fingertip_stiffness = 4000;  ///< how far a fingertip is pressed in per force [N/m]
  // Object wrench: PI law on the object pose.
  double position_stiffness = 200;      ///< [N/m]
  double position_integral = 300;       ///< [N/(m s)]
  double position_error_limit = 0.010;  ///< [m]
  double force_integral_limit = 1.5;    ///< about the start value, per axis [N]
  double rotation_stiffness = 0.15;     ///< [N m/rad]
  double rotation_integral = 0.2;       ///< [N m/(rad s)]
  double rotation_error_limit = 0.2;    ///< [rad]
  double torque_integral_limit = 0.03;  ///< per axis [N m]
  double mass_estimate =
      0.08;  ///< assumed mass of the object before the integral has learnt it [kg]
  // Contact forces (QP).
  double grip_force = 1.0;         ///< preferred normal force of a holding finger [N]
  double grip_weight = 0.02;       ///< weight of that preference
  double friction_estimate = 0.5;  ///< friction coefficient the controller counts on
  double min_normal_force = 0.1;   ///< [N]
  double max_normal_force = 4.0;   ///< [N]
  double residual_limit = 0.1;  ///< the integrals stop while the QP misses the wrench by more [N]
  double yield_s = 0.05;        ///< ... and the correction of the pose fades in so long; 0: never
  double resume_s = 0.2;        ///< it comes back in so long [s]
  double mass_filter_s = 1.0;   ///< mass borne lately: time constant [s]
  // Joints.
  double posture_stiffness = 0.1;  ///< in the null space of the contact force [N m/rad]
  double pinv_damping = 0.004;     ///< lambda of the damped pseudo-inverse of velocities [m]
  /// The same of the projection into the null space. At a singular value sigma of the Jacobian it
  /// lets lambda² / (sigma² + lambda²) of the posture torques press on the object: with 4 and 8 mm
  /// a fifth, which can take a third of the thumb's grip. 0.1 mm lets next to nothing through;
  /// turns are not shown to be the better for it.
  double projection_damping = 0.004;
  double limit_margin = 0.10;    ///< the limit spring begins this far from a joint limit [rad]
  double limit_stiffness = 1.0;  ///< [N m/rad]
  double free_stiffness = 1.0;   ///< joint stiffness of a finger that touches nothing [N m/rad]
  // Contact keeping.
  double reapproach_delay_s =
      0.020;                        ///< a holding finger without contact for so long moves in again
  double reapproach_speed = 0.020;  ///< [m/s]
  double reapproach_force = 0.15;   ///< [N]
  double contact_lost_s = 0.020;    ///< without contact for so long a finger carries nothing
  // Sliding finger: hybrid position/force control.
  double slide_stiffness = 300;    ///< tangential [N/m]
  double slide_force_limit = 0.8;  ///< largest tangential force [N]
  double slide_friction_share =
      0.6;  ///< share of the sliding finger's normal force assumed to drag on the object
  double slide_slow_speed = 0.001;     ///< below it the friction feedforward fades out [m/s]
  double normal_force_integral = 2.0;  ///< [1/s]
  // Friction, felt by fingers that slide (felt_friction.h).
  double feel_settled_s = 0.1;  ///< sliding for so long, a finger has the speed it is asked for
  double feel_speed = 0.002;    ///< it slides from this speed on [m/s]
  double feel_force = 0.1;      ///< ... pressed on with this force [N]
  double feel_memory_s = 2.0;   ///< the mean is over about so much of the last sliding
  double feel_enough_s = 0.14;  ///< ... which is known after so much
  double feel_least = 0.1;      ///< coefficient counted on, at least
  double feel_most = 0.7;       ///< ... and at most, however rough it feels
  // Grasping.
  /// Share of the object's way from where the closed posture is made for it that the posture
  /// follows, as sensed when the grasp begins.
  double follow_object = 1;
  double close_speed = 0.6;         ///< joints on their way from preshape to closed [rad/s]
  double close_force = 0.15;        ///< a finger that has touched waits with this force [N]
  double touch_s = 0.005;           ///< contact for so long is a touch
  double search_s = 2.0;            ///< after the closed posture contact is sought so long ...
  double search_speed = 0.02;       ///< ... by moving towards the object [m/s]
  double grip_ramp_s = 0.3;         ///< from waiting force to grip
  double stand_in_release_s = 0.5;  ///< after the ramp the stand-in lets go
  double settle_s = 0.7;            ///< then so long until `holding`
  double rest_speed = 0.002;        ///< of the object, above which it is not held yet [m/s]
  double rest_s = 3;  ///< after settling, to come to rest; what moves one way then is not held
  // How a finger is taken to follow an object that turns: gait and the criterion reserve.
  ReachRule reach;
  // Stability.
  Measure stability_measure = Measure::kMinSingularValue;  ///< what stability means
  double stability_hysteresis = 1.05;  ///< once it is, it stays so up to so much of the threshold
  double stability_threshold = 0.30;   ///< `switched`: below it stability is maximised
  double drop_contact_s = 0.25;        ///< fewer than two contacts for so long: dropped
  double release_s = 0.5;              ///< from letting go to idle
  double release_pull = 12.0;     ///< every finger leaves with this force, so that none drags [N]
  double release_pull_s = 0.010;  ///< ... for so long
  double drop_distance = 0.030;   ///< object this far from its reference: dropped [m]
};

}  // namespace regrasp
