#pragma once

/// How well a score tells windows that fail from those that do not: ROC, its area, and intervals
/// that respect that the windows of one run belong together.

#include <cstdint>
#include <vector>

#include "cli/experiment/statistics.h"

namespace regrasp::cli {

struct ScoredWindow {
  double score = 0;     ///< larger: more likely to fail; not NaN
  bool fails = false;   ///<
  std::size_t run = 0;  ///< windows of one run are dependent
};

struct RocPoint {
  double false_alarms = 0;  ///< share of the windows that do not fail whose score is above
  double foretold = 0;      ///< share of those that fail
};

/// Windows in order of their scores, so that weights of runs can be changed at little cost.
class Roc {
 public:
  explicit Roc(std::vector<ScoredWindow> windows);

  /// Area under the ROC: the probability that a window that fails has the larger score, ties as one
  /// half [Hanley and McNeil 1982]; a window counts `weights[run]` times. NaN without windows of
  /// both kinds.
  double Area(const std::vector<double>& weights) const;
  double Area() const;
  /// From (0, 0) to (1, 1), one point per different score.
  std::vector<RocPoint> Points() const;
  /// The least score that at most `false_alarms` of the windows that do not fail exceed.
  double Threshold(double false_alarms) const;
  std::size_t fails() const { return fails_; }
  std::size_t size() const { return windows_.size(); }

 private:
  std::vector<ScoredWindow> windows_;  // descending
  std::size_t fails_ = 0;
};

/// The share foretold at the lowest threshold that gives so many false alarms at most. Between the
/// points of a ROC lies no threshold: scores that are equal are above it together or not at all.
double ForetoldAt(const std::vector<RocPoint>& points, double false_alarms);

/// The curve through the points of a ROC, between them linearly: equal scores drawn by lot.
double OnCurve(const std::vector<RocPoint>& points, double false_alarms);

/// How often each of `runs` runs is drawn in each of `resamples` bootstrap samples of runs, always
/// by the same random numbers.
std::vector<std::vector<double>> ResampledRuns(std::size_t runs, int resamples);

/// 95 % percentile interval of `values`, those that are NaN left out; (0, 1) without any.
Interval PercentileInterval(std::vector<double> values);

}  // namespace regrasp::cli
