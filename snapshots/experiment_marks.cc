#include "snapshots/experiment_marks.h"

#include <algorithm>
#include <array>

namespace regrasp {

std::vector<std::string> Distinct(const ExperimentPicture& picture,
                                  std::string ExperimentGroup::*field) {
  std::vector<std::string> names;
  for (const auto& group : picture.groups)
    if (std::find(names.begin(), names.end(), group.*field) == names.end())
      names.push_back(group.*field);
  return names;
}

std::size_t IndexOf(const std::vector<std::string>& names, const std::string& name) {
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

Colour ColourOfSeries(std::size_t series) {
  constexpr std::array kColours = {kBlue, kVermillion, kGreen, kPurple};
  return kColours[series % kColours.size()];
}

void DrawShareMark(Canvas* canvas, Point2 at, std::size_t which, Colour colour) {
  if (which == 0)
    canvas->Mark(Marker::kDisc, at, 6, colour);
  else
    canvas->Mark(Marker::kSquare, at, 6, colour, kWhite);
}

std::vector<LegendEntry> MarkLegend(const ExperimentPicture& picture,
                                    const std::vector<std::string>& series, bool boxes) {
  std::vector<LegendEntry> entries;
  for (std::size_t m = 0; m < picture.groups.front().shares.size(); ++m)
    entries.push_back({picture.groups.front().shares[m].name,
                       [m](Canvas* c, Point2 at) { DrawShareMark(c, at, m, kInk); }});
  if (series.size() > 1)
    for (std::size_t s = 0; s < series.size(); ++s)
      entries.push_back({series[s], [s](Canvas* c, Point2 at) {
                           c->FillBox({at.x - 9, at.y - 7, 18, 14}, ColourOfSeries(s));
                         }});
  bool points = false, summaries = false;
  for (const ExperimentGroup& group : picture.groups)
    for (const QuantileMark& q : group.measures) {
      points = points || !q.few.empty();
      summaries = summaries || (q.has_values && q.few.empty());
    }
  if (boxes && points)
    entries.push_back(
        {"one trial", [](Canvas* c, Point2 at) { c->Mark(Marker::kDisc, at, 5, kGrey); }});
  if (boxes && (summaries || !points))
    entries.push_back({"5, 25, 50, 75, 95 % of the trials", [](Canvas* c, Point2 at) {
                         c->Line({at.x - 12, at.y}, {at.x + 12, at.y}, {kGrey, 2});
                         c->FillBox({at.x - 6, at.y - 7, 12, 14}, Tint(kGrey, 0.55));
                         c->Line({at.x, at.y - 9}, {at.x, at.y + 9}, {kGrey, 3});
                       }});
  return entries;
}

void DrawMarkLegend(Canvas* canvas, const std::vector<LegendEntry>& entries) {
  double x = 40;
  for (const LegendEntry& entry : entries) {
    entry.symbol(canvas, {x + 12, 112});
    canvas->Text({x + 32, 112}, entry.text, {.size = 17});
    x += 60 + canvas->TextWidth(entry.text, 17);
  }
}

}  // namespace regrasp
