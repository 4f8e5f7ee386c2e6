#pragma once

#include <array>
#include <cstdio>

#include "core/common/reason.h"
#include "core/world/start_overlap.h"

namespace regrasp {

/// What helps against it.
inline constexpr const char* kFitsObject =
    "regrasp hand new HAND --object FILE -o NAME.toml fits a hand to it";

/// "the object begins 5.1 mm inside the link ffdistal", for an overlap that forbids a grasp; empty
/// for one that does not. A refusal has room for kFitsObject, too.
inline std::array<char, kReasonRoom - 96> OverlapText(const StartOverlap& overlap,
                                                      const HandModel& hand) {
  std::array<char, kReasonRoom - 96> text{};
  if (overlap.depth > kStartOverlap)
    std::snprintf(text.data(), text.size(), "the object begins %.1f mm inside the link %s",
                  1e3 * overlap.depth,
                  hand.links[static_cast<std::size_t>(overlap.link)].name.c_str());
  return text;
}

}  // namespace regrasp
