// regrasp-plot-experiment SUMMARY.json PICTURE.png: draws what `regrasp experiment` has summed up.
// A program of its own, so that `regrasp` does not link OpenCV.

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "snapshots/plot_experiment.h"

namespace regrasp {
namespace {

using Json = nlohmann::ordered_json;

ShareMark Share(const Json& count, std::string name) {
  return {std::move(name), count.at("share"), count.at("low"), count.at("high")};
}

QuantileMark Quantiles(const Json& json, double scale) {
  if (json.at("n") == 0) return {};
  const auto value = [&](const char* name) { return scale * json.at(name).get<double>(); };
  return {true, value("q05"), value("q25"), value("median"), value("q75"), value("q95")};
}

std::string Joined(const Json& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + name.get<std::string>();
  return text;
}

ExperimentPicture PictureOf(const Json& summary) {
  const Json& plan = summary.at("experiment");
  const bool rotation = plan.at("experiment") == "rotation";
  const bool map = !rotation && plan.at("rays").get<int>() > 0;
  const bool sweep = plan.at("noise").size() > 1;
  ExperimentPicture picture;
  picture.title = rotation ? "Turning the object by finger gait"
                           : "Exploring with one finger: how often it succeeds";
  picture.facts = fmt::format(
      "{}, noise {}, seeds {} to {}, {} trials, regrasp {}",
      rotation ? fmt::format("{:g} turns", plan.at("turns").get<double>())
               : "criterion " + plan.at("criterion").get<std::string>(),
      Joined(plan.at("noise")), plan.at("first_seed").get<std::int64_t>(),
      plan.at("first_seed").get<std::int64_t>() + plan.at("seeds").get<std::int64_t>() - 1,
      summary.at("trials").get<int>(), plan.at("version").get<std::string>());
  picture.measure_label = rotation ? "rate  [deg/min]"
                          : map    ? "φ at the end, share of the best within reach  [%]"
                                   : "gain of φ  [%]";
  const char* measure = rotation ? "rate_deg_min" : map ? "share_of_best" : "phi_true_gain";
  for (const Json& json : summary.at("groups")) {
    ExperimentGroup group;
    const std::string noise = json.at("noise");
    const Json& counts = json.at("counts");
    if (rotation) {
      group.row = "axis " + json.at("axis_W").get<std::string>();
      group.series = noise;
      group.shares = {Share(counts.at("completed"), "completed")};
    } else {
      group.row = sweep ? noise : json.at("finger").get<std::string>();
      group.panel = sweep ? json.at("finger").get<std::string>() : "";
      group.series = json.at("estimator");
      group.shares = {Share(counts.at("rose"), "φ rose")};
      if (map) group.shares.push_back(Share(counts.at("near_best"), "within 5 % of the best"));
    }
    group.measure = Quantiles(json.at("quantiles").at(measure), rotation ? 1 : 100);
    picture.groups.push_back(group);
  }
  return picture;
}

}  // namespace
}  // namespace regrasp

int main(int argc, char** argv) {
  if (argc != 3) {
    fmt::print(stderr, "usage: regrasp-plot-experiment SUMMARY.json PICTURE.png\n");
    return 2;
  }
  try {
    std::ifstream file(argv[1]);
    regrasp::PlotExperiment(regrasp::PictureOf(nlohmann::ordered_json::parse(file)), argv[2]);
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "regrasp-plot-experiment: {}\n", error.what());
    return 74;
  }
}
