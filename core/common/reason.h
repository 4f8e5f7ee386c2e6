#pragma once

/// How long what is told of a run may be, where no string may grow. What is composed of names is
/// not cut: a reason has room for two of them and a sentence, an event for a reason and what stands
/// before it.

#include <array>
#include <cstddef>

namespace regrasp {

inline constexpr std::size_t kMaxNameBytes = 128;  ///< of a file, a model or a part of one

inline constexpr std::size_t kReasonRoom = 2 * kMaxNameBytes + 192;  ///< with the 0 at its end
inline constexpr std::size_t kEventRoom = kReasonRoom + 64;

using ReasonText = std::array<char, kReasonRoom>;

}  // namespace regrasp
