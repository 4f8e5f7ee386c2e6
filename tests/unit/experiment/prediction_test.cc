// ROC, its area and its bootstrap against enumeration and against the theory of rank sums; windows
// against a run made by hand.

#include "cli/experiment/prediction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cli/experiment/roc.h"
#include "core/common/random.h"

namespace regrasp::cli {
namespace {

std::vector<ScoredWindow> RandomWindows(std::uint64_t seed, std::size_t runs, int per_run,
                                        double shift, int levels) {
  RandomStream random(seed, 1);
  std::vector<ScoredWindow> windows;
  for (std::size_t run = 0; run < runs; ++run)
    for (int k = 0; k < per_run; ++k) {
      const bool fails = random.Uniform() < 0.3;
      const double score = random.Normal3().x() + (fails ? shift : 0);
      windows.push_back({levels > 0 ? std::round(levels * score) : score, fails, run});
    }
  return windows;
}

/// By the definition, over all pairs.
double EnumeratedArea(const std::vector<ScoredWindow>& windows,
                      const std::vector<double>& weights) {
  double sum = 0, pairs = 0;
  for (const ScoredWindow& bad : windows)
    for (const ScoredWindow& good : windows) {
      if (!bad.fails || good.fails) continue;
      const double weight = weights[bad.run] * weights[good.run];
      pairs += weight;
      sum += weight * (bad.score > good.score ? 1 : bad.score == good.score ? 0.5 : 0);
    }
  return sum / pairs;
}

TEST(Roc, AreaIsTheShareOfPairsInOrder) {
  for (const int levels : {0, 1, 3}) {  // without ties, and with many
    const auto windows = RandomWindows(5, 7, 30, 0.7, levels);
    const Roc roc(windows);
    EXPECT_NEAR(roc.Area(), EnumeratedArea(windows, std::vector<double>(7, 1.0)), 1e-12);
    const std::vector<double> weights = {0, 2, 1, 0, 3, 1, 0};
    EXPECT_NEAR(roc.Area(weights), EnumeratedArea(windows, weights), 1e-12);
  }
  EXPECT_TRUE(std::isnan(Roc({{1, true, 0}, {2, true, 0}}).Area()));
  EXPECT_EQ(Roc({{1, true, 0}, {0, false, 0}}).Area(), 1);
  EXPECT_EQ(Roc({{0, true, 0}, {1, false, 0}}).Area(), 0);
}

TEST(Roc, AreaIsThatUnderItsPoints) {
  const Roc roc(RandomWindows(6, 5, 40, 0.5, 2));
  const auto points = roc.Points();
  EXPECT_EQ(points.front().false_alarms, 0);
  EXPECT_EQ(points.back().false_alarms, 1);
  EXPECT_EQ(points.back().foretold, 1);
  double area = 0;  // trapezoids
  for (std::size_t i = 1; i < points.size(); ++i)
    area += (points[i].false_alarms - points[i - 1].false_alarms) *
            (points[i].foretold + points[i - 1].foretold) / 2;
  EXPECT_NEAR(area, roc.Area(), 1e-12);
}

TEST(Roc, ThresholdKeepsTheFalseAlarms) {
  const auto windows = RandomWindows(7, 5, 200, 0.8, 0);
  const Roc roc(windows);
  const double threshold = roc.Threshold(0.1);
  int alarms = 0, good = 0;
  for (const ScoredWindow& w : windows) {
    good += !w.fails;
    alarms += !w.fails && w.score > threshold;
  }
  EXPECT_LE(alarms, 0.1 * good);
  EXPECT_GE(alarms + 1, std::floor(0.1 * good));
  // Between two points no threshold lies.
  EXPECT_EQ(ForetoldAt({{0, 0}, {0.5, 0.8}, {1, 1}}, 0.25), 0);
  EXPECT_EQ(ForetoldAt({{0, 0}, {0.5, 0.8}, {1, 1}}, 0.5), 0.8);
  EXPECT_EQ(OnCurve({{0, 0}, {0.5, 0.8}, {1, 1}}, 0.25), 0.4);
  EXPECT_EQ(ForetoldAt({{0, 0}, {0, 0.3}, {1, 1}}, 0), 0.3);
}

double Deviation(const std::vector<double>& values) {
  double mean = 0, squares = 0;
  for (const double x : values) mean += x / static_cast<double>(values.size());
  for (const double x : values) squares += (x - mean) * (x - mean);
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

std::vector<double> Areas(const Roc& roc, std::size_t runs) {
  std::vector<double> areas;
  for (const auto& weights : ResampledRuns(runs, 1000)) areas.push_back(roc.Area(weights));
  return areas;
}

// Runs of one window each are independent: the bootstrap must give the deviation that DeLong,
// DeLong and Clarke-Pearson (1988) give. And windows that are copies of each other add nothing: a
// bootstrap over windows would promise an interval a third as wide.
TEST(Roc, BootstrapOverRunsGivesTheDeviationOfDeLong) {
  const auto windows = RandomWindows(8, 400, 1, 0.8, 0);
  std::vector<double> bad, good;
  for (const ScoredWindow& w : windows) (w.fails ? bad : good).push_back(w.score);
  std::vector<double> of_bad, of_good;  // placements
  for (const double x : bad)
    of_bad.push_back(static_cast<double>(
                         std::count_if(good.begin(), good.end(), [x](double y) { return y < x; })) /
                     static_cast<double>(good.size()));
  for (const double y : good)
    of_good.push_back(static_cast<double>(
                          std::count_if(bad.begin(), bad.end(), [y](double x) { return y < x; })) /
                      static_cast<double>(bad.size()));
  const double delong =
      std::sqrt(std::pow(Deviation(of_bad), 2) / static_cast<double>(bad.size()) +
                std::pow(Deviation(of_good), 2) / static_cast<double>(good.size()));
  const double bootstrap = Deviation(Areas(Roc(windows), 400));
  // 1000 resamples: 2.2 % standard error of a deviation; the estimators differ by O(1/n).
  EXPECT_NEAR(bootstrap / delong, 1, 0.1);
  std::vector<ScoredWindow> copied;
  for (const ScoredWindow& w : windows) copied.insert(copied.end(), 9, w);
  EXPECT_NEAR(Deviation(Areas(Roc(copied), 400)) / bootstrap, 1, 1e-9);
}

TEST(Roc, EveryRunIsDrawnAsOftenAsAnother) {
  std::vector<double> sum(10, 0.0);
  for (const auto& weights : ResampledRuns(10, 1000)) {
    double drawn = 0;
    for (std::size_t r = 0; r < 10; ++r) {
      drawn += weights[r];
      sum[r] += weights[r];
    }
    EXPECT_EQ(drawn, 10);
  }
  for (const double n : sum) EXPECT_NEAR(n, 1000, 150);  // 5 standard deviations of 30
}

/// Looks each 0.1 s from 0 to 10 s, each measure a line of time.
WatchedRun RunWith(std::vector<double> failures_s) {
  WatchedRun run;
  for (int k = 0; k <= 100; ++k) {
    run.time_s.push_back(0.1 * k);
    run.values.emplace_back(WatchedMeasures().size(), 3 - 0.2 * 0.1 * k);
  }
  run.failures_s = std::move(failures_s);
  run.end_s = 10;
  return run;
}

std::string LabelText(const std::vector<Label>& labels, std::size_t from, std::size_t to) {
  std::string text;
  for (std::size_t i = from; i <= to; ++i)
    text += labels[i] == Label::kFails ? 'F' : labels[i] == Label::kHolds ? 'h' : '-';
  return text;
}

TEST(Prediction, WindowsAreBeforeAFailureOrFarFromOne) {
  const auto labels = LabelsOf(RunWith({5.05}));
  EXPECT_EQ(LabelText(labels, 0, 6), "-----hh");           // half a second of history first
  EXPECT_EQ(LabelText(labels, 38, 50), "hhhFFFFFFFF--");   // 4.1 to 4.8 s are 0.95 to 0.25 s ahead
  EXPECT_EQ(LabelText(labels, 51, 63), "----------hhh");   // a second of recovery
  EXPECT_EQ(LabelText(labels, 88, 100), "hhh----------");  // what comes after 10 s nobody knows
}

TEST(Prediction, AFailureThatFollowsAnotherHasNoWindowsOfItsOwn) {
  const auto labels = LabelsOf(RunWith({5.05, 5.55}));
  EXPECT_EQ(LabelText(labels, 38, 70),
            "hhhFFFFFFFF-----------------"
            "hhhhh");
}

TEST(Prediction, ScoresAreTheValueTheWorstAndTheTrend) {
  const WatchedRun run = RunWith({});
  for (std::size_t m = 0; m < WatchedMeasures().size(); ++m) {
    const double danger = WatchedMeasures()[m].danger;
    EXPECT_NEAR(Score(run, 50, m, Form::kNow), danger * 2, 1e-12);
    // Falling: the lowest of the last half second is now, the highest was its first.
    EXPECT_NEAR(Score(run, 50, m, Form::kWorst), danger < 0 ? -2 : 2.1, 1e-12);
    EXPECT_NEAR(Score(run, 50, m, Form::kTrend), danger * -0.2, 1e-9);
  }
}

TEST(Prediction, ARunComesBackFromItsText) {
  const WatchedRun run = RunWith({1.25});
  const WatchedRun back = WatchedRunFromJson(Json::parse(ToJson(run).dump()));
  EXPECT_EQ(back.time_s, run.time_s);
  EXPECT_EQ(back.values, run.values);
  EXPECT_EQ(back.failures_s, run.failures_s);
  EXPECT_EQ(back.end_s, run.end_s);
}

// A measure that falls before every failure, beside twelve that say nothing.
TEST(Prediction, FindsTheMeasureThatFalls) {
  Trials trials;
  RandomStream random(9, 1);
  for (std::size_t r = 0; r < 20; ++r) {
    WatchedRun run = RunWith({3.05, 7.05});
    for (std::size_t i = 0; i < run.time_s.size(); ++i)
      for (std::size_t m = 0; m < run.values[i].size(); ++m) {
        run.values[i][m] = random.Normal3().x();
        for (const double failure : run.failures_s)
          if (m == 5 && run.time_s[i] < failure && run.time_s[i] > failure - 1)
            run.values[i][m] -= 2;
      }
    UnitResult result;
    result.map = ToJson(run);
    trials[r] = result;
  }
  const Json summary = PredictionSummary(trials);
  EXPECT_EQ(summary.at("failures"), 40);
  EXPECT_EQ(summary.at("windows_failing"), 20 * 2 * 8);
  ASSERT_EQ(summary.at("predictors").size(), 3 * WatchedMeasures().size());
  const Json& best = summary.at("predictors").front();
  EXPECT_EQ(best.at("measure"), WatchedMeasures()[5].name);
  for (const Json& p : summary.at("predictors"))  // two normals 2 apart: Φ(2 / √2) = 0.921
    if (p.at("measure") == WatchedMeasures()[5].name && p.at("form") == "now")
      EXPECT_NEAR(p.at("auc").get<double>(), 0.921, 0.03);
  int covers = 0;
  for (const Json& p : summary.at("predictors"))
    if (p.at("measure") != WatchedMeasures()[5].name)
      covers += p.at("low") <= 0.5 && p.at("high") >= 0.5;
  EXPECT_GE(covers, 30);  // of 36 intervals of 95 %
}

TEST(Prediction, HasNoIntervalBelowSixRuns) {
  Trials trials;
  for (std::size_t r = 0; r < 6; ++r) {
    trials[r].map = ToJson(RunWith({3.05}));
    const Json summary = PredictionSummary(trials);
    for (const Json& p : summary.at("predictors"))
      for (const char* end : {"low", "high", "behind_low", "behind_high"})
        EXPECT_EQ(p.at(end).is_number(), r + 1 >= 6) << end << r;
  }
}

}  // namespace
}  // namespace regrasp::cli
