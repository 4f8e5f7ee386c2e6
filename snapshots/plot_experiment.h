#pragma once

/// The picture of an experiment's summary.

#include <string>
#include <vector>

namespace regrasp {

/// A share of trials with its interval, all in [0, 1].
struct ShareMark {
  std::string name;  ///< "φ rose"
  double share = 0, low = 0, high = 1;
};

/// Five-number summary of one measured quantity; has_values false: nothing was measured. `few`: the
/// values themselves where there are too few for a summary.
struct QuantileMark {
  bool has_values = false;
  std::vector<double> few = {};
  double q05 = 0, q25 = 0, median = 0, q75 = 0, q95 = 0;
};

struct ExperimentGroup {
  std::string row, series, panel;  ///< label at the left, colour, and panel; may be empty
  std::vector<ShareMark> shares;
  std::vector<QuantileMark> measures;
};

struct ExperimentPicture {
  std::string title, facts;  ///< facts: separated by " · "
  double width_mm = 0;       ///< as printed, with text of at least 7 pt; 0: for a screen
  std::vector<std::string> measure_labels;  ///< with their units
  std::vector<ExperimentGroup> groups;
};

/// One predictor of failures: area under its ROC with a 95 % interval, and the ROC itself.
struct PredictorMark {
  std::string name, form;
  double area = 0, low = 0, high = 1;
  std::vector<double> false_alarms, foretold;  ///< ascending
};

struct PredictionPicture {
  std::string title, facts;
  std::vector<PredictorMark> predictors;  ///< best first
};

/// ROC curves of the best predictors beside the areas of all. Throws as PlotExperiment().
void PlotPrediction(const PredictionPicture& picture, const std::string& path);

/// Draws a row for each group: its shares with 95 % intervals, and 5-25-50-75-95 % of each measured
/// quantity, or its few values, beside them (below them, on a narrow sheet). Groups of several
/// panels go one below the other; those that a picture has no room for are left out, and its facts
/// tell. Throws std::runtime_error with `path` as the other pictures do
/// (snapshots.h).
void PlotExperiment(const ExperimentPicture& picture, const std::string& path);

/// Shares against the rows (levels of noise), a panel for each finger, series beside each other.
/// Throws as PlotExperiment().
void PlotSweep(const ExperimentPicture& picture, const std::string& path);

}  // namespace regrasp
