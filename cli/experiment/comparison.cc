#include "cli/experiment/comparison.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "cli/experiment/paired.h"
#include "cli/print/print.h"

namespace regrasp::cli {
namespace {

constexpr double kDegrees = 57.29577951308232;

/// Two settings: the member of a row that tells them apart, and its two values.
struct Contrast {
  std::string what, base, other;
};

using Pairs = std::vector<std::pair<const Json*, const Json*>>;
using Key = std::pair<std::string, std::int64_t>;  ///< case and subject of a pair, its seed

double Mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// A measure of both settings, over the pairs in which both are known.
Json Compare(const Measure& measure, const Pairs& pairs) {
  std::vector<double> base, other, differences;
  int gained = 0, lost = 0;
  for (const auto& [first, second] : pairs) {
    const Json &a = At(*first, measure.column), &b = At(*second, measure.column);
    if (!measure.success && !(a.is_number() && b.is_number())) continue;
    base.push_back(measure.success ? a == true : a.get<double>());
    other.push_back(measure.success ? b == true : b.get<double>());
    differences.push_back(other.back() - base.back());
    gained += measure.success && differences.back() > 0;
    lost += measure.success && differences.back() < 0;
  }
  Json json = {{"n", differences.size()}};
  if (differences.empty()) return json;
  const auto interval = BootstrapInterval(differences);
  json.update({{"base", Mean(base)},
               {"other", Mean(other)},
               {"difference", Mean(differences)},
               {"low", interval ? Json(interval->low) : Json()},
               {"high", interval ? Json(interval->high) : Json()},
               {"sd", StandardDeviation(differences)},
               {"test", measure.success ? "mcnemar" : "wilcoxon"},
               {"p", measure.success ? McNemarP(gained, lost) : WilcoxonP(differences)}});
  if (measure.success) json.update({{"gained", gained}, {"lost", lost}});
  return json;
}

/// Rows of one setting by what pairs them.
std::map<Key, const Json*> Rows(const Trials& trials, const Json& wanted, bool by_case) {
  std::map<Key, const Json*> rows;
  for (const auto& [unit, result] : trials)
    for (const Json& row : result.rows) {
      if (!std::all_of(wanted.items().begin(), wanted.items().end(), [&](const auto& item) {
            return At(row, item.key().c_str()) == item.value();
          }))
        continue;
      const std::string subject = Plain(At(row, "finger")) + Plain(At(row, "axis_W"));
      const std::string of_case = by_case ? Plain(At(row, "case")) : "";
      rows[{of_case + "/" + subject, At(row, "seed").get<std::int64_t>()}] = &row;
    }
  return rows;
}

/// Rows of both settings with the same seed, within `cell`.
Pairs PairsOf(const Trials& trials, const Contrast& contrast, const Json& cell) {
  Json first = cell, second = cell;
  for (Json* wanted : {&first, &second})
    for (const char* key : {"case", "finger"})
      if (At(*wanted, key) == "all") wanted->erase(key);
  first[contrast.what] = contrast.base;
  second[contrast.what] = contrast.other;
  const auto base = Rows(trials, first, contrast.what != "case");
  const auto other = Rows(trials, second, contrast.what != "case");
  Pairs pairs;
  for (const auto& [key, row] : base)
    if (const auto match = other.find(key); match != other.end())
      pairs.emplace_back(row, match->second);
  return pairs;
}

/// Whether both settings maximise the same in every pair: else their phi have different units.
bool SameCriterion(const Pairs& pairs) {
  return std::all_of(pairs.begin(), pairs.end(), [](const auto& pair) {
    return At(*pair.first, "criterion") == At(*pair.second, "criterion");
  });
}

Json Comparison(const Plan& plan, const Contrast& contrast, const Json& cell, const Pairs& pairs) {
  const bool same = SameCriterion(pairs);
  Json measures = Json::object(), left_out = Json::array();
  for (const Measure& measure : MeasuresOf(plan))
    if (same || !measure.of_criterion)
      measures[measure.column] = Compare(measure, pairs);
    else
      left_out.push_back(measure.column);
  Json json = {{"what", contrast.what}, {"base", contrast.base}, {"other", contrast.other}};
  json.update(cell);
  json["pairs"] = pairs.size();
  if (!left_out.empty()) json["left_out"] = left_out;
  json["measures"] = measures;
  return json;
}

/// The members that tell groups of rows apart, other than `what`; {"finger": "all"} is the sum.
std::vector<Json> Cells(const Plan& plan, const std::string& what) {
  std::vector<Json> cells = {Json::object()};
  const auto cross = [&cells](const char* key, const std::vector<std::string>& values) {
    std::vector<Json> crossed;
    for (const Json& cell : cells)
      for (const std::string& value : values) {
        crossed.push_back(cell);
        crossed.back()[key] = value;
      }
    cells = std::move(crossed);
  };
  if (what != "case" && !plan.cases.empty()) {
    std::vector<std::string> names;
    for (const Case& c : plan.cases) names.push_back(c.name);
    cross("case", names);
  }
  cross("noise", plan.noise);
  if (!plan.rotation() && what != "estimator") cross("estimator", plan.estimators);
  std::vector<std::string> subjects = plan.subjects;
  if (!plan.rotation() && subjects.size() > 1) subjects.emplace_back("all");
  cross(plan.rotation() ? "axis_W" : "finger", subjects);
  return cells;
}

std::vector<Contrast> Contrasts(const Plan& plan) {
  std::vector<Contrast> contrasts;
  for (const Case& c : plan.cases) {
    const auto bases = c.against.empty() ? std::vector{plan.cases.front().name} : c.against;
    for (const std::string& base : bases)
      if (base != c.name) contrasts.push_back({"case", base, c.name});
  }
  if (!plan.rotation())
    for (std::size_t i = 1; i < plan.estimators.size(); ++i)
      contrasts.push_back({"estimator", plan.estimators.front(), plan.estimators[i]});
  return contrasts;
}

std::vector<std::string> Parts(const std::string& name) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (auto comma = name.find(", "); comma != name.npos; comma = name.find(", ", begin)) {
    parts.push_back(name.substr(begin, comma - begin));
    begin = comma + 2;
  }
  parts.push_back(name.substr(begin));
  return parts;
}

/// What two cases differ in: "planned" and "exploring" of "egg, planned" and "egg, exploring"; the
/// names where that is not one part.
std::pair<std::string, std::string> Labels(const Contrast& contrast) {
  const auto base = Parts(contrast.base), other = Parts(contrast.other);
  std::pair labels{contrast.base, contrast.other};
  if (base.size() != other.size()) return labels;
  int differing = 0;
  for (std::size_t i = 0; i < base.size(); ++i)
    if (base[i] != other[i] && ++differing == 1) labels = {base[i], other[i]};
  return differing == 1 ? labels : std::pair{contrast.base, contrast.other};
}

/// Contrasts of cases that ask the same of different objects or settings, by their labels.
std::map<std::pair<std::string, std::string>, std::vector<Contrast>> Alike(
    const std::vector<Contrast>& contrasts) {
  std::map<std::pair<std::string, std::string>, std::vector<Contrast>> alike;
  for (const Contrast& contrast : contrasts)
    if (contrast.what == "case") alike[Labels(contrast)].push_back(contrast);
  std::erase_if(alike, [](const auto& item) { return item.second.size() < 2; });
  return alike;
}

bool IsSum(const Json& comparison) {
  return At(comparison, "finger") == "all" || At(comparison, "case") == "all";
}

/// Fills in p_holm of one family: the same measure, sums apart from what they sum.
void Adjust(Json* comparisons, const std::string& what, const char* column, bool sums) {
  std::vector<Json*> family;
  std::vector<double> p;
  for (Json& comparison : *comparisons) {
    if (At(comparison, "what") != what || IsSum(comparison) != sums) continue;
    const auto measure = comparison["measures"].find(column);
    if (measure == comparison["measures"].end() || !measure->contains("p")) continue;
    family.push_back(&*measure);
    p.push_back(measure->at("p"));
  }
  const std::vector<double> adjusted = HolmAdjusted(p);
  for (std::size_t i = 0; i < family.size(); ++i) (*family[i])["p_holm"] = adjusted[i];
}

}  // namespace

