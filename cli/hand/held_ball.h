#pragma once

/// The ball that a grasp is searched for: one that ships, or one of its own beside the scenario.

#include <string>

#include "core/hand/object_model.h"

namespace regrasp::hand {

inline constexpr double kBallMass = 0.08;  ///< whatever its size, as those that ship [kg]

struct HeldBall {
  std::string name;   ///< as the scenario names it
  ObjectModel model;  ///< 80 g, homogeneous
  std::string urdf;   ///< text of its own file; empty: it ships
};

/// A ball `size_mm` across; where none of that size ships, of the file `file` beside the scenario.
HeldBall BallOf(double size_mm, const std::string& file);

}  // namespace regrasp::hand
