#pragma once

/// The picture of `regrasp object show`.

#include <span>
#include <string>

#include "snapshots/snapshots.h"

namespace regrasp {

/// A line of the table beside it; `below`: of the row before.
struct TableRow {
  std::string name, value;
  bool below = false;
};

/// An object alone, in the axes of its file about the centre of mass, from two sides, with
/// `rows` beside it. Errors as in snapshots.h.
void PlotObject(const ObjectModel& object, std::span<const TableRow> rows,
                const PlotOptions& options, const std::string& path);

}  // namespace regrasp
