#include "cli/experiment/prediction.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cli/experiment/roc.h"
#include "cli/print/print.h"

namespace regrasp::cli {
namespace {

constexpr int kResamples = 1000;
constexpr double kFalseAlarms = 0.1;  // at which the share of failures foretold is told
constexpr int kRocPoints = 101;
constexpr double kSlack_s = 1e-6;
constexpr double kAlarmLimit = 1e6;  // of a value: what is not bounded counts as this

double Norm(const Json& v) {
  return std::hypot(v.at(0).get<double>(), v.at(1).get<double>(), v.at(2).get<double>());
}

/// The index of the first look at or after `time_s`.
std::size_t From(const WatchedRun& run, double time_s) {
  return static_cast<std::size_t>(
      std::lower_bound(run.time_s.begin(), run.time_s.end(), time_s - kSlack_s) -
      run.time_s.begin());
}

const char* Name(Form form) {
  return form == Form::kNow ? "now" : form == Form::kWorst ? "worst" : "trend";
}

/// Failures that at least one window should have foretold, and those of them with a score above
/// `threshold`.
struct Foretold {
  int failures = 0, foretold = 0;
};
Foretold CountForetold(const std::vector<WatchedRun>& runs,
                       const std::vector<std::vector<Label>>& labels, std::size_t measure,
                       Form form, double threshold) {
  Foretold count;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const WatchedRun& run = runs[r];
    for (const double failure : run.failures_s) {
      bool seen = false, told = false;
      for (std::size_t i = From(run, failure - kFar_s); i < run.time_s.size(); ++i) {
        if (run.time_s[i] >= failure - kSoon_s) break;
        if (labels[r][i] != Label::kFails) continue;
        seen = true;
        told |= Score(run, i, measure, form) > threshold;
      }
      count.failures += seen;
      count.foretold += told;
    }
  }
  return count;
}

Json Thinned(const std::vector<RocPoint>& roc) {
  Json points = Json::array();
  for (int k = 0; k < kRocPoints; ++k) {
    const double alarms = static_cast<double>(k) / (kRocPoints - 1);
    points.push_back({alarms, OnCurve(roc, alarms)});
  }
  return points;
}

}  // namespace

const std::vector<WatchedMeasure>& WatchedMeasures() {
  static const std::vector<WatchedMeasure> measures = {
      {"min_singular_value", "σ_min", -1, true},
      {"epsilon", "ε", -1, true},
      {"sqrt_det", "√det", -1, true},
      {"isotropy", "isotropy", -1, true},
      {"volume", "volume of the wrench hull", -1, true},
      {"load_margin_n", "load margin ρ", -1, true},
      {"load_margin_without_n", "ρ without the worst finger", -1},
      {"friction_ratio", "friction asked for, of what is there", 1},
      {"normal_force_n", "least normal force", -1},
      {"manipulability", "least manipulability", -1},
      {"joint_limit_margin_rad", "least way to a joint limit", -1},
      {"fingers", "fingers that touch", -1},
      {"lag_m", "object off its reference", 1},
  };
  return measures;
}

