#pragma once

/// Models as text and as bytes: what run files and checkpoints hold of them.

#include <optional>
#include <string>
#include <string_view>

#include "core/hand/scenario.h"

namespace regrasp {

/// Every number and name of a hand, bit by bit: two hands are the same when these are.
std::string HandBytes(const HandModel& hand);

/// A model as JSON: {scenario, hand, object}. One line.
std::string ModelJson(const LoadedScenario& model);

/// The model that was written or read last, with its text: checkpoints of one model are written and
/// read without making, or parsing, that text again. For one thread.
class ModelText {
 public:
  /// ModelJson(model), valid until the next call.
  const std::string& Of(const LoadedScenario& model);
  /// Where a configuration (a ConfigText) ends with the text that Of() gave last: the rest of it,
  /// JSON whose "model" is null.
  std::optional<std::string> Without(std::string_view config) const;
  /// What Of() was asked for last, but for its report.
  const LoadedScenario& model() const { return model_; }

 private:
  std::string bytes_, text_;
  LoadedScenario model_;
};

}  // namespace regrasp
