#pragma once

/// What exploration maximises: manipulability of the exploring finger, stability of the grasp, a
/// switch between them (Sec. II), their linear sum (the dotted line of Fig. 2), or the motion
/// reserve of the exploring finger.

#include "core/control/estimate.h"
#include "core/exploration/criterion.h"
#include "core/exploration/exploration_parameters.h"
#include "core/hand/hand_model.h"

namespace regrasp {

struct ObjectiveValue {
  double phi = 0;             ///< of order 1
  bool on_stability = false;  ///< kSwitched: stability is what counts at present
};

/// Stability of the grasp by `fingers`: the measure selected by
/// `parameters.stability_measure` from sensed contacts, torques divided by the estimated object
/// scale. The measure must be fit for a tick (see MayMaximise).
double GraspStability(const Estimate& estimate, FingerSet fingers,
                      const ControlParameters& parameters);

/// Whether exploration by `criterion` can maximise what `parameters` say that stability is: a
/// measure that is too slow for a tick it cannot.
inline bool MayMaximise(Criterion criterion, const ControlParameters& parameters) {
  return !InfoOf(criterion).takes_stability ||
         InfoOf(parameters.stability_measure).cost == MeasureCost::kTick;
}

/// The unit vector along exploration.turn_axis; zero where that is shorter than 1e-9.
inline Vector3d TurnAxisOf(const ExplorationParameters& exploration) {
  const double length = exploration.turn_axis_W.norm();
  return length < 1e-9 ? Vector3d(Vector3d::Zero()) : Vector3d(exploration.turn_axis_W / length);
}

/// What phi is asked for.
struct ObjectiveOf {
  Criterion criterion = Criterion::kManipulability;
  int finger = -1;
  FingerSet fingers;                        ///< the grasp, which includes `finger`
  Vector3d turn_axis_W = Vector3d::Zero();  ///< of the coming turn, sense included; takes_turn_axis
  double margin = 0;  ///< load margin rho of that grasp [N]; takes_load_margin
};

/// phi. `was_on_stability`: result of the previous call; kSwitched returns to manipulability only
/// 5 % above the threshold. kReserve, in rad, with the weights c of `exploration`:
///
///   phi = MotionReserve + c_m manipulability − c_ρ max(0, ρ wanted − ρ)
///
/// the reserve by control.reach, as the gait counts it, with joints exploration.limit_margin inside
/// their limits, at most kMostReserve: from there on, or without an axis, the others decide.
ObjectiveValue Objective(const HandModel& hand, const ObjectiveOf& of, const Estimate& estimate,
                         const ControlParameters& control, const ExplorationParameters& exploration,
                         bool was_on_stability);
inline constexpr double kMostReserve = 2.0;  ///< [rad]

}  // namespace regrasp
