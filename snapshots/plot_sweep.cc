#include <algorithm>
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
constexpr double kSpread = 0.62;  // of a category's width, over which its marks stand

}  // namespace

void PlotSweep(const ExperimentPicture& picture, const std::string& path) {
  if (picture.groups.empty())
    throw std::runtime_error(path + ": nothing to draw: the summary has no groups");
  const auto levels = Distinct(picture, &ExperimentGroup::row);
  const auto series = Distinct(picture, &ExperimentGroup::series);
  const auto panels = Distinct(picture, &ExperimentGroup::panel);
  const std::size_t columns = std::min(kMostColumns, panels.size());
  const std::size_t lines = (panels.size() + columns - 1) / columns;
  const std::size_t marks = picture.groups.front().shares.size();
  const auto n = static_cast<double>(columns), m = static_cast<double>(lines);
  PlotOptions options;
  options.width_mm = picture.width_mm;
  options.height = static_cast<int>(kTop + m * kPanelHeight + (m - 1) * kGapY + kBottom);
  Canvas canvas(SizeOf(options), path);
  DrawTitle(&canvas, picture.title, picture.facts);
  DrawMarkLegend(&canvas, MarkLegend(picture, series, false));

  const double width = (canvas.width() - kLeft - kRight - (n - 1) * kGapX) / n;
  for (std::size_t p = 0; p < panels.size(); ++p) {
    const std::size_t column = p % columns, line = p / columns;
    const Box box(kLeft + static_cast<double>(column) * (width + kGapX),
                  kTop + static_cast<double>(line) * (kPanelHeight + kGapY), width, kPanelHeight);
    const double last = static_cast<double>(levels.size()) - 0.5;
    const Panel panel{box, Axis{-0.5, last, 1, ""},
                      NiceAxis(0, 100, 5, false, column == 0 ? "share of trials  [%]" : "")};
    DrawGrid(&canvas, panel, false);
    canvas.Text({box.x, box.y - 18}, panels[p], {.size = 19, .bold = true});
    for (std::size_t level = 0; level < levels.size(); ++level)
      canvas.Text({panel.At(static_cast<double>(level), 0).x, box.y + box.height + 12},
                  levels[level], {.size = 18, .align_x = AlignX::kCentre, .align_y = AlignY::kTop});
    if (p + columns >= panels.size())
      canvas.Text({box.x + box.width / 2, box.y + box.height + 46}, "sensor noise (preset)",
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
