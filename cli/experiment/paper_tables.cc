#include "cli/experiment/paper_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "cli/client/errors.h"
#include "cli/experiment/statistics.h"
#include "cli/print/print.h"

namespace regrasp::cli {
namespace {

constexpr int kRays = 12;       // the default
constexpr double kParts = 100;  // a number of turns with two decimals is written as turns

/// "−z" for "0,0,-1", else as it is.
std::string AxisName(const std::string& axis) {
  static const std::map<std::string, std::string> kNames = {{"1,0,0", "+x"}, {"-1,0,0", "−x"},
                                                            {"0,1,0", "+y"}, {"0,-1,0", "−y"},
                                                            {"0,0,1", "+z"}, {"0,0,-1", "−z"}};
  const auto name = kNames.find(axis);
  return name == kNames.end() ? axis : name->second;
}

/// What the rows of an experiment differ in.
std::string RowName(const Json& plan, const Json& group) {
  if (group.contains("case")) return Plain(group.at("case"));
  if (plan.at("axes").size() > 1) return AxisName(Plain(group.at("axis_W")));
  return Plain(group.at("noise"));
}

int NumberOf(const Json& group, const char* count) {
  const Json& counts = group.at("counts");
  return counts.contains(count) ? counts.at(count).at("k").get<int>() : 0;
}

}  // namespace

const Json& GroupOf(const Json& summary, const Json& wanted) {
  for (const Json& group : summary.at("groups"))
    if (std::all_of(wanted.items().begin(), wanted.items().end(), [&](const auto& item) {
          return At(group, item.key().c_str()) == item.value();
        }))
      return group;
  throw CliError(kFailed, fmt::format("the summary has no group {}", wanted.dump()));
}

std::string Share(int k, int n) {
  const Interval interval = WilsonInterval(k, n);
  return fmt::format("{}/{} ({:.0f}–{:.0f} %)", k, n, 100 * interval.low, 100 * interval.high);
}

std::string Share(const Json& group, const char* count) {
  return Share(group.at("counts").at(count).at("k").get<int>(), group.at("n").get<int>());
}

std::string CommandOf(const Json& summary) {
  const Json& p = summary.at("experiment");
  const auto list = [&p](const char* key) {
    return fmt::format("{}", fmt::join(p.at(key).get<std::vector<std::string>>(), ","));
  };
  std::string text = "regrasp experiment " + Plain(p.at("experiment"));
  if (p.contains("estimators")) text += " --estimator " + list("estimators");
  if (p.contains("fingers") && p.at("fingers").size() == 1) text += " --finger " + list("fingers");
  if (p.contains("rays") && p.at("rays") != kRays) text += " --rays " + Plain(p.at("rays"));
  if (p.contains("turns")) {
    const double turns = p.at("turns");
    const bool whole = turns * kParts == std::round(turns * kParts);
    text += whole ? fmt::format(" --turns {}", turns) : fmt::format(" --angle {:.6g}", 360 * turns);
    text += p.at("axes").size() > 1 ? " --axis all" : " --axis=" + list("axes");
    if (p.at("noise").size() > 1) text += " --noise " + list("noise");
  }
  for (const auto& [name, value] : p.at("set").items())
    text += fmt::format(" --set {}={}", name, Plain(value));
  text += fmt::format(" --seed {} -n {}", p.at("first_seed").get<std::int64_t>(),
                      p.at("seeds").get<std::int64_t>());
  if (p.contains("cases"))
    for (const Json& c : p.at("cases")) text += fmt::format(" \\\n  --case '{}'", Plain(c));
  return text + " -o DIR";
}

std::string RotationTable(const Json& summary) {
  const Json& plan = summary.at("experiment");
  const bool explores = std::any_of(
      summary.at("groups").begin(), summary.at("groups").end(),
      [](const Json& g) { return g.at("quantiles").at("phi_rise_share").at("n") != 0; });
  std::string text = fmt::format(
      "| | completed | dropped | stopped, object held | °/min, median | ° between regrasps, mean | "
      "object off its place, most | slips, mean |{}\n|---|---|---|---|---|---|---|---|{}\n",
      explores ? " φ rose | gain of φ |" : "", explores ? "---|---|" : "");
  for (const Json& g : summary.at("groups")) {
    const Json& quantiles = g.at("quantiles");
    const int stopped = NumberOf(g, "failed") + NumberOf(g, "refused") + NumberOf(g, "unfinished");
    const int ungrasped = NumberOf(g, "not_grasped");
    text +=
        fmt::format("| {} | {} | {} | {} | {} | {} | {} mm | {} |", RowName(plan, g),
                    Share(g, "completed"), NumberOf(g, "dropped"),
                    fmt::format("{}{}", stopped,
                                ungrasped > 0 ? fmt::format("; {} not grasped", ungrasped) : ""),
                    Fixed(At(quantiles.at("rate_deg_min"), "median"), 0),
                    Fixed(At(quantiles.at("step_mean_rad"), "mean"), 1, 180 / std::numbers::pi),
                    Fixed(At(quantiles.at("max_position_error_m"), "max"), 1, 1e3),
                    Fixed(At(quantiles.at("slips"), "mean"), 1));
    if (explores && quantiles.at("phi_rise_share").at("n") == 0)
      text += " – | – |";
    else if (explores)
      text +=
          fmt::format(" {} % | {} % |", Fixed(At(quantiles.at("phi_rise_share"), "mean"), 0, 100),
                      Fixed(At(quantiles.at("phi_gain_mean"), "mean"), 1, 100));
    text += "\n";
  }
  return text;
}

std::string ExplorationTable(const Json& summary) {
  const bool map = summary.at("experiment").at("rays") != 0;
  std::string text = fmt::format(
      "| finger | estimator | φ rose |{} gain, median | ended by the gradient test | refused | "
      "dropped |\n|---|---|---|{}---|---|---|---|\n",
      map ? " within 5 % of the best | share of the best: median (5 … 95 % of trials) |" : "",
      map ? "---|---|" : "");
  for (const Json& g : summary.at("groups")) {
    text += fmt::format("| {} | {} | {} |", Plain(g.at("finger")), Plain(g.at("estimator")),
                        Share(g, "rose"));
    if (map) {
      const Json& share = g.at("quantiles").at("share_of_best");
      text += fmt::format(" {} | {} ({} … {}) % |", Share(g, "near_best"),
                          Fixed(At(share, "median"), 0, 100), Fixed(At(share, "q05"), 0, 100),
                          Fixed(At(share, "q95"), 0, 100));
    }
    text += fmt::format(" {} % | {} | {} | {} |\n",
                        Fixed(At(g.at("quantiles").at("phi_true_gain"), "median"), 1, 100),
                        Share(g, "converged"), NumberOf(g, "refused"), NumberOf(g, "dropped"));
  }
  return text;
}

std::string OutcomeTable(const Json& summary, const std::string& finger) {
  std::string text =
      "| noise | estimator | not grasped | refused | contact lost | dropped | otherwise failed |\n"
      "|---|---|---|---|---|---|---|\n";
  for (const Json& g : summary.at("groups"))
    if (g.at("finger") == finger)
      text +=
          fmt::format("| {} | {} | {} | {} | {} | {} | {} |\n", Plain(g.at("noise")),
                      Plain(g.at("estimator")), NumberOf(g, "not_grasped"), NumberOf(g, "refused"),
                      NumberOf(g, "contact_lost"), NumberOf(g, "dropped"),
                      NumberOf(g, "failed") + NumberOf(g, "unfinished") + NumberOf(g, "fault"));
  return text;
}

std::string SweepTable(const Json& summary, const char* count) {
  const Json& plan = summary.at("experiment");
  std::vector<std::string> fingers = plan.at("fingers");
  if (fingers.size() > 1) fingers.push_back("all");
  std::string text =
      fmt::format("| noise | estimator | {} |\n|---|---|{}\n", fmt::join(fingers, " | "),
                  fmt::join(std::vector<std::string>(fingers.size(), "---|"), ""));
  for (const Json& noise : plan.at("noise"))
    for (const Json& estimator : plan.at("estimators")) {
      text += fmt::format("| {} | {} |", Plain(noise), Plain(estimator));
      for (const auto& finger : fingers)
        text += fmt::format(
            " {} |",
            Share(
                GroupOf(summary, {{"noise", noise}, {"estimator", estimator}, {"finger", finger}}),
                count));
      text += "\n";
    }
  return text;
}

}  // namespace regrasp::cli