std::vector<Measure> MeasuresOf(const Plan& plan) {
  if (plan.rotation())
    return {{"completed", "completed %", 100, 0, true},
            {"rate_deg_min", "deg/min", 1, 0, false},
            {"step_mean_rad", "deg between regrasps", kDegrees, 1, false},
            {"phi_gain_mean", "φ gain %", 100, 1, false},
            {"max_position_error_m", "offset mm", 1e3, 2, false}};
  std::vector<Measure> measures = {{"rose", "φ rose %", 100, 0, true}};
  if (plan.rays > 0) {
    measures.push_back({"near_best", "within 5 % of best %", 100, 0, true});
    measures.push_back({"share_of_best", "share of best", 1, 3, false});
    measures.push_back({"near_best_s", "s to 95 % of best", 1, 2, false});
  }
  measures.push_back({"phi_true_final", "φ at the end", 1, 3, false, true});
  measures.push_back({"phi_true_gain", "φ gain %", 100, 1, false, true});
  measures.push_back({"cycles", "cycles", 1, 0, false});
  return measures;
}

Json Comparisons(const Plan& plan, const Trials& trials) {
  Json comparisons = Json::array();
  const auto contrasts = Contrasts(plan);
  for (const Contrast& contrast : contrasts)
    for (const Json& cell : Cells(plan, contrast.what))
      comparisons.push_back(Comparison(plan, contrast, cell, PairsOf(trials, contrast, cell)));
  for (const auto& [labels, alike] : Alike(contrasts))
    for (const Json& cell : Cells(plan, "case")) {
      Pairs pairs;
      for (const Contrast& contrast : alike) {
        const Pairs more = PairsOf(trials, contrast, cell);
        pairs.insert(pairs.end(), more.begin(), more.end());
      }
      Json of = {{"case", "all"}};
      of.update(cell);
      comparisons.push_back(Comparison(plan, {"case", labels.first, labels.second}, of, pairs));
    }
  for (const char* what : {"case", "estimator"})
    for (const Measure& measure : MeasuresOf(plan))
      for (const bool sums : {false, true}) Adjust(&comparisons, what, measure.column, sums);
  return comparisons;
}

}  // namespace regrasp::cli
