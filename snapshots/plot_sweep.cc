#include <algorithm>
#include <array>
#include <stdexcept>

#include "snapshots/axes.h"
#include "snapshots/experiment_marks.h"
#include "snapshots/plot_experiment.h"
#include "snapshots/snapshots.h"

namespace regrasp {
namespace {

constexpr double kTop = 180, kBottom = 100, kLeft = 130, kRight = 40;
constexpr double kGapX = 60, kGapY = 90, kPanelHeight = 300;
constexpr std::size_t kMostColumns = 3;
// On a narrow sheet one below the other, the levels written below the last.
constexpr double kNarrowTop = 104, kNarrowBottom = 190, kNarrowGap = 36, kNarrowPanel = 105;
constexpr double kSpread = 0.62;  // of a category's width, over which its marks stand

}  // namespace

void PlotSweep(const ExperimentPicture& picture, const std::string& path) {
  if (picture.groups.empty())
    throw std::runtime_error(path + ": nothing to draw: the summary has no groups");
  const auto levels = Distinct(picture, &ExperimentGroup::row);
  const auto series = Distinct(picture, &ExperimentGroup::series);
  const auto panels = Distinct(picture, &ExperimentGroup::panel);
  PlotOptions options;
  options.width_mm = picture.width_mm;
  const bool narrow = Narrow(options);
  const std::size_t columns = narrow ? 1 : std::min(kMostColumns, panels.size());
  const std::size_t lines = (panels.size() + columns - 1) / columns;
  const std::size_t marks = picture.groups.front().shares.size();
  const auto n = static_cast<double>(columns), m = static_cast<double>(lines);
  const double gap_y = narrow ? kNarrowGap : kGapY;
  const double sheet = (narrow ? kNarrowTop + kNarrowBottom : kTop + kBottom) +
                       m * (narrow ? kNarrowPanel : kPanelHeight) + (m - 1) * gap_y;
  options.height = static_cast<int>(sheet);
  CanvasSize size = SizeOf(options, sheet);
  // Text as wide sheets have it, however low this one is: a wide sheet is else 1000 units high.
  size.logical_width = std::min(size.logical_width, 1599.0);
  Canvas canvas(size, path);
  const double below = DrawTitle(&canvas, picture.title, picture.facts);
  const std::array<LegendGroup, 1> legends = {LegendGroup{"", MarkLegend(picture, series, false)}};
  const Layout layout(canvas, legends);
  if (narrow)
    layout.DrawLegends(&canvas, legends);
  else
    DrawMarkLegend(&canvas, legends[0].entries);

  const double left = narrow ? layout.left : kLeft, top = narrow ? below + 30 : kTop;
  const double width =
      narrow ? layout.width : (canvas.width() - kLeft - kRight - (n - 1) * kGapX) / n;
  const double height = narrow ? (layout.bottom - top - (m - 1) * gap_y) / m : kPanelHeight;
  for (std::size_t p = 0; p < panels.size(); ++p) {
    const std::size_t column = p % columns, line = p / columns;
    const Box box(left + static_cast<double>(column) * (width + kGapX),
                  top + static_cast<double>(line) * (height + gap_y), width, height);
    const double last = static_cast<double>(levels.size()) - 0.5;
    Panel panel{box, Axis{-0.5, last, 1, ""},
                NiceAxis(0, 100, narrow ? 3 : 5, false, column == 0 ? "share of trials  [%]" : "")};
    panel.y.short_label = "share  [%]";
    DrawGrid(&canvas, panel, false);
    canvas.Text({box.x, box.y - 18}, panels[p], {.size = 19, .bold = true});
    const bool lowest = p + columns >= panels.size();
    for (std::size_t level = 0; level < levels.size() && (lowest || !narrow); ++level)
      canvas.Text({panel.At(static_cast<double>(level), 0).x, box.y + box.height + 12},
                  levels[level], {.size = 18, .align_x = AlignX::kCentre, .align_y = AlignY::kTop});
    if (lowest)
      canvas.Text({box.x + box.width / 2, box.y + box.height + (narrow ? 38 : 46)},
                  "sensor noise (preset)",
                  {.size = 21, .align_x = AlignX::kCentre, .align_y = AlignY::kTop});
    const double slots = static_cast<double>(series.size() * marks);
    for (const ExperimentGroup& group : picture.groups) {
      if (group.panel != panels[p]) continue;
      const std::size_t s = IndexOf(series, group.series);
      for (std::size_t k = 0; k < group.shares.size(); ++k) {
        const ShareMark& share = group.shares[k];
        const double slot = static_cast<double>(s * marks + k) + 0.5;
        const double x =
            static_cast<double>(IndexOf(levels, group.row)) - kSpread / 2 + kSpread * slot / slots;
        canvas.Line(panel.At(x, 100 * share.low), panel.At(x, 100 * share.high),
                    {ColourOfSeries(s), k == 0 ? 2.5 : 1.5});
        DrawShareMark(&canvas, panel.At(x, 100 * share.share), k, ColourOfSeries(s));
      }
    }
    DrawFrame(&canvas, panel);
  }
  canvas.Save();
}

}  // namespace regrasp
