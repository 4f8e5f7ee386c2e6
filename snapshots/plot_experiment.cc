#include "snapshots/plot_experiment.h"

#include <algorithm>
#include <stdexcept>

#include "snapshots/axes.h"
#include "snapshots/experiment_marks.h"

namespace regrasp {
namespace {

constexpr double kTopOfAll = 150, kPanelTitle = 30, kBottom = 90, kLeft = 230, kRight = 40,
                 kGap = 46;
constexpr double kBetween = 50;  // columns
constexpr double kLabelSize = 18;
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
  canvas->Line({x(q.q05), y}, {x(q.q95), y}, {colour, 2});
  const double left = x(q.q25), width = std::max(1.0, x(q.q75) - left);
  canvas->FillBox({left, y - height / 2, width, height}, Tint(colour, 0.55));
  canvas->Line({x(q.median), y - height / 2 - 2}, {x(q.median), y + height / 2 + 2}, {colour, 3});
}

Axis MeasureAxis(const ExperimentPicture& picture, std::size_t which) {
  Range range;
  for (const auto& group : picture.groups)
    if (const QuantileMark& q = group.measures.at(which); q.has_values)
      for (const double value : {q.q05, q.q95}) range.Add(value);
  if (range.empty()) range.Add(0);
  return NiceAxis(range.lo, range.hi, 5, true, picture.measure_labels.at(which));
}

}  // namespace

void PlotExperiment(const ExperimentPicture& picture, const std::string& path) {
  if (picture.groups.empty())
    throw std::runtime_error(path + ": nothing to draw: the summary has no groups");
  const auto rows = Distinct(picture, &ExperimentGroup::row);
  const auto series = Distinct(picture, &ExperimentGroup::series);
  const auto panels = Distinct(picture, &ExperimentGroup::panel);
  const std::size_t marks = picture.groups.front().shares.size();
  const double lines = static_cast<double>(series.size() * std::max<std::size_t>(1, marks));
  const bool named = !panels.front().empty();
  const double top_of_panels = named ? kTopOfAll + kPanelTitle : kTopOfAll;
  const double row_height = std::max(kRowHeight, 15 * lines + 12);
  const double blocks = static_cast<double>(panels.size());
  const double block = row_height * static_cast<double>(rows.size());
  const int height = static_cast<int>(
      std::max(600.0, top_of_panels + blocks * block + (blocks - 1) * kGap + kBottom));
  Canvas canvas({.height_px = height}, path);
  const double unit_height = canvas.height(), unit_width = canvas.width();
  DrawTitle(&canvas, picture.title, picture.facts);
  DrawMarkLegend(&canvas, picture, series, true);

  double labels = kLeft;
  for (const auto& row : rows)
    labels = std::max(labels, 40 + 14 + canvas.TextWidth(row, kLabelSize));
  std::vector<Axis> axes = {NiceAxis(0, 100, 5, false, "share of trials, 95 % interval  [%]")};
  for (std::size_t m = 0; m < picture.measure_labels.size(); ++m)
    axes.push_back(MeasureAxis(picture, m));
  const auto columns = static_cast<double>(axes.size());
  const double free = unit_width - labels - kRight - kBetween * (columns - 1);
  const double width = free / columns;
  const double stretch =
      (unit_height - top_of_panels - kBottom - (blocks - 1) * kGap) / (blocks * block);

  for (std::size_t p = 0; p < panels.size(); ++p) {
    const double top = top_of_panels + static_cast<double>(p) * (block * stretch + kGap);
    const Axis none{0.2, 0.8, 1, ""};  // no ticks
    std::vector<Panel> parts;
    for (const Axis& axis : axes)
      parts.push_back({Box(labels + static_cast<double>(parts.size()) * (width + kBetween), top,
                           width, block * stretch),
                       axis, none});
    for (const Panel& part : parts) DrawGrid(&canvas, part, p + 1 == panels.size());
    if (!panels[p].empty()) canvas.Text({labels, top - 16}, panels[p], {.size = 19, .bold = true});
    const double h = row_height * stretch;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const double y = top + h * static_cast<double>(r);
      if (r > 0)
        for (const Panel& part : parts)
          canvas.Line({part.area.x, y}, {part.area.x + part.area.width, y}, {kGridGrey, 1});
      canvas.Text({labels - 14, y + h / 2}, rows[r],
                  {.size = kLabelSize, .align_x = AlignX::kRight});
    }
    for (const auto& group : picture.groups) {
      if (group.panel != panels[p]) continue;
      const std::size_t s = IndexOf(series, group.series);
      const double y = top + h * static_cast<double>(IndexOf(rows, group.row));
      const double n = static_cast<double>(series.size());
      const double slot = std::min((h - 12) / n, kMostPerMark * static_cast<double>(marks));
      const double begin = y + (h - slot * n) / 2 + slot * static_cast<double>(s);
      for (std::size_t m = 0; m < group.shares.size(); ++m)
        DrawShare(&canvas, parts.front(), group.shares[m], m,
                  begin + slot * (static_cast<double>(m) + 0.5) / static_cast<double>(marks),
                  ColourOfSeries(s));
      for (std::size_t m = 0; m < group.measures.size(); ++m)
        DrawQuantiles(&canvas, parts[m + 1], group.measures[m], begin + slot / 2,
                      std::min(16.0, slot * 0.6), ColourOfSeries(s));
    }
    for (const Panel& part : parts) DrawFrame(&canvas, part);
  }

  canvas.Save();
}

}  // namespace regrasp
