#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "snapshots/axes.h"
#include "snapshots/measures.h"
#include "snapshots/plots.h"
#include "snapshots/refused.h"
#include "snapshots/timeline.h"

namespace regrasp {
namespace {

/// The stretch that explores: from the first to the last frame in which a finger does. Throws
/// PictureRefused when none does.
std::span<const Frame> Exploration(std::span<const Frame> frames, const std::string& label) {
  const auto explores = [](const Frame& frame) { return ExploringFinger(frame) >= 0; };
  const auto first = std::find_if(frames.begin(), frames.end(), explores);
  if (first == frames.end())
    throw PictureRefused(label, "no finger explores, there is nothing to compare");
  const auto last = std::find_if(frames.rbegin(), frames.rend(), explores).base();
  return {first, last};
}

Pen PenOfRun(std::size_t run) {
  static const std::array<Pen, 4> kPens = {Pen{kVermillion, 3.5}, Pen{kBlue, 3.5, {2, 7}},
                                           Pen{kGreen, 3.5, {16, 7}},
                                           Pen{kPurple, 3.5, {16, 6, 2, 6}}};
  return kPens[run % kPens.size()];
}

Pen SensedPenOfRun(std::size_t run) { return {Tint(PenOfRun(run).colour, 0.68), 1.5}; }

/// What the runs have in common, then what is each one's own: "seed 1 · noise paper ·
/// manipulability: simulated time 2.5 to 6.0 s · combined: ...".
std::string ComparedFacts(std::span<const std::vector<std::string>> runs,
                          std::span<const LabelledRun> labels) {
  std::vector<std::string> parts, own(runs.size());
  for (std::size_t i = 0; i < runs.front().size(); ++i) {
    const std::string& first = runs.front()[i];
    const bool common = std::ranges::all_of(runs, [&](const auto& run) { return run[i] == first; });
    if (common && !first.empty()) parts.push_back(first);
    for (std::size_t r = 0; !common && r < runs.size(); ++r)
      own[r] += (own[r].empty() ? "" : ", ") + runs[r][i];
  }
  for (std::size_t r = 0; r < runs.size(); ++r)
    if (!own[r].empty()) parts.push_back(labels[r].label + ": " + own[r]);
  return fmt::format("{}", fmt::join(parts, " · "));
}

/// Of one run, with how its gradient was estimated.
std::vector<std::string> FactsOfRun(std::span<const Frame> frames, const LabelledRun& run,
                                    const HandModel& hand) {
  std::vector<std::string> facts = FactList(frames, hand, run.object_name, run.changed);
  facts.push_back(fmt::format("estimator {}", Name(frames.back().job.explore.estimator)));
  return facts;
}

}  // namespace

void PlotQualityComparison(std::span<const LabelledRun> runs, const HandModel& hand,
                           const PlotOptions& options, const std::string& path) {
  struct Run {
    std::span<const Frame> frames;
    std::vector<double> t, phi_true, phi_sensed, stability, threshold;
  };
  std::vector<Run> curves;
  std::vector<std::vector<std::string>> facts;
  Range time_range, phi_range, stability_range;
  std::string fingers;
  for (const LabelledRun& run : runs) {
    Run c;
    c.frames = Exploration(Newest(run.frames, options.last_s, path), run.label);
    const int finger = ExploringFinger(c.frames.front());
    const double start = c.frames.front().time_s;
    c.t = Column(c.frames, [&](const Frame& frame) { return frame.time_s - start; });
    c.phi_true =
        Column(c.frames, [&](const Frame& frame) { return TrueManipulability(frame, finger); });
    c.phi_sensed =
        Column(c.frames, [&](const Frame& frame) { return SensedManipulability(frame, finger); });
    c.stability = Column(c.frames, [](const Frame& frame) { return frame.stability.active; });
    c.threshold = Column(c.frames, Threshold);
    time_range.Add(c.t);
    phi_range.Add(c.phi_true);
    phi_range.Add(c.phi_sensed);
    stability_range.Add(c.stability);
    stability_range.Add(c.threshold);
    const std::string name = FingerName(hand, finger);
    if (fingers.find(name) == std::string::npos) fingers += (fingers.empty() ? "" : ", ") + name;
    facts.push_back(FactsOfRun(c.frames, run, hand));
    curves.push_back(std::move(c));
  }
  if (curves.empty()) throw PictureRefused(path, "nothing to draw: no runs were given");

  Canvas canvas(SizeOf(options, 640), path);
  const double top =
      DrawTitle(&canvas,
                options.title.empty()
                    ? fmt::format("Exploring the object's surface with the {} finger", fingers)
                    : options.title,
                ComparedFacts(facts, runs)) +
      (canvas.narrow() ? 0 : 12);
  stability_range.Add(0);
  std::vector<LegendEntry> legend, gains;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    legend.push_back(LineEntry(runs[i].label, PenOfRun(i)));
    const auto valid = [](double v) { return v == v; };
    const auto& phi = curves[i].phi_true;
    const auto begin = std::find_if(phi.begin(), phi.end(), valid);
    const auto end = std::find_if(phi.rbegin(), phi.rend(), valid);
    if (begin == phi.end()) continue;
    const char* lost = end == phi.rbegin() ? "" : ", contact lost";
    LegendEntry gain{
        fmt::format("{:.2f} → {:.2f}{}", *begin, *end, lost), {}, PenOfRun(i).colour, true};
    if (canvas.narrow()) gain.text = runs[i].label + " " + gain.text;
    gains.push_back(std::move(gain));
  }
  const LegendEntry sensed{
      "as sensed", [n = runs.size()](Canvas* c, Point2 middle) {
        for (std::size_t i = 0; i < n; ++i) {
          const Point2 m =
              middle + Point2(0, 7 * (static_cast<double>(i) - 0.5 * static_cast<double>(n - 1)));
          c->Line(m - Point2(22, 0), m + Point2(22, 0), SensedPenOfRun(i));
        }
      }};
  const LegendEntry threshold = LineEntry("threshold", {kGrey, 2, {12, 7}});
  std::vector<LegendGroup> legends = {{"criterion, noise-free φ", legend},
                                      {"", {sensed}},
                                      {"φ held, start → end", gains},
                                      {"stability, as sensed", legend}};
  legends.back().entries.push_back(threshold);
  if (canvas.narrow()) {  // the same pens above and below: once is enough
    legends[0].entries.insert(legends[0].entries.end(), {sensed, threshold});
    legends[1].entries.clear();
    legends.pop_back();
  }
  const Layout layout(canvas, legends);
  const double left = layout.left, width = layout.width;
  const double height = (layout.bottom - top - 30) / 2;
  const Axis time =
      NiceAxis(0, time_range.hi, canvas.narrow() ? 5 : 9, false,
               canvas.narrow() ? "time exploring [s]" : "time since the exploration began [s]");
  const auto axis = [](const Range& range, const std::string& label,
                       const std::string& short_label) {
    const Range padded = range.Padded(0.04, 0.06);
    Axis result = NiceAxis(std::max(0.0, padded.lo), padded.hi, 6, true, label);
    result.short_label = short_label;
    return result;
  };
  const Panel upper{{left, top, width, height},
                    time,
                    axis(phi_range, "manipulability  φ  [10⁻⁴ m³]", "φ  [10⁻⁴ m³]")};
  const Panel lower{{left, top + height + 30, width, height},
                    time,
                    axis(stability_range, StabilityLabel(curves.front().frames),
                         StabilityShortLabel(curves.front().frames))};
  DrawGrid(&canvas, upper, false);
  DrawGrid(&canvas, lower, true);

