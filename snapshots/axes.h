#pragma once

/// Axes with 1-2-5 ticks, panels and curves. Internal to snapshots/.

#include <array>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "snapshots/canvas.h"

namespace regrasp {

struct Axis {
  double lo = 0, hi = 1;
  double step = 0.2;  ///< between ticks: 1, 2 or 5 times a power of ten
  std::string label;
  std::string short_label = {};  ///< where `label` is longer than the axis
  /// Multiples of `step` inside [lo, hi].
  std::vector<double> Ticks() const;
  /// The value with as many decimals as the step needs, and a true minus sign.
  std::string TickText(double value) const;
};

/// An axis over [lo, hi] with about `ticks` ticks. `round_out` widens the range to whole ticks. A
/// range that is empty or not finite becomes one of width 1 about its middle.
Axis NiceAxis(double lo, double hi, int ticks, bool round_out, std::string label);

/// The smallest and largest finite value; (inf, -inf) when there is none.
struct Range {
  double lo = std::numeric_limits<double>::infinity();
  double hi = -std::numeric_limits<double>::infinity();
  void Add(double value);
  void Add(std::span<const double> values);
  bool empty() const { return lo > hi; }
  /// Widened by a fraction of its width on either side.
  Range Padded(double below, double above) const;
};

/// A plot area with an axis on either side.
struct Panel {
  Box area;
  Axis x, y;
  Point2 At(double xv, double yv) const {
    return {area.x + (xv - x.lo) / (x.hi - x.lo) * area.width,
            area.y + (y.hi - yv) / (y.hi - y.lo) * area.height};
  }
};

/// Grid lines and tick values; draw it after the background and before the curves. `x_values`
/// writes the tick values and the label of the x axis below the panel.
void DrawGrid(Canvas* canvas, const Panel& panel, bool x_values);
/// The frame of the panel; draw it after the curves.
void DrawFrame(Canvas* canvas, const Panel& panel);
/// A curve through (xs[i], ys[i]), xs ascending; a value that is not finite interrupts it. Dense
/// data is reduced to first, lowest, highest and last value per pixel column, which looks the same.
void DrawCurve(Canvas* canvas, const Panel& panel, std::span<const double> xs,
               std::span<const double> ys, const Pen& pen);

/// One line of a legend: a drawing 44 wide about a point (or none), and a text.
struct LegendEntry {
  std::string text;
  std::function<void(Canvas*, Point2 middle)> symbol;
  Colour colour = kInk;  ///< of the text
  bool bold = false;
};
LegendEntry LineEntry(std::string text, Pen pen);
LegendEntry MarkEntry(std::string text, Marker marker, Colour colour);
/// A legend whose top left corner is `at`; returns the y below it.
double DrawLegend(Canvas* canvas, Point2 at, const std::string& heading,
                  std::span<const LegendEntry> entries);

/// A heading and what is under it. Beside the axes it stands at `y` or below the one before it.
struct LegendGroup {
  std::string heading;
  std::vector<LegendEntry> entries;
  double y = 0;
};
/// Where axes go on a sheet, and where their legends: in a column at the right, or in lines below
/// where the sheet is narrow. Make it before the axes: a narrow sheet needs to know how many lines.
struct Layout {
  static constexpr double kXAxis = 68;  ///< room for values and label of an x axis
  double left, width, bottom;           ///< of the axes; their x axis needs the room below `bottom`
  double below;                         ///< that room, on a narrow sheet
  Layout(const Canvas& canvas, std::span<const LegendGroup> groups, double axis_room = kXAxis);
  void DrawLegends(Canvas* canvas, std::span<const LegendGroup> groups) const;
};

/// A direction of view and what it is called.
struct Side {
  Vector3d to_viewer;
  const char* name;
};
/// Where two views of equal size go: side by side from `top` to `under` above the lower edge, or
/// one below the other where the sheet is narrow.
std::array<Box, 2> TwoBoxes(const Canvas& canvas, const Layout& layout, double top, double under);
/// A thin line about a view.
void DrawBorder(Canvas* canvas, const Box& box);

/// Title and facts at the top of the sheet; long facts are set smaller, then in several lines.
/// Returns the y below them; without a title the upper margin.
double DrawTitle(Canvas* canvas, const std::string& title, const std::string& facts);

}  // namespace regrasp
