#pragma once

/// A scenario file (models/README.md) as text.

#include <string>
#include <vector>

#include "core/hand/scenario.h"
#include "core/hand/urdf.h"

namespace regrasp {

struct ScenarioText {
  std::string urdf;                   ///< the hand's file, as the scenario shall name it
  std::vector<std::string> comments;  ///< lines at the top
  HandLayout layout;
  LoadOptions options;  ///< only what a scenario can say
  Scenario scenario;
};

/// TOML that LoadScenario() reads back as the same scenario, angles rounded to 0.01 deg. `hand`
/// names the driven joints.
std::string WriteScenario(const ScenarioText& text, const HandModel& hand);

}  // namespace regrasp
