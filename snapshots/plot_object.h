#pragma once

/// The picture of `regrasp object show`.

#include "snapshots/snapshots.h"

namespace regrasp {

/// An object alone, in the axes of its file about the centre of mass, from two sides, with
/// `lines` beside it. Errors as in snapshots.h.
void PlotObject(const ObjectModel& object, std::span<const std::string> lines,
                const PlotOptions& options, const std::string& path);

}  // namespace regrasp
