// regrasp-plot-experiment SUMMARY.json PICTURE [WIDTH_MM]: draws what `regrasp experiment` has
// summed up. A program of its own, so that `regrasp` does not link OpenCV.

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/common/count_text.h"
#include "snapshots/plot_experiment.h"

namespace regrasp {
namespace {

using Json = nlohmann::ordered_json;

ShareMark Share(const Json& count, std::string name) {
  return {std::move(name), count.at("share"), count.at("low"), count.at("high")};
}

ShareMark Rest(const Json& count, std::string name) {
  const ShareMark all = Share(count, std::move(name));
  return {all.name, 1 - all.share, 1 - all.high, 1 - all.low};
}

QuantileMark Quantiles(const Json& json, double scale) {
  if (json.at("n") == 0) return {};
  const auto value = [&](const char* name) { return scale * json.at(name).get<double>(); };
  std::vector<double> few;
  if (json.contains("values"))
    for (const Json& one : json.at("values")) few.push_back(scale * one.get<double>());
  return {true,         std::move(few), value("q05"), value("q25"), value("median"),
          value("q75"), value("q95")};
}

std::string Joined(const Json& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + name.get<std::string>();
  return text;
}

/// " · gait.mode returning ...": what holds for every trial.
std::string Settings(const Json& plan) {
  std::string text;
  for (const auto& [name, value] : plan.at("set").items())
    text += fmt::format(" · {} {}", name, value.get<std::string>());
  return text;
}

/// "−z" for "0,0,-1", else as it is.
std::string AxisName(const std::string& axis) {
  for (const auto& [text, name] :
       {std::pair{"1,0,0", "+x"}, std::pair{"-1,0,0", "−x"}, std::pair{"0,1,0", "+y"},
        std::pair{"0,-1,0", "−y"}, std::pair{"0,0,1", "+z"}, std::pair{"0,0,-1", "−z"}})
    if (axis == text) return name;
  return axis;
}

/// Explorations at several levels of noise.
bool IsSweep(const Json& summary) {
  const Json& plan = summary.at("experiment");
  return !plan.contains("axes") && plan.at("noise").size() > 1 && !plan.contains("cases");
}

std::string SeedsOf(const Json& plan) {
  const auto first = plan.at("first_seed").get<std::int64_t>(),
             number = plan.at("seeds").get<std::int64_t>();
  return number == 1 ? fmt::format("seed {}", first)
                     : fmt::format("seeds {} to {}", first, first + number - 1);
}

ExperimentPicture PictureOf(const Json& summary) {
  const Json& plan = summary.at("experiment");
  const bool rotation = plan.contains("axes");
  const bool map = !rotation && plan.at("rays").get<int>() > 0;
  const bool sweep = plan.at("noise").size() > 1;
  ExperimentPicture picture;
  picture.title = rotation           ? "Turning the object by finger gait"
                  : IsSweep(summary) ? "Exploring with one finger: success against sensor noise"
                                     : "Exploring with one finger: how often it succeeds";
  picture.facts = fmt::format(
      "{} · noise {} · {} · {} · regrasp {}",
      rotation ? CountText(fmt::format("{:.3g}", plan.at("turns").get<double>()), "turn")
               : "criterion " + plan.at("criterion").get<std::string>(),
      Joined(plan.at("noise")) + Settings(plan), SeedsOf(plan),
      CountText(summary.at("trials").get<int>(), "trial"), plan.at("version").get<std::string>());
  struct Measure {
    const char *name, *label;
    double scale;
  };
  std::vector<Measure> measures;
  if (rotation)
    measures = {{"rate_deg_min", "rate  [°/min]", 1},
                {"max_position_error_m", "object off its place, most  [mm]", 1000}};
  else if (map)
    measures = {{"share_of_best", "φ at the end, of the best within reach  [%]", 100}};
  else
    measures = {{"phi_true_gain", "gain of φ  [%]", 100}};
  for (const Measure& measure : measures) picture.measure_labels.push_back(measure.label);
  const bool axes = rotation && plan.at("axes").size() > 1;
  for (const Json& json : summary.at("groups")) {
    ExperimentGroup group;
    const std::string noise = json.at("noise");
    const std::string name = json.value("case", "");
    const Json& counts = json.at("counts");
    if (rotation) {
      const std::string axis = "axis " + AxisName(json.at("axis_W"));
      group.row = !name.empty() ? name : axes || !sweep ? axis : "noise " + noise;
      group.panel = !name.empty() && axes ? axis : "";
      group.series = !name.empty() || axes ? "noise " + noise : "";
      group.shares = {Share(counts.at("completed"), "completed"),
                      Rest(counts.at("dropped"), "object not dropped")};
    } else {
      const std::string finger = json.at("finger");
      group.row = sweep ? noise : finger;
      group.panel = sweep ? finger : "";
      group.series = json.at("estimator");
      if (!name.empty()) group.panel = group.panel.empty() ? name : name + ", " + group.panel;
      group.shares = {Share(counts.at("rose"), "φ rose")};
      if (map) group.shares.push_back(Share(counts.at("near_best"), "within 5 % of the best"));
    }
    for (const Measure& measure : measures)
      group.measures.push_back(Quantiles(json.at("quantiles").at(measure.name), measure.scale));
    picture.groups.push_back(group);
  }
  return picture;
}

/// The best form of each measure.
PredictionPicture PredictionOf(const Json& summary) {
  const Json &plan = summary.at("experiment"), &prediction = summary.at("prediction");
  PredictionPicture picture;
  picture.title = "What foretells that a gait fails, 0.2 to 1 s ahead";
  picture.facts = fmt::format(
      "{} runs, {} drops and slips, {} windows before one and {} that hold, noise {}, {}, "
      "regrasp {}",
      prediction.at("runs").get<int>(), prediction.at("failures").get<int>(),
      prediction.at("windows_failing").get<int>(), prediction.at("windows_holding").get<int>(),
      Joined(plan.at("noise")), SeedsOf(plan), plan.at("version").get<std::string>());
  for (const Json& json : prediction.at("predictors")) {
    const std::string name = json.at("title");
    const bool known = std::any_of(picture.predictors.begin(), picture.predictors.end(),
                                   [&](const PredictorMark& p) { return p.name == name; });
    if (known) continue;
    const Json& area = json.at("auc");
    const bool interval = json.at("low").is_number();  // too few runs have none
    PredictorMark mark{name,
                       json.at("form"),
                       area,
                       interval ? json.at("low") : area,
                       interval ? json.at("high") : area,
                       {},
                       {}};
    for (const Json& point : json.at("roc")) {
      mark.false_alarms.push_back(point.at(0));
      mark.foretold.push_back(point.at(1));
    }
    picture.predictors.push_back(std::move(mark));
  }
  return picture;
}

}  // namespace
}  // namespace regrasp

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) {
    fmt::print(stderr, "usage: regrasp-plot-experiment SUMMARY.json PICTURE [WIDTH_MM]\n");
    return 2;
  }
  try {
    std::ifstream file(argv[1]);
    const auto summary = nlohmann::ordered_json::parse(file);
    if (summary.contains("prediction") && !summary["prediction"]["predictors"].empty()) {
      regrasp::PlotPrediction(regrasp::PredictionOf(summary), argv[2]);
      return 0;
    }
    const auto draw = regrasp::IsSweep(summary) ? regrasp::PlotSweep : regrasp::PlotExperiment;
    regrasp::ExperimentPicture picture = regrasp::PictureOf(summary);
    if (argc == 4) picture.width_mm = std::strtod(argv[3], nullptr);
    draw(picture, argv[2]);
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "regrasp-plot-experiment: {}\n", error.what());
    return 74;
  }
}
