#pragma once

/// Tries what a grasp is made for: each finger explores, and the object turns once.

#include <array>
#include <cstdint>

#include "core/common/limits.h"
#include "core/hand/scenario.h"
#include "core/world/world.h"

namespace regrasp::hand {

struct UseTrial {
  int explorations = 0;  ///< by Algorithm 1, one a finger and seed
  int rose = 0;          ///< of them, at the end of which phi is higher (noise-free)
  /// Of them, refused because the finger may not leave; by finger.
  std::array<int, kMaxFingers> stayed{};
  int turns = 0;   ///< of 360° about the palm's -z, one a seed
  int turned = 0;  ///< of them, that were completed
  int clean = 0;   ///< of those, with the object within kCleanOffset and kCleanTilt

  bool any() const { return turns > 0; }
  UseTrial& operator+=(const UseTrial& more);
  /// 0 .. 3: the shares that rose, turned and were clean.
  double Points() const;
};

inline constexpr double kCleanOffset = 5;  ///< of the object's centre from its first place [mm]
inline constexpr double kCleanTilt = 10;   ///< of the axis that it turns about [deg]

/// Noise `paper`, `seeds` seeds from this one on, side by side. Where the object is not grasped
/// nothing rises and nothing turns.
UseTrial TryToUse(const LoadedScenario& model, Stepper stepper, std::uint64_t seed, unsigned seeds);

}  // namespace regrasp::hand
