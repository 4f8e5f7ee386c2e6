#pragma once

/// Words of `regraspd`'s options that no method of the wire takes: the daemon checks them, the
/// command line completes them.

#include <array>
#include <string_view>

namespace regrasp {

inline constexpr auto kClockWords = std::to_array<std::string_view>({"continuous", "lockstep"});
/// Of core/world's Stepper.
inline constexpr auto kSteppers = std::to_array<std::string_view>({"fast", "exact", "round"});
/// What `regraspd --stepper` takes, in alphabetical order.
inline constexpr auto kStepperWords =
    std::to_array<std::string_view>({"auto", "exact", "fast", "round"});

}  // namespace regrasp
