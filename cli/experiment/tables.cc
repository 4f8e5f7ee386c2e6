#include "cli/experiment/tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <string_view>

#include "cli/experiment/comparison.h"
#include "cli/experiment/paired.h"

namespace regrasp::cli {
namespace {

/// A share as it stands in a table: "9/10 (60–98 %)".
std::string Share(const Json& count, int n) {
  return fmt::format("{}/{} ({:.0f}–{:.0f} %)", count.at("k").get<int>(), n,
                     100 * count.at("low").get<double>(), 100 * count.at("high").get<double>());
}

/// A median: "529 (512–540)", with " n=9" where it is not known of all.
std::string Median(const Json& quantiles, int n, int digits, double scale) {
  std::string text = Fixed(At(quantiles, "median"), digits, scale);
  if (At(quantiles, "median_low").is_number())
    text += fmt::format(" ({}–{})", Fixed(quantiles["median_low"], digits, scale),
                        Fixed(quantiles["median_high"], digits, scale));
  if (At(quantiles, "n") != n) text += fmt::format(" n={}", Plain(At(quantiles, "n")));
  return text;
}

/// The members of a group or comparison that say what it is of, in the order of the columns.
std::vector<std::string> Settings(const Json& group, const std::vector<std::string>& keys) {
  std::vector<std::string> cells;
  for (const std::string& key : keys) cells.push_back(Plain(At(group, key.c_str())));
  return cells;
}

std::vector<std::string> Present(const Json& groups, std::initializer_list<const char*> keys) {
  std::vector<std::string> present;
  for (const char* key : keys)
    if (std::any_of(groups.begin(), groups.end(),
                    [key](const Json& group) { return group.contains(key); }))
      present.emplace_back(key);
  return present;
}

std::string Title(const std::string& key) { return key == "axis_W" ? "axis" : key; }

std::string Probability(const Json& p) {
  if (!p.is_number()) return "-";
  const double value = p;
  return value < 1e-4 ? fmt::format("{:.0e}", value) : fmt::format("{:.4f}", value);
}

/// " (0.712–0.803)"; empty where there is no interval.
std::string Between(const Json& json, const char* low, const char* high, const char* to) {
  if (!json.at(low).is_number()) return "";
  return fmt::format(" ({}{}{})", Fixed(json.at(low), 3), to, Fixed(json.at(high), 3));
}

/// "-": it cannot be told.
std::string Number(std::optional<int> n) { return n ? std::to_string(*n) : "-"; }

/// The measures of a summary, whose plan is JSON.
std::vector<Measure> MeasuresIn(const Json& summary) {
  const Json& json = summary.at("experiment");
  Plan plan;
  plan.experiment = json.at("experiment");
  if (At(json, "rays").is_number()) plan.rays = json.at("rays");
  return MeasuresOf(plan);
}

void Replace(std::string* text,
             std::initializer_list<std::pair<std::string_view, std::string_view>> pairs) {
  for (const auto& [from, to] : pairs)
    for (std::size_t at = 0; (at = text->find(from, at)) != std::string::npos; at += to.size())
      text->replace(at, from.size(), to);
}

std::string Escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (std::string_view("%&_#{}$").find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  for (std::size_t i = 0; i + 1 < out.size(); ++i)  // a minus sign, no hyphen
    if (out[i] == '-' && std::isdigit(static_cast<unsigned char>(out[i + 1])) &&
        (i == 0 || out[i - 1] == ' ' || out[i - 1] == '('))
      out.replace(i, 1, "$-$");
  Replace(&out, {{"φ", "$\\varphi$"}, {"±", "$\\pm$"}, {"–", "--"}, {"°", "$^\\circ$"}});
  return out;
}

std::string Markdown(const TableData& table) {
  const auto line = [](const std::vector<std::string>& cells) {
    std::string text = "|";
    for (const std::string& cell : cells) text += " " + cell + " |";
    return text + "\n";
  };
  std::vector<std::string> titles, rules;
  for (const std::string& title : table.titles) {
    const bool right = title.starts_with('>');
    titles.push_back(title.substr(right));
    rules.push_back(right ? "---:" : "---");
  }
  std::string text = line(titles) + line(rules);
  for (const auto& row : table.rows) text += line(row);
  return text;
}

std::string Latex(const TableData& table) {
  const auto line = [](const std::vector<std::string>& cells) {
    std::string text;
    for (const std::string& cell : cells) text += (text.empty() ? "" : " & ") + Escaped(cell);
    return text + " \\\\\n";
  };
  std::string columns;
  std::vector<std::string> titles;
  for (const std::string& title : table.titles) {
    const bool right = title.starts_with('>');
    titles.push_back(title.substr(right));
    columns += right ? 'r' : 'l';
  }
  std::string text = "% \\usepackage{booktabs}\n\\begin{tabular}{" + columns + "}\n\\toprule\n" +
                     line(titles) + "\\midrule\n";
  for (const auto& row : table.rows) text += line(row);
  return text + "\\bottomrule\n\\end{tabular}\n";
}

void Append(std::vector<std::string>* to, std::vector<std::string> more) {
  to->insert(to->end(), more.begin(), more.end());
}

}  // namespace

TableFormat TableFormatOf(const std::string& word) {
  return word == "markdown" ? TableFormat::kMarkdown
         : word == "latex"  ? TableFormat::kLatex
                            : TableFormat::kText;
}

std::string Note(const Output& out, std::string text, TableFormat format) {
  if (format == TableFormat::kLatex) return "% " + Escaped(text) + "\n";
  if (format == TableFormat::kText && out.Phi() != "φ") Replace(&text, {{"φ", "phi"}});
  return (format == TableFormat::kMarkdown ? "\n" : "") + text + "\n";
}

std::string Render(const Output& out, const TableData& table, TableFormat format) {
  if (format == TableFormat::kMarkdown) return Markdown(table);
  if (format == TableFormat::kLatex) return Latex(table);
  Table text(table.titles);
  for (const auto& row : table.rows) text.Row(row);
  std::string lines = text.Text(out);
  if (out.Phi() != "φ")  // a terminal without UTF-8
    Replace(&lines, {{"φ", "phi"}, {"±", "+-"}, {"–", "-"}});
  return lines;
}

TableData GroupTable(const Json& summary) {
  const Json &plan = summary.at("experiment"), &groups = summary.at("groups");
  const bool rotation = plan.contains("axes");
  const bool map = At(plan, "rays").is_number() && plan.at("rays").get<int>() > 0;
  const auto keys = Present(groups, {"case", "noise", "axis_W", "estimator", "finger"});
  TableData table;
  for (const std::string& key : keys) table.titles.push_back(Title(key));
  if (rotation)
    Append(&table.titles, {"completed", ">deg/min", ">deg between regrasps", ">offset mm",
                           ">at most", ">tilt at most deg"});
  else
    Append(&table.titles, {"φ rose"});
  if (map) Append(&table.titles, {"within 5 % of best", ">share of best", ">s to 95 % of best"});
  if (!rotation) Append(&table.titles, {">gain %"});
  Append(&table.titles, {">dropped", rotation ? ">fault" : ">refused"});
  for (const auto& group : groups) {
    const int n = group.at("n");
    const Json &counts = group.at("counts"), &quantiles = group.at("quantiles");
    const auto number = [&counts](const char* name) {
      return counts.contains(name) ? Plain(counts[name].at("k")) : "0";
    };
    const auto median = [&](const char* name, int digits, double scale) {
      return Median(quantiles.at(name), n, digits, scale);
    };
    const auto most = [&](const char* name, int digits, double scale) {
      return Fixed(At(quantiles.at(name), "max"), digits, scale);
    };
    std::vector<std::string> cells = Settings(group, keys);
    if (rotation)
      Append(&cells,
             {Share(counts.at("completed"), n), median("rate_deg_min", 0, 1),
              median("step_mean_rad", 1, 180 / M_PI), median("max_position_error_m", 2, 1e3),
              most("max_position_error_m", 2, 1e3), most("max_tilt_rad", 1, 180 / M_PI)});
    else
      Append(&cells, {Share(counts.at("rose"), n)});
    if (map)
      Append(&cells, {Share(counts.at("near_best"), n), median("share_of_best", 3, 1),
                      median("near_best_s", 2, 1)});
    if (!rotation) Append(&cells, {median("phi_true_gain", 1, 100)});
    Append(&cells, {number("dropped"), number(rotation ? "fault" : "refused")});
    table.rows.push_back(std::move(cells));
  }
  return table;
}

TableData ComparisonTable(const Json& summary) {
  const Json& comparisons = At(summary, "comparisons");
  const auto keys = Present(comparisons, {"case", "noise", "axis_W", "estimator", "finger"});
  TableData table;
  for (const std::string& key : keys) table.titles.push_back(Title(key));
  Append(&table.titles, {"setting", "against", "measure", ">n", ">setting", ">against",
                         ">difference (95 %)", ">p", ">Holm"});
  for (const Json& comparison : comparisons) {
    for (const Measure& measure : MeasuresIn(summary)) {
      const Json& m = At(comparison.at("measures"), measure.column);
      if (!At(m, "difference").is_number()) continue;
      const auto number = [&](const char* key) {
        return Fixed(m.at(key), measure.digits, measure.scale);
      };
      const auto sign = [&](const char* key) {
        return (m.at(key).get<double>() > 0 ? "+" : "") + number(key);
      };
      const std::string interval =
          m.at("low").is_number() ? fmt::format(" ({} to {})", sign("low"), sign("high")) : "";
      std::vector<std::string> cells = Settings(comparison, keys);
      Append(&cells,
             {Plain(comparison.at("other")), Plain(comparison.at("base")), measure.title,
              Plain(m.at("n")), number("other"), number("base"), sign("difference") + interval,
              Probability(m.at("p")), Probability(At(m, "p_holm"))});
      table.rows.push_back(std::move(cells));
    }
  }
  return table;
}

std::string LeftOut(const Json& summary) {
  const Json& comparisons = At(summary, "comparisons");
  const bool any = std::any_of(comparisons.begin(), comparisons.end(),
                               [](const Json& one) { return one.contains("left_out"); });
  return any ? "φ is not compared between cases of different criteria: its units differ." : "";
}

TableData PredictionTable(const Json& summary) {
  TableData table;
  table.titles = {
      "measure",           "form", ">AUC (95 %)", ">behind the best (95 %)", ">windows foretold %",
      ">failures foretold"};
  for (const Json& p : summary.at("prediction").at("predictors"))
    table.rows.push_back(
        {Plain(p.at("title")), Plain(p.at("form")),
         Fixed(p.at("auc"), 3) + Between(p, "low", "high", "–"),
         Fixed(p.at("behind"), 3) + Between(p, "behind_low", "behind_high", " to "),
         Fixed(p.at("foretold"), 0, 100),
         fmt::format("{}/{}", Plain(p.at("failures_foretold")),
                     Plain(p.at("failures_with_windows")))});
  return table;
}

TableData SampleSizeTable(const Json& summary, double precision) {
  const Json& groups = summary.at("groups");
  const auto keys = Present(groups, {"case", "noise", "axis_W", "estimator", "finger"});
  TableData table;
  for (const std::string& key : keys) table.titles.push_back(Title(key));
  Append(&table.titles, {"figure", ">now", fmt::format(">n for ±{:g}", precision)});
  for (const Json& group : groups) {
    for (const Measure& measure : MeasuresIn(summary)) {
      std::vector<std::string> cells = Settings(group, keys);
      if (measure.success) {
        const Json& count = group.at("counts").at(measure.column);
        Append(&cells, {measure.title, Plain(group.at("n")),
                        std::to_string(TrialsForShare(count.at("share"), precision))});
      } else {
        const Json& quantiles = At(group.at("quantiles"), measure.column);
        if (!At(quantiles, "sd").is_number() || quantiles["mean"] == 0.0) continue;
        const double mean = std::abs(quantiles["mean"].get<double>());
        Append(&cells, {measure.title, Plain(quantiles.at("n")),
                        Number(TrialsForMean(quantiles["sd"], precision * mean))});
      }
      table.rows.push_back(std::move(cells));
    }
  }
  for (const Json& comparison : At(summary, "comparisons")) {
    for (const Measure& measure : MeasuresIn(summary)) {
      const Json& m = At(comparison.at("measures"), measure.column);
      if (!At(m, "sd").is_number() || (!measure.success && m["base"] == 0.0)) continue;
      const double base = std::abs(m["base"].get<double>());
      std::vector<std::string> cells = Settings(comparison, keys);
      Append(&cells, {fmt::format("{}: {} against {}", measure.title, Plain(comparison.at("other")),
                                  Plain(comparison.at("base"))),
                      Plain(m.at("n")),
                      measure.success ? std::to_string(TrialsForDifference(m["sd"], precision))
                                      : Number(TrialsForMean(m["sd"], precision * base))});
      table.rows.push_back(std::move(cells));
    }
  }
  return table;
}

}  // namespace regrasp::cli
