#pragma once

#include <array>
#include <cstdio>

#include "core/world/start_overlap.h"

namespace regrasp {

/// What helps against it.
inline constexpr const char* kFitsObject =
    "regrasp hand new HAND --object FILE -o NAME.toml fits a hand to it";

/// "the object begins 5.1 mm inside the link ffdistal", for an overlap that forbids a grasp; empty
/// for one that does not.
inline std::array<char, 128> OverlapText(const StartOverlap& overlap, const HandModel& hand) {
  std::array<char, 128> text{};
  if (overlap.depth > kStartOverlap)
    std::snprintf(text.data(), text.size(), "the object begins %.1f mm inside the link %.60s",
                  1e3 * overlap.depth,
                  hand.links[static_cast<std::size_t>(overlap.link)].name.c_str());
  return text;
}

}  // namespace regrasp