std::vector<double> Look(const Json& quality, const Json& contacts) {
  const auto number = [](const Json& json, double otherwise) {
    return json.is_number() ? std::clamp(json.get<double>(), -kAlarmLimit, kAlarmLimit) : otherwise;
  };
  // A measure of no contacts at all is that of a hand that holds nothing.
  std::vector<double> values;
  for (const WatchedMeasure& measure : WatchedMeasures())
    if (measure.of_grasp) values.push_back(number(At(quality, measure.name), 0));
  double without = kAlarmLimit, manipulability = kAlarmLimit, limit = kAlarmLimit;
  double ratio = 0, force = kAlarmLimit, touching = 0;
  for (const auto& [name, finger] : Named(quality.at("fingers"), "finger")) {
    without = std::min(without, number(At(finger, "load_margin_without_n"), 0));
    limit = std::min(limit, number(At(finger, "joint_limit_margin_rad"), kAlarmLimit));
    manipulability = std::min(manipulability, number(At(finger, "manipulability"), kAlarmLimit));
  }
  const double friction = contacts.at("friction");
  for (const auto& [name, finger] : Named(contacts.at("fingers"), "finger")) {
    if (finger.at("role") == "free" || finger.at("in_contact") != true) continue;
    ++touching;
    force = std::min(force, finger.at("force_n").get<double>());
    const Json &f = finger.at("force_command_W_n"), &n = finger.at("normal_W");
    double normal = 0;  // on the object, inwards
    for (std::size_t k = 0; k < 3; ++k) normal -= f.at(k).get<double>() * n.at(k).get<double>();
    const double whole = Norm(f);
    const double tangential = std::sqrt(std::max(0.0, whole * whole - normal * normal));
    if (normal > 1e-6) ratio = std::max(ratio, tangential / (friction * normal));
  }
  if (touching == 0) force = 0;
  const Json &object = contacts.at("object"), &is = object.at("p_WO_m"),
             &wanted = object.at("p_WO_reference_m");
  double lag = kAlarmLimit;  // of an object that the hand has lost
  if (wanted.is_array())
    lag = std::hypot(is.at(0).get<double>() - wanted.at(0).get<double>(),
                     is.at(1).get<double>() - wanted.at(1).get<double>(),
                     is.at(2).get<double>() - wanted.at(2).get<double>());
  for (const double value : {without, ratio, force, manipulability, limit, touching, lag})
    values.push_back(value);
  return values;
}

Json ToJson(const WatchedRun& run) {
  Json looks = Json::array();
  for (std::size_t i = 0; i < run.time_s.size(); ++i) {
    Json look = {run.time_s[i]};
    for (const double value : run.values[i]) look.push_back(value);
    looks.push_back(std::move(look));
  }
  return {{"end_s", run.end_s}, {"failures_s", run.failures_s}, {"looks", std::move(looks)}};
}

WatchedRun WatchedRunFromJson(const Json& json) {
  WatchedRun run;
  run.end_s = json.at("end_s");
  run.failures_s = json.at("failures_s").get<std::vector<double>>();
  for (const Json& look : json.at("looks")) {
    std::vector<double> values = look.get<std::vector<double>>();
    run.time_s.push_back(values.front());
    values.erase(values.begin());
    run.values.push_back(std::move(values));
  }
  return run;
}

std::vector<Label> LabelsOf(const WatchedRun& run) {
  std::vector<Label> labels;
  for (const double t : run.time_s) {
    bool near = false, follows = false;
    for (const double failure : run.failures_s) {
      near |= failure >= t - kAfter_s - kSlack_s && failure <= t + kSoon_s + kSlack_s;
      follows |= failure > t + kSoon_s + kSlack_s && failure <= t + kFar_s + kSlack_s;
    }
    const bool young = t - run.time_s.front() < kHistory_s - kSlack_s;
    if (near || young)
      labels.push_back(Label::kLeftOut);
    else if (follows)
      labels.push_back(Label::kFails);
    else
      labels.push_back(t + kFar_s <= run.end_s + kSlack_s ? Label::kHolds : Label::kLeftOut);
  }
  return labels;
}

double Score(const WatchedRun& run, std::size_t i, std::size_t measure, Form form) {
  const double danger = WatchedMeasures()[measure].danger;
  const auto value = [&](std::size_t k) { return danger * run.values[k][measure]; };
  if (form == Form::kNow) return value(i);
  const std::size_t first = From(run, run.time_s[i] - kHistory_s);
  if (form == Form::kWorst) {
    double worst = value(i);
    for (std::size_t k = first; k < i; ++k) worst = std::max(worst, value(k));
    return worst;
  }
  double t_mean = 0, y_mean = 0, ty = 0, tt = 0;
  const double n = static_cast<double>(i - first + 1);
  for (std::size_t k = first; k <= i; ++k) {
    t_mean += run.time_s[k] / n;
    y_mean += value(k) / n;
  }
  for (std::size_t k = first; k <= i; ++k) {
    ty += (run.time_s[k] - t_mean) * (value(k) - y_mean);
    tt += (run.time_s[k] - t_mean) * (run.time_s[k] - t_mean);
  }
  // Rounded, so that what is a tie is one.
  return tt > 0 ? std::round(1e9 * ty / tt) / 1e9 : 0;
}

