#include "snapshots/plot_experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <ranges>
#include <stdexcept>

#include "snapshots/axes.h"
#include "snapshots/experiment_marks.h"
#include "snapshots/refused.h"
#include "snapshots/snapshots.h"

namespace regrasp {
namespace {

constexpr double kTopOfAll = 150, kPanelTitle = 30, kBottom = 90, kLeft = 230, kRight = 40,
                 kGap = 46;
constexpr double kBetween = 80;  // columns: room for half a tick value of either
constexpr double kLabelSize = 18;
// On a narrow sheet the columns go one below the other, legends to the end.
constexpr double kNarrowTop = 104, kNarrowMargin = 14, kNarrowGap = 34, kXAxis = 74,
                 kNarrowLegend = 100;
constexpr double kRowHeight = 40;    // least
constexpr double kMostPerMark = 22;  // height

void DrawShare(Canvas* canvas, const Panel& panel, const ShareMark& mark, std::size_t which,
               double y, Colour colour) {
  const double row = y, at = panel.At(100 * mark.share, 0).x;
  canvas->Line({panel.At(100 * mark.low, 0).x, row}, {panel.At(100 * mark.high, 0).x, row},
               {colour, which == 0 ? 2.5 : 1.5});
  DrawShareMark(canvas, {at, row}, which, colour);
}

void DrawQuantiles(Canvas* canvas, const Panel& panel, const QuantileMark& q, double y,
                   double height, Colour colour) {
  if (!q.has_values) return;
  const auto x = [&](double value) { return panel.At(value, 0).x; };
  for (const double value : q.few) canvas->Mark(Marker::kDisc, {x(value), y}, 5, colour, colour);
  if (!q.few.empty()) return;
  canvas->Line({x(q.q05), y}, {x(q.q95), y}, {colour, 2});
  const double left = x(q.q25), width = std::max(1.0, x(q.q75) - left);
  canvas->FillBox({left, y - height / 2, width, height}, Tint(colour, 0.55));
  canvas->Line({x(q.median), y - height / 2 - 2}, {x(q.median), y + height / 2 + 2}, {colour, 3});
}

Axis MeasureAxis(const ExperimentPicture& picture, std::size_t which) {
  Range range;
  for (const auto& group : picture.groups)
    if (const QuantileMark& q = group.measures.at(which); !q.few.empty())
      range.Add(q.few);
    else if (q.has_values)
      for (const double value : {q.q05, q.q95}) range.Add(value);
  if (range.empty()) range.Add(0);
  return NiceAxis(range.lo, range.hi, 5, true, picture.measure_labels.at(which));
}

/// What stands where on the sheet.
struct Places {
  std::vector<std::string> rows, series, panels;
  std::size_t marks = 0, axes = 1;
  double row_height = 0;
  double gap = 0;        ///< between panels of one axis
  double axis_room = 0;  ///< below the last panel of an axis, where another axis follows there
  bool narrow = false;

