#pragma once

namespace regrasp {

/// Placeholder order: see parameters.cc for units, ranges and sources.
struct ControlParameters {
  double grip_force = 1.0;                ///< preferred normal force of a holding finger [N]
  double stability_threshold = 0.5;       ///< `switched`: below it stability is maximised
};

}  // namespace regrasp
