#pragma once

/// Tries a scenario in simulation: what its posture is worth.

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "cli/hand/lay_object.h"
#include "cli/hand/use_trial.h"
#include "core/hand/scenario.h"
#include "core/posture/ball_grasp.h"
#include "core/posture/way_in.h"
#include "core/session/session.h"
#include "core/world/stepper_choice.h"
#include "core/world/world.h"

namespace regrasp::hand {

/// A session that has grasped its scenario's object at noise `paper`, or why not.
struct Grasped {
  std::unique_ptr<Session> session;
  std::string end;
  bool held() const;
};
Grasped GraspWith(const LoadedScenario& model, Stepper stepper, std::uint64_t seed);

struct HoldTrial {
  bool held = false;
  std::string end;      ///< why not
  double moved_m = 0;   ///< of the object while it was held
  double margin_n = 0;  ///< least load margin without a finger, as the controller sees it; of a
                        ///< hand whose fingers cannot leave, with all
  int seeds = 0;        ///< with which it held
  /// Load margins of the object as it is held, with all fingers and without each: the least [N].
  double with_all_n = 0;
  std::array<double, kMaxFingers> without_n{};
};

inline constexpr double kHeldWithin = 0.010;  ///< an object that moves farther has slipped [m]

/// Grasps the scenario's object at noise `paper` and holds it for `seconds`.
HoldTrial TryToHold(const LoadedScenario& model, Stepper stepper, std::uint64_t seed,
                    double seconds);

inline constexpr double kHold = 5;  ///< [s] of a trial of Found
inline constexpr int kTrials = 6;   ///< seeds with which Found must hold

inline constexpr int kStarts = 16;  ///< seeds whose starts an object must be clear of

/// How the runs with kStarts seeds from this one on begin.
std::vector<Start> Starts(const LoadedScenario& model, std::uint64_t seed);

/// A grasp with its way in, in a scenario, and how it went where that was tried.
struct Found {
  BallGrasp grasp;
  WayIn way;
  LoadedScenario model;
  HoldTrial trial;
  UseTrial use;  ///< of the best that hold
  StepperChoice choice;
  int inside = 0;  ///< of kStarts, in which the object begins inside a link

  bool any() const { return !model.hand.links.empty(); }
  bool Holds() const { return any() && trial.held && way.stuck < 0; }
  bool Good() const { return Holds() && inside == 0; }
  /// With kTrials seeds from this one on, as long as it holds; `trial` tells the worst.
  void Try(std::uint64_t seed);
  bool Better(const Found& other) const;
};

}  // namespace regrasp::hand
