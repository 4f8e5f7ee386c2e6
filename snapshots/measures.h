#pragma once

/// Columns of numbers taken out of a history. Internal to snapshots/.

#include <fmt/format.h>

#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "core/session/frame.h"

namespace regrasp {

inline constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

/// value(frame) for every frame; kNoValue leaves a gap in a curve.
inline std::vector<double> Column(std::span<const Frame> frames,
                                  const std::function<double(const Frame&)>& value) {
  std::vector<double> column;
  column.reserve(frames.size());
  for (const Frame& frame : frames) column.push_back(value(frame));
  return column;
}

inline std::vector<double> Times(std::span<const Frame> frames) {
  return Column(frames, [](const Frame& frame) { return frame.time_s; });
}

/// Noise-free manipulability of a finger [10⁻⁴ m³] while it touches the object.
inline double TrueManipulability(const Frame& frame, int finger) {
  const auto i = static_cast<std::size_t>(finger);
  if (finger < 0 || i >= frame.fingers.size() || !frame.fingers[i].true_contact) return kNoValue;
  return frame.fingers[i].true_manipulability;
}

/// Manipulability as the controller sees it [10⁻⁴ m³].
inline double SensedManipulability(const Frame& frame, int finger) {
  const auto i = static_cast<std::size_t>(finger);
  if (finger < 0 || i >= frame.fingers.size() || !frame.fingers[i].in_contact) return kNoValue;
  return frame.fingers[i].manipulability;
}

/// Whether the fingers hold the object by themselves, so that the measures of a grasp mean
/// something.
inline bool Holds(const Frame& frame) { return HoldsAlone(frame.state, frame.stand_in); }

/// Below it, `switched` maximises stability; known from the first tick on.
inline double Threshold(const Frame& frame) {
  return frame.tick > 0 ? frame.stability.threshold : kNoValue;
}

/// The finger that explores, -1 for none.
inline int ExploringFinger(const Frame& frame) {
  return frame.exploration.active ? frame.exploration.finger : -1;
}

/// Axis label of the stability measure that was selected in these frames; without its symbol where
/// it changed meanwhile.
inline std::string StabilityLabel(std::span<const Frame> frames) {
  if (frames.empty()) return "stability";
  const Measure measure = frames.back().stability.measure;
  for (const Frame& frame : frames)
    if (frame.stability.measure != measure) return "stability";
  const MeasureInfo& info = InfoOf(measure);
  return fmt::format("stability  {}{}{}{}", info.label, info.unit.empty() ? "" : " [", info.unit,
                     info.unit.empty() ? "" : "]");
}

/// Its symbol alone.
inline std::string StabilityShortLabel(std::span<const Frame> frames) {
  if (frames.empty()) return "stability";
  const MeasureInfo& info = InfoOf(frames.back().stability.measure);
  return fmt::format("{}{}{}{}", info.label, info.unit.empty() ? "" : " [", info.unit,
                     info.unit.empty() ? "" : "]");
}

}  // namespace regrasp
