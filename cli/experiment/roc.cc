#include "cli/experiment/roc.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/common/random.h"

namespace regrasp::cli {
namespace {

constexpr std::uint64_t kSeed = 1982, kStream = 1;

/// The end of the windows of the same score that begin at `i`.
std::size_t EndOfTies(const std::vector<ScoredWindow>& windows, std::size_t i) {
  std::size_t end = i + 1;
  while (end < windows.size() && windows[end].score == windows[i].score) ++end;
  return end;
}

}  // namespace

Roc::Roc(std::vector<ScoredWindow> windows) : windows_(std::move(windows)) {
  std::stable_sort(windows_.begin(), windows_.end(),
                   [](const ScoredWindow& a, const ScoredWindow& b) { return a.score > b.score; });
  fails_ = static_cast<std::size_t>(std::count_if(windows_.begin(), windows_.end(),
                                                  [](const ScoredWindow& w) { return w.fails; }));
}

double Roc::Area(const std::vector<double>& weights) const {
  double above = 0, good = 0, area = 0;  // weight that fails, that does not; pairs in order
  for (std::size_t i = 0; i < windows_.size();) {
    const std::size_t end = EndOfTies(windows_, i);
    double tied = 0, tied_good = 0;
    for (; i < end; ++i) (windows_[i].fails ? tied : tied_good) += weights[windows_[i].run];
    area += tied_good * (above + 0.5 * tied);
    above += tied;
    good += tied_good;
  }
  return above > 0 && good > 0 ? area / (above * good) : std::numeric_limits<double>::quiet_NaN();
}

double Roc::Area() const {
  std::size_t runs = 0;
  for (const ScoredWindow& w : windows_) runs = std::max(runs, w.run + 1);
  return Area(std::vector<double>(runs, 1.0));
}

std::vector<RocPoint> Roc::Points() const {
  const auto bad = static_cast<double>(fails_), good = static_cast<double>(size() - fails_);
  std::vector<RocPoint> points = {{0, 0}};
  double foretold = 0, alarms = 0;
  for (std::size_t i = 0; i < windows_.size();) {
    const std::size_t end = EndOfTies(windows_, i);
    for (; i < end; ++i) (windows_[i].fails ? foretold : alarms) += 1;
    points.push_back({alarms / std::max(1.0, good), foretold / std::max(1.0, bad)});
  }
  return points;
}

double ForetoldAt(const std::vector<RocPoint>& points, double false_alarms) {
  double best = 0;
  for (const RocPoint& point : points)
    if (point.false_alarms <= false_alarms) best = point.foretold;
  return best;
}

double OnCurve(const std::vector<RocPoint>& points, double false_alarms) {
  double best = 0;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const RocPoint &a = points[i], &b = points[i + 1];
    if (b.false_alarms <= false_alarms) {
      best = b.foretold;
    } else if (a.false_alarms <= false_alarms) {
      const double share = (false_alarms - a.false_alarms) / (b.false_alarms - a.false_alarms);
      best = a.foretold + share * (b.foretold - a.foretold);
    }
  }
  return best;
}

double Roc::Threshold(double false_alarms) const {
  const double most = false_alarms * static_cast<double>(size() - fails_);
  double alarms = 0;
  for (std::size_t i = 0; i < windows_.size();) {
    const std::size_t end = EndOfTies(windows_, i);
    const double score = windows_[i].score;
    for (; i < end; ++i) alarms += !windows_[i].fails;
    if (alarms > most) return score;
  }
  return -std::numeric_limits<double>::infinity();
}

std::vector<std::vector<double>> ResampledRuns(std::size_t runs, int resamples) {
  RandomStream random(kSeed, kStream);
  std::vector<std::vector<double>> samples(static_cast<std::size_t>(resamples),
                                           std::vector<double>(runs, 0.0));
  for (auto& sample : samples)
    for (std::size_t k = 0; k < runs; ++k)
      sample[static_cast<std::size_t>(random.Uniform() * static_cast<double>(runs))] += 1;
  return samples;
}

Interval PercentileInterval(std::vector<double> values) {
  std::erase_if(values, [](double x) { return std::isnan(x); });
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  return {Quantile(values, 0.025), Quantile(values, 0.975)};
}

}  // namespace regrasp::cli
