#pragma once

/// Tries a scenario in simulation: what its posture is worth.

#include <cstdint>
#include <string>

#include "core/hand/scenario.h"
#include "core/posture/ball_grasp.h"
#include "core/posture/way_in.h"
#include "core/world/stepper_choice.h"
#include "core/world/world.h"

namespace regrasp::hand {

struct HoldTrial {
  bool held = false;
  std::string end;      ///< why not
  double moved_m = 0;   ///< of the object while it was held
  double margin_n = 0;  ///< least load margin without a finger, as the controller sees it
};

/// Grasps the scenario's object at noise `paper` and holds it for `seconds`.
HoldTrial TryToHold(const LoadedScenario& model, Stepper stepper, std::uint64_t seed,
                    double seconds);

inline constexpr double kHold = 5;  ///< [s] of a trial of Found

/// A grasp with its way in, in a scenario, and how it went where that was tried.
struct Found {
  BallGrasp grasp;
  WayIn way;
  LoadedScenario model;
  HoldTrial trial;
  StepperChoice choice;

  bool any() const { return !model.hand.links.empty(); }
  bool Good() const { return any() && trial.held && way.stuck < 0; }
  /// With `times` seeds from this one on, as long as it holds; `trial` tells the worst.
  void Try(std::uint64_t seed, int times);
  bool Better(const Found& other) const;
};

}  // namespace regrasp::hand
