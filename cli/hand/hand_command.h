#pragma once

/// What the verbs of regrasp-hand share.

#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <string_view>

#include "core/hand/scenario.h"
#include "core/protocol/errors.h"

namespace regrasp::hand {

using Json = nlohmann::ordered_json;

/// An error with its exit code and the next command to try.
class Failure : public std::runtime_error {
 public:
  Failure(ExitCode code_in, const std::string& cause, std::string next_in)
      : std::runtime_error(cause), code(code_in), next(std::move(next_in)) {}
  ExitCode code;
  std::string next;
};

struct Options {
  std::string verb, file;
  std::map<std::string, std::string> values;  ///< "--seed" -> "1"; flags -> ""
  bool Has(const std::string& flag) const { return values.contains(flag); }
  std::string Text(const std::string& flag, const std::string& otherwise = "") const {
    const auto found = values.find(flag);
    return found == values.end() ? otherwise : found->second;
  }
  /// Throws Failure(kUsage) where it is no number in the range.
  double Number(const std::string& flag, double otherwise, double min, double max) const;
  LoadOptions load() const {
    return {.force = Has("--force"),
            .inertia_from_shape = Has("--inertia-from-shape"),
            .fill_missing_meshes = Has("--fill-missing-meshes")};
  }
};

/// What is printed: `text` for people, `json` for programs.
struct Answer {
  Json json;
  std::string text;
  ExitCode code = ExitCode::kOk;
};

/// Everything about a hand: chains, tips, limits, fits, warnings, collisions at rest, the stepper
/// that suits it and why; --output draws it. A hand without a scenario is judged as it stands.
Answer CheckHand(const Options& options);

/// Writes a scenario for a URDF and tells how good its grasp is.
Answer NewHand(const Options& options);

/// What a hand of so few fingers cannot do; "" from four on.
std::string_view FewFingers(int fingers);

/// Why a hand whose fingers follow common motors, by a synergy say, will find no grasp; "" of
/// others.
std::string SharedMotors(const HandModel& hand);

/// "3 driven joints".
std::string DrivenJoints(const Finger& finger);

/// Draws the hand in its preshape.
void DrawHand(const LoadedScenario& model, const std::string& file);

}  // namespace regrasp::hand