  for (std::size_t i = 0; i < curves.size(); ++i)
    DrawCurve(&canvas, upper, curves[i].t, curves[i].phi_sensed, SensedPenOfRun(i));
  const Run& longest =
      *std::max_element(curves.begin(), curves.end(),
                        [](const Run& a, const Run& b) { return a.t.back() < b.t.back(); });
  DrawCurve(&canvas, lower, longest.t, longest.threshold, {kGrey, 2, {12, 7}});
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const Pen pen = PenOfRun(i);
    DrawCurve(&canvas, upper, curves[i].t, curves[i].phi_true, pen);
    DrawCurve(&canvas, lower, curves[i].t, curves[i].stability, pen);
  }
  DrawFrame(&canvas, upper);
  DrawFrame(&canvas, lower);

  legends[0].y = top;
  legends.back().y = std::max(legends.back().y, canvas.narrow() ? 0 : lower.area.y);
  layout.DrawLegends(&canvas, legends);
  canvas.Save();
}

void DrawComparison(const PlotInput& input, const std::string& path) {
  std::vector<LabelledRun> runs;
  for (const PlotRun& run : input.explorations)
    runs.push_back(
        {run.frames.empty() ? "" : std::string(Name(run.frames.back().job.explore.criterion)),
         run.frames, run.object_name, run.changed});
  // Numbered where the criterion does not tell them apart.
  if (std::ranges::all_of(runs, [&](const auto& r) { return r.label == runs[0].label; }))
    for (std::size_t i = 0; i < runs.size(); ++i) runs[i].label += fmt::format(" ({})", i + 1);
  PlotQualityComparison(runs, input.hand, input.options, path);
}

}  // namespace regrasp
