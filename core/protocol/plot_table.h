#pragma once

/// The pictures of `plot`: a row for each, its drawing in snapshots/plot_NAME.cc. The wire, the
/// command line with its help and completion, the daemon and run files follow from the row.

#include <algorithm>
#include <array>
#include <string_view>

namespace regrasp {

/// What a picture is drawn of.
enum class PlotOf {
  kHistory,         ///< frames and events
  kHistoryAndFelt,  ///< these, and the object's surface as felt, where there is one
  kFeltSurface,     ///< that surface and one frame; refused where nothing was felt
  kNewestFrame,     ///< one frame
  kExplorations,    ///< the last explorations
  kIncident,        ///< what led to the last drop; a run file has none
};

/// ROW(name on the wire, name in code, a PlotOf).
#define REGRASP_PLOTS(ROW)                   \
  ROW(comparison, Comparison, kExplorations) \
  ROW(contacts, Contacts, kHistoryAndFelt)   \
  ROW(gait, Gait, kHistory)                  \
  ROW(incident, Incident, kIncident)         \
  ROW(quality, Quality, kHistory)            \
  ROW(scene, Scene, kNewestFrame)            \
  ROW(shape, Shape, kFeltSurface)

struct PlotRow {
  std::string_view name;
  PlotOf of;
};
#define REGRASP_ROW(name, Name, of) PlotRow{#name, PlotOf::of},
inline constexpr auto kPlotTable = std::to_array<PlotRow>({REGRASP_PLOTS(REGRASP_ROW)});
#undef REGRASP_ROW

inline constexpr auto kPlotNames = [] {
  std::array<std::string_view, kPlotTable.size()> names;
  std::ranges::transform(kPlotTable, names.begin(), &PlotRow::name);
  return names;
}();

/// What the name of a picture ends in: its format.
inline constexpr std::array<std::string_view, 5> kPlotSuffixes = {".png", ".jpg", ".jpeg", ".pdf",
                                                                  ".svg"};

/// Parameters that say how a picture is printed, each on the wire and as it is typed: without a
/// printed width (`size_m`, --size) they would mean nothing, and are refused.
struct PrintedOnly {
  std::string_view name, flag;
};
inline constexpr std::array<PrintedOnly, 2> kPrintedOnly = {
    {{"dpi", "--dpi"}, {"font_size_pt", "--font-size"}}};

/// Null where there is no such picture.
constexpr const PlotRow* FindPlot(std::string_view name) {
  const auto row = std::ranges::find(kPlotTable, name, &PlotRow::name);
  return row == kPlotTable.end() ? nullptr : &*row;
}

}  // namespace regrasp
