#pragma once

/// What the pictures of experiments share. Internal to snapshots/.

#include <string>
#include <vector>

#include "snapshots/axes.h"
#include "snapshots/plot_experiment.h"

namespace regrasp {

/// The different values of a field of the groups, in their order.
std::vector<std::string> Distinct(const ExperimentPicture& picture,
                                  std::string ExperimentGroup::*field);
std::size_t IndexOf(const std::vector<std::string>& names, const std::string& name);
Colour ColourOfSeries(std::size_t series);
/// The first share of a group is a full disc, the second an open square.
void DrawShareMark(Canvas* canvas, Point2 at, std::size_t which, Colour colour);
/// What marks, colours and, with `boxes`, the boxes of quantiles mean.
std::vector<LegendEntry> MarkLegend(const ExperimentPicture& picture,
                                    const std::vector<std::string>& series, bool boxes);
/// The same in one line below the title of a wide sheet.
void DrawMarkLegend(Canvas* canvas, const std::vector<LegendEntry>& entries);

}  // namespace regrasp
