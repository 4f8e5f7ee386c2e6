// The two graphs of `top`: curves over the last 30 s of simulated time.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "cli/print/braille.h"
#include "cli/print/print.h"
#include "cli/top/panels.h"
#include "core/common/finger_letters.h"
#include "core/exploration/criterion.h"

namespace regrasp::cli {
namespace {

constexpr int kAxis = 6;        // columns of the numbers on the left
constexpr int kTwoGraphs = 56;  // columns from which both graphs are shown

struct Curve {
  const Series* series;
  Ink ink;
  char letter = 0;  ///< written at its end; 0: none
};

struct Graph {
  std::string title;
  std::vector<Curve> curves;
  std::optional<double> threshold = {};
};

/// Simulated time without samples that is drawn as a gap: a second of real time [s].
double Gap(const DashboardModel& model) {
  const Json& factor = At(model.status(), "real_time_factor");
  return std::max(1.0, factor.is_number() ? factor.get<double>() : 1.0);
}

/// The range of all curves and the threshold, a little wider; never empty.
std::pair<double, double> Range(const Graph& graph) {
  double low = 1e300, high = -1e300;
  const auto include = [&](double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  };
  for (const Curve& curve : graph.curves)
    for (const auto& point : curve.series->points()) include(point.value);
  if (graph.threshold && low < 1e299) include(*graph.threshold);
  if (low > high) return {0, 1};
  const double span = std::max(high - low, 0.02 * std::max(std::abs(high), 1e-3));
  return {std::max(low - 0.05 * span, std::min(low, 0.0)), high + 0.05 * span};
}

void Draw(Screen* screen, const Box& box, const Graph& graph, double now_s, double gap_s) {
  const std::string longer = graph.title + ", 30 s";
  screen->Rule(box, Cells(longer) + 4 <= box.columns ? longer : graph.title);
  const bool letters = graph.curves.size() > 1;
  const Box area{box.row + 1, box.column + kAxis + 1, box.rows - 1,
                 box.columns - kAxis - 1 - (letters ? 2 : 0)};
  if (area.rows < 1 || area.columns < 4) return;
  const auto [low, high] = Range(graph);
  BrailleCanvas canvas(area.columns, area.rows);
  const auto x_of = [&](double time_s) {
    return static_cast<int>(
        std::lround((1 - (now_s - time_s) / Series::kSeconds) * (canvas.width() - 1)));
  };
  const auto y_of = [&, low = low, high = high](double value) {
    return static_cast<int>(std::lround((high - value) / (high - low) * (canvas.height() - 1)));
  };
  if (graph.threshold)
    for (int x = 0; x < canvas.width(); x += 4)
      canvas.Set(x, y_of(*graph.threshold), static_cast<int>(Ink::kBad));
  for (const Curve& curve : graph.curves) {
    const auto& points = curve.series->points();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto& a = points[i == 0 ? 0 : i - 1];
      const auto& b = points[i];
      const auto& from = b.time_s - a.time_s > gap_s ? b : a;
      canvas.Line(x_of(from.time_s), y_of(from.value), x_of(b.time_s), y_of(b.value),
                  static_cast<int>(curve.ink));
    }
  }
  for (int row = 0; row < area.rows; ++row)
    for (int column = 0; column < area.columns; ++column)
      if (const char32_t glyph = canvas.Glyph(column, row); glyph != U' ')
        screen->Put(area.row + row, area.column + column, glyph,
                    static_cast<Ink>(canvas.Ink(column, row)));
  for (int row = 0; row < area.rows; ++row)
    screen->Put(area.row + row, area.column - 1, U'│', Ink::kDim);
  const auto number = [&](int row, double value) {
    screen->Put(area.row + row, box.column, fmt::format("{:>{}.3g}", value, kAxis - 1), Ink::kDim,
                kAxis);
  };
  number(0, high);
  if (area.rows > 1) number(area.rows - 1, low);
  if (area.rows > 6) number(area.rows / 2, high - (high - low) * area.rows / 2.0 / (area.rows - 1));
  for (const Curve& curve : graph.curves) {
    if (!letters || curve.series->points().empty()) continue;
    const int row = std::clamp(y_of(curve.series->points().back().value) / 4, 0, area.rows - 1);
    // Where two curves end in one row the second letter goes beside the first.
    const int column = area.column + area.columns;
    const bool taken = screen->at(area.row + row, column).glyph != U' ';
    screen->Put(area.row + row, column + (taken ? 1 : 0), static_cast<char32_t>(curve.letter),
                curve.ink);
  }
}

/// The row of what exploration maximises, or would; null before that is known.
const CriterionInfo* ActiveCriterion(const DashboardModel& model) {
  const Json& criterion = At(model.quality(), "criterion");
  return criterion.is_string() ? FindCriterion(criterion.get_ref<const std::string&>()) : nullptr;
}

/// " [active]" behind the measure that is maximised, both when it is their sum; " [NAME]" behind
/// the finger's where it is another one.
std::string ActiveMark(const DashboardModel& model, PhiOf measure) {
  const CriterionInfo* const row = ActiveCriterion(model);
  if (!row) return "";
  if (row->phi_of == measure || row->phi_of == PhiOf::kBoth) return " [active]";
  const bool other = row->phi_of != PhiOf::kManipulability && row->phi_of != PhiOf::kStability;
  return other && measure == PhiOf::kManipulability ? fmt::format(" [{}]", row->name) : "";
}

Graph ManipulabilityGraph(const DashboardModel& model, const std::string& chosen) {
  const auto names = model.Fingers();
  const std::vector<char> letters = FingerLetters(names);
  const std::string finger = chosen.empty() ? model.ExploringFinger() : chosen;
  Graph graph;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (finger.empty() || names[i] == finger)
      graph.curves.push_back(
          {&model.manipulability(names[i]), CurveInk(static_cast<int>(i)), letters[i]});
  graph.title = fmt::format("Manipulability φ{}{}", finger.empty() ? "" : " " + finger,
                            ActiveMark(model, PhiOf::kManipulability));
  return graph;
}

Graph StabilityGraph(const DashboardModel& model) {
  const Json &now = At(model.quality(), "stability"), &threshold = At(model.quality(), "threshold");
  Graph graph{"Stability", {{&model.stability(), Ink::kGood}}, {}};
  if (now.is_number() && threshold.is_number()) {
    graph.threshold = threshold.get<double>();
    const bool low = now.get<double>() < *graph.threshold;
    graph.title += fmt::format(" {} {} {}", Fixed(now, 2), low ? "<" : ">", Fixed(threshold, 2));
  }
  graph.title += ActiveMark(model, PhiOf::kStability);
  return graph;
}

}  // namespace

void DrawGraphs(Screen* screen, const Box& box, const DashboardModel& model,
                const std::string& finger) {
  const double now_s = model.time_s(), gap_s = Gap(model);
  if (box.columns < kTwoGraphs) {
    const CriterionInfo* const row = ActiveCriterion(model);
    const bool stability = row && row->phi_of == PhiOf::kStability;
    return Draw(screen, box, stability ? StabilityGraph(model) : ManipulabilityGraph(model, finger),
                now_s, gap_s);
  }
  const int left = box.columns / 2;
  Draw(screen, {box.row, box.column, box.rows, left}, ManipulabilityGraph(model, finger), now_s,
       gap_s);
  Draw(screen, {box.row, box.column + left, box.rows, box.columns - left}, StabilityGraph(model),
       now_s, gap_s);
}

}  // namespace regrasp::cli
