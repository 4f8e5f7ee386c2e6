#pragma once

/// Tries a scenario in simulation: what its posture is worth.

#include <cstdint>
#include <string>

#include "core/hand/scenario.h"
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

}  // namespace regrasp::hand