  Places(const ExperimentPicture& picture, bool on_narrow_sheet)
      : rows(Distinct(picture, &ExperimentGroup::row)),
        series(Distinct(picture, &ExperimentGroup::series)),
        panels(Distinct(picture, &ExperimentGroup::panel)),
        marks(picture.groups.front().shares.size()),
        axes(1 + picture.measure_labels.size()),
        narrow(on_narrow_sheet) {
    const double lines = static_cast<double>(series.size() * std::max<std::size_t>(1, marks));
    row_height = std::max(kRowHeight, 15 * lines + 12);
    gap = narrow ? kNarrowGap : kGap;
    axis_room = narrow ? kXAxis + (named() ? kPanelTitle : 0) : 0;
  }
  bool named() const { return !panels.front().empty(); }
  double block() const { return row_height * static_cast<double>(rows.size()); }
  /// How many axes stand one below the other.
  double stacked() const { return narrow ? static_cast<double>(axes) : 1; }
  /// Of all panels, less what is between them.
  double Height() const { return stacked() * static_cast<double>(panels.size()) * block(); }
  double Between() const {
    return stacked() * (static_cast<double>(panels.size()) - 1) * gap + (stacked() - 1) * axis_room;
  }
  /// Least height of the sheet.
  double SheetHeight() const {
    const double rest = narrow ? kNarrowTop + kXAxis + kNarrowLegend : kTopOfAll + kBottom;
    return std::max(narrow ? 300.0 : 600.0,
                    rest + (named() ? kPanelTitle : 0) + Height() + Between());
  }
  Box Of(const Box& room, std::size_t axis, std::size_t panel) const {
    const double stretch = (room.height - Between()) / Height();
    const double height = block() * stretch, below = static_cast<double>(panel) * (height + gap);
    const auto a = static_cast<double>(axis), n = static_cast<double>(axes);
    if (!narrow) {
      const double width = (room.width - kBetween * (n - 1)) / n;
      return {room.x + a * (width + kBetween), room.y + below, width, height};
    }
    const double one = (room.height - (n - 1) * axis_room) / n;
    return {room.x, room.y + a * (one + axis_room) + below, room.width, height};
  }
};

void DrawRows(Canvas* canvas, const Places& places, const Panel& panel, bool names) {
  const double h = panel.area.height / static_cast<double>(places.rows.size());
  for (std::size_t r = 0; r < places.rows.size(); ++r) {
    const double y = panel.area.y + h * static_cast<double>(r);
    if (r > 0)
      canvas->Line({panel.area.x, y}, {panel.area.x + panel.area.width, y}, {kGridGrey, 1});
    if (names)
      canvas->Text({panel.area.x - 14, y + h / 2}, places.rows[r],
                   {.size = kLabelSize, .align_x = AlignX::kRight});
  }
}

/// The marks of a group on one axis: its shares (0), or one of its measures.
void DrawGroup(Canvas* canvas, const Places& places, const Panel& panel,
               const ExperimentGroup& group, std::size_t axis) {
  const double h = panel.area.height / static_cast<double>(places.rows.size());
  const std::size_t s = IndexOf(places.series, group.series);
  const double y = panel.area.y + h * static_cast<double>(IndexOf(places.rows, group.row));
  const auto n = static_cast<double>(places.series.size()),
             marks = static_cast<double>(places.marks);
  const double slot = std::min((h - 12) / n, kMostPerMark * marks);
  const double begin = y + (h - slot * n) / 2 + slot * static_cast<double>(s);
  if (axis > 0)
    return DrawQuantiles(canvas, panel, group.measures[axis - 1], begin + slot / 2,
                         std::min(16.0, slot * 0.6), ColourOfSeries(s));
  for (std::size_t m = 0; m < group.shares.size(); ++m)
    DrawShare(canvas, panel, group.shares[m], m,
              begin + slot * (static_cast<double>(m) + 0.5) / marks, ColourOfSeries(s));
}

/// Where the panels go. `layout` is used on a narrow sheet.
Box RoomOf(const Canvas& canvas, const Places& places, const Layout& layout, double top) {
  double left = places.narrow ? 0 : kLeft;
  const double margin = places.narrow ? kNarrowMargin : 40;
  for (const auto& row : places.rows)
    left = std::max(left, margin + 14 + canvas.TextWidth(row, kLabelSize));
  const double right = canvas.width() - (places.narrow ? kNarrowMargin + 6 : kRight);
  const double bottom = places.narrow ? layout.bottom : canvas.height() - kBottom;
  return {left, top, right - left, bottom - top};
}

/// The sheet as tall as its rows ask.
CanvasSize SheetOf(const ExperimentPicture& picture, PlotOptions options) {
  const bool narrow = Narrow(options);
  const double height = Places(picture, narrow).SheetHeight();
  options.height = static_cast<int>(height);
  return SizeOf(options, narrow ? height : 0);
}

/// As many panels as a picture has room for, or rows where there is one panel; its facts tell.
ExperimentPicture WhatFits(const ExperimentPicture& whole, const PlotOptions& options) {
  const bool by_panel = Distinct(whole, &ExperimentGroup::panel).size() > 1;
  const auto member = by_panel ? &ExperimentGroup::panel : &ExperimentGroup::row;
  const std::vector<std::string> names = Distinct(whole, member);
  const auto first = [&](std::size_t number) {
    ExperimentPicture picture = whole;
    std::erase_if(picture.groups, [&](const ExperimentGroup& group) {
      return IndexOf(names, group.*member) >= number;
    });
    return picture;
  };
  const auto fits = [&](std::size_t number) {
    return SheetOf(first(number), options).height_px <= kMostPixels;
  };
  if (fits(names.size())) return whole;
  const auto numbers = std::views::iota(std::size_t{2}, names.size());
  const std::size_t number = 1 + (std::ranges::partition_point(numbers, fits) - numbers.begin());
  ExperimentPicture picture = first(number);
  picture.facts += fmt::format(" · the first {} of {} {}: there is no room for more", number,
                               names.size(), by_panel ? "panels" : "rows");
  return picture;
}

}  // namespace

void PlotExperiment(const ExperimentPicture& whole, const std::string& path) {
  if (whole.groups.empty())
    throw std::runtime_error(path + ": nothing to draw: the summary has no groups");
  PlotOptions options;
  options.width_mm = whole.width_mm;
  const bool narrow = Narrow(options);
  const ExperimentPicture picture = WhatFits(whole, options);
  const Places places(picture, narrow);
  Canvas canvas(SheetOf(picture, options), path);
  const double below = DrawTitle(&canvas, picture.title, picture.facts);
  const std::array<LegendGroup, 1> legends = {
      LegendGroup{"", MarkLegend(picture, places.series, true)}};
  const Layout layout(canvas, legends);
  if (narrow)
    layout.DrawLegends(&canvas, legends);
  else
    DrawMarkLegend(&canvas, legends[0].entries);
  const double top = (narrow ? below : kTopOfAll) + (places.named() ? kPanelTitle : 0);
  const Box room = RoomOf(canvas, places, layout, top);

  std::vector<Axis> axes = {NiceAxis(
      0, 100, 5, false, narrow ? "share of trials  [%]" : "share of trials, 95 % interval  [%]")};
  for (std::size_t m = 0; m < picture.measure_labels.size(); ++m)
    axes.push_back(MeasureAxis(picture, m));
  const Axis none{0.2, 0.8, 1, ""};  // no ticks
  for (std::size_t a = 0; a < axes.size(); ++a) {
    for (std::size_t p = 0; p < places.panels.size(); ++p) {
      const Panel panel{places.Of(room, a, p), axes[a], none};
      DrawGrid(&canvas, panel, p + 1 == places.panels.size());
      if ((a == 0 || narrow) && !places.panels[p].empty())
        canvas.Text({room.x, panel.area.y - 16}, places.panels[p], {.size = 19, .bold = true});
      DrawRows(&canvas, places, panel, a == 0 || narrow);
      for (const auto& group : picture.groups)
        if (group.panel == places.panels[p]) DrawGroup(&canvas, places, panel, group, a);
      DrawFrame(&canvas, panel);
    }
  }
  canvas.Save();
}

}  // namespace regrasp
