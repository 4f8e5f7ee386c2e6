#pragma once

/// The pictures of `plot` by name (core/protocol/plot_table.h), whoever asks for them.

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/protocol/plot_table.h"
#include "snapshots/snapshots.h"

namespace regrasp {

/// A stretch of a run, to be compared with others.
struct PlotRun {
  std::vector<Frame> frames;  ///< oldest first
  std::string object_name;    ///< empty: left out of the facts
  std::string changed;        ///< the parameters that differ from their defaults
};

/// What pictures are drawn of; each takes what its row names.
struct PlotInput {
  std::vector<Frame> frames;  ///< oldest first
  std::vector<Event> events;
  std::shared_ptr<const FeltSurface> felt;  ///< may be null
  std::vector<PlotRun> explorations;        ///< oldest first
  IncidentNote incident;
  HandModel hand;
  ObjectModel object;
  PlotOptions options;
};

/// Draws into `path`. Throws std::runtime_error as the functions of snapshots.h do, and where there
/// is no picture of this name.
void DrawPlot(std::string_view name, const PlotInput& input, const std::string& path);

// DrawContacts in plot_contacts.cc and so on, one for each row.
#define REGRASP_ROW(name, Name, of) \
  void Draw##Name(const PlotInput& input, const std::string& path);
REGRASP_PLOTS(REGRASP_ROW)
#undef REGRASP_ROW

}  // namespace regrasp