namespace {

void AddInterval(std::vector<double> values, const char* low, const char* high, Json* json) {
  const Interval interval = PercentileInterval(std::move(values));
  (*json)[low] = interval.low;
  (*json)[high] = interval.high;
}

}  // namespace

Json PredictionSummary(const Trials& trials) {
  std::vector<WatchedRun> runs;
  for (const auto& [unit, result] : trials)
    if (result.map.is_object()) runs.push_back(WatchedRunFromJson(result.map));
  std::vector<std::vector<Label>> labels;
  int failures = 0, failing = 0, holding = 0, looks = 0;
  for (const WatchedRun& run : runs) {
    labels.push_back(LabelsOf(run));
    failures += static_cast<int>(run.failures_s.size());
    looks += static_cast<int>(run.time_s.size());
    failing +=
        static_cast<int>(std::count(labels.back().begin(), labels.back().end(), Label::kFails));
    holding +=
        static_cast<int>(std::count(labels.back().begin(), labels.back().end(), Label::kHolds));
  }
  Json summary = {{"runs", runs.size()},        {"looks", looks},
                  {"failures", failures},       {"windows_failing", failing},
                  {"windows_holding", holding}, {"predictors", Json::array()}};
  if (failing == 0 || holding == 0) return summary;
  const bool enough = runs.size() >= kLeastForInterval;
  const auto resampled = ResampledRuns(runs.size(), kResamples);
  struct Predictor {
    Json json;
    double area = 0;
    std::vector<double> areas;
  };
  std::vector<Predictor> predictors;
  for (std::size_t m = 0; m < WatchedMeasures().size(); ++m) {
    for (const Form form : {Form::kNow, Form::kWorst, Form::kTrend}) {
      std::vector<ScoredWindow> windows;
      for (std::size_t r = 0; r < runs.size(); ++r)
        for (std::size_t i = 0; i < runs[r].time_s.size(); ++i)
          if (labels[r][i] != Label::kLeftOut)
            windows.push_back({Score(runs[r], i, m, form), labels[r][i] == Label::kFails, r});
      const Roc roc(std::move(windows));
      const std::vector<RocPoint> points = roc.Points();
      Predictor predictor;
      predictor.area = roc.Area(std::vector<double>(runs.size(), 1.0));
      for (const auto& weights : resampled) predictor.areas.push_back(roc.Area(weights));
      const Foretold told = CountForetold(runs, labels, m, form, roc.Threshold(kFalseAlarms));
      predictor.json = {{"measure", WatchedMeasures()[m].name},
                        {"title", WatchedMeasures()[m].title},
                        {"form", Name(form)},
                        {"auc", predictor.area},
                        {"low", nullptr},
                        {"high", nullptr},
                        {"foretold", ForetoldAt(points, kFalseAlarms)},
                        {"failures_with_windows", told.failures},
                        {"failures_foretold", told.foretold},
                        {"roc", Thinned(points)}};
      if (enough) AddInterval(predictor.areas, "low", "high", &predictor.json);
      predictors.push_back(std::move(predictor));
    }
  }
  std::stable_sort(predictors.begin(), predictors.end(),
                   [](const Predictor& a, const Predictor& b) { return a.area > b.area; });
  const std::vector<double> best = predictors.front().areas;
  for (Predictor& predictor : predictors) {
    std::vector<double> behind;
    for (std::size_t k = 0; k < best.size(); ++k) behind.push_back(best[k] - predictor.areas[k]);
    predictor.json["behind"] = predictors.front().area - predictor.area;
    predictor.json["behind_low"] = predictor.json["behind_high"] = nullptr;
    if (enough) AddInterval(std::move(behind), "behind_low", "behind_high", &predictor.json);
    summary["predictors"].push_back(std::move(predictor.json));
  }
  return summary;
}

}  // namespace regrasp::cli
