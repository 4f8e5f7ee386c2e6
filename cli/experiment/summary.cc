#include "cli/experiment/summary.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "cli/client/errors.h"
#include "cli/client/program.h"
#include "cli/experiment/comparison.h"
#include "cli/experiment/paired.h"
#include "cli/experiment/prediction.h"
#include "cli/experiment/statistics.h"

namespace regrasp::cli {
namespace {

namespace fs = std::filesystem;

struct Columns {
  std::vector<const char*> counts, quantiles;
};

Columns ColumnsOf(const Plan& plan) {
  if (plan.rotation())
    return {{"completed"},
            {"rate_deg_min", "step_mean_rad", "max_position_error_m", "max_tilt_rad", "angle_rad",
             "angle_error_rad", "regrasps", "slips", "refusals", "phi_rise_share", "phi_gain_mean",
             "sim_time_s"}};
  Columns columns = {{"rose"}, {"phi_true_gain", "cycles", "path_length_m", "object_moved_m"}};
  if (plan.rays > 0) {
    columns.counts.push_back("near_best");
    columns.quantiles.push_back("share_of_best");
    columns.quantiles.push_back("near_best_s");
  }
  columns.counts.push_back("converged");
  return columns;
}

Json Count(int k, int n) {
  const Interval interval = WilsonInterval(k, n);
  return {{"k", k},
          {"share", n > 0 ? static_cast<double>(k) / n : 0.0},
          {"low", interval.low},
          {"high", interval.high}};
}

Json Quantiles(std::vector<double> values) {
  Json json = {{"n", values.size()}};
  if (values.empty()) return json;
  std::sort(values.begin(), values.end());
  double sum = 0;
  for (const double value : values) sum += value;
  for (const auto& [name, share] :
       {std::pair{"min", 0.0}, std::pair{"q05", 0.05}, std::pair{"q25", 0.25},
        std::pair{"median", 0.5}, std::pair{"q75", 0.75}, std::pair{"q95", 0.95},
        std::pair{"max", 1.0}})
    json[name] = Quantile(values, share);
  json["mean"] = sum / static_cast<double>(values.size());
  json["sd"] = StandardDeviation(values);
  if (const auto interval = MedianInterval(values))
    json.update({{"median_low", interval->low}, {"median_high", interval->high}});
  constexpr std::size_t kTooFew = 5;  // for quantiles to mean anything: the picture has points
  if (values.size() < kTooFew) json["values"] = values;
  return json;
}

Json Group(const Columns& columns, const std::vector<const Json*>& rows) {
  const int n = static_cast<int>(rows.size());
  Json counts = Json::object(), quantiles = Json::object();
  for (const char* column : columns.counts) {
    const auto k = std::count_if(rows.begin(), rows.end(),
                                 [&](const Json* row) { return At(*row, column) == true; });
    counts[column] = Count(static_cast<int>(k), n);
  }
  for (const char* outcome :
       {"dropped", "refused", "not_grasped", "contact_lost", "failed", "unfinished", "fault"}) {
    const auto k = std::count_if(rows.begin(), rows.end(),
                                 [&](const Json* row) { return At(*row, "outcome") == outcome; });
    if (k > 0 || outcome == std::string("dropped")) counts[outcome] = Count(static_cast<int>(k), n);
  }
  for (const char* column : columns.quantiles) {
    std::vector<double> values;
    for (const Json* row : rows)
      if (At(*row, column).is_number()) values.push_back(At(*row, column).get<double>());
    quantiles[column] = Quantiles(values);
  }
  return {{"n", n}, {"counts", counts}, {"quantiles", quantiles}};
}

std::vector<const Json*> RowsWhere(const Trials& trials, const Json& wanted) {
  std::vector<const Json*> rows;
  for (const auto& [unit, result] : trials)
    for (const Json& row : result.rows)
      if (std::all_of(wanted.items().begin(), wanted.items().end(), [&](const auto& item) {
            return At(row, item.key().c_str()) == item.value();
          }))
        rows.push_back(&row);
  return rows;
}

void Draw(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), FindHelper("regrasp-plot-experiment"));
  if (WaitForEnd(Start(arguments)) != 0)
    throw CliError(kIo, fmt::format("{} could not draw {}", arguments[0], arguments[2]),
                   fmt::format("{}", fmt::join(arguments, " ")));
}

}  // namespace

std::string TrialsCsv(const Trials& trials) {
  CsvTable table;
  std::string text;
  for (const auto& [unit, result] : trials)
    for (const Json& row : result.rows) text += table.Row(row);
  return text;
}

std::string MapsCsv(const Trials& trials) {
  CsvTable table;
  std::string text;
  for (const auto& [unit, result] : trials)
    for (const Json& sample : result.map.is_array() ? result.map : Json::array()) {
      Json row;
      for (const char* key : {"case", "finger", "criterion", "noise", "object", "seed"})
        if (result.rows.front().contains(key)) row[key] = result.rows.front().at(key);
      row.update(sample);
      text += table.Row(row);
    }
  return text;
}

Json Summary(const Plan& plan, const Trials& trials) {
  const Columns columns = ColumnsOf(plan);
  Json groups = Json::array();
  int n = 0;
  for (const auto& [unit, result] : trials) n += static_cast<int>(result.rows.size());
  const auto add = [&](const Json& name, const Json& wanted) {
    Json group = name;
    group.update(Group(columns, RowsWhere(trials, wanted)));
    groups.push_back(group);
  };
  const auto add_case = [&](const Json& name) {
    for (const auto& noise : plan.noise) {
      if (plan.rotation()) {
        for (const auto& axis : plan.subjects) {
          Json cell = name;
          cell.update({{"noise", noise}, {"axis_W", axis}});
          add(cell, cell);
        }
        continue;
      }
      for (const auto& estimator : plan.estimators) {
        Json cell = name;
        cell.update({{"noise", noise}, {"estimator", estimator}});
        const auto with = [&cell](const std::string& finger) {
          Json json = cell;
          json["finger"] = finger;
          return json;
        };
        for (const auto& finger : plan.subjects) add(with(finger), with(finger));
        if (plan.subjects.size() > 1) add(with("all"), cell);
      }
    }
  };
  if (plan.cases.empty()) add_case(Json::object());
  for (const Case& c : plan.cases) add_case({{"case", c.name}});
  Json summary = {{"experiment", ToJson(plan)}, {"trials", n}, {"groups", groups}};
  if (plan.experiment == "prediction")
    summary["prediction"] = PredictionSummary(trials);
  else if (Json comparisons = Comparisons(plan, trials); !comparisons.empty())
    summary["comparisons"] = std::move(comparisons);
  return summary;
}

fs::path DrawForPaper(const fs::path& directory, double width_mm) {
  fs::path picture = directory / "summary.pdf";
  Draw({directory / "summary.json", picture, fmt::format("{}", width_mm)});
  return picture;
}

Json WriteResults(const Plan& plan, const Trials& trials, const fs::path& directory) {
  const Json summary = Summary(plan, trials);
  WriteFile(directory / "trials.csv", TrialsCsv(trials));
  if (const std::string maps = MapsCsv(trials); !maps.empty())
    WriteFile(directory / "maps.csv", maps);
  WriteFile(directory / "summary.json", summary.dump(1) + "\n");
  Draw({directory / "summary.json", directory / "summary.png"});
  return summary;
}

}  // namespace regrasp::cli
