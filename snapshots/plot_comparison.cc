#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "snapshots/axes.h"
#include "snapshots/measures.h"
#include "snapshots/snapshots.h"
#include "snapshots/timeline.h"

namespace regrasp {
namespace {

/// The stretch that explores: from the first to the last frame in which a finger does. The whole
/// run when none does.
std::span<const Frame> Exploration(std::span<const Frame> frames) {
  const auto explores = [](const Frame& frame) { return frame.exploration.active; };
  const auto first = std::find_if(frames.begin(), frames.end(), explores);
  if (first == frames.end()) return frames;
  const auto last = std::find_if(frames.rbegin(), frames.rend(), explores).base();
  return {first, last};
}

Pen PenOfRun(std::size_t run) {
  static const std::array<Pen, 4> kPens = {Pen{kVermillion, 3.5}, Pen{kBlue, 3.5, {2, 7}},
                                           Pen{kGreen, 3.5, {16, 7}},
                                           Pen{kPurple, 3.5, {16, 6, 2, 6}}};
  return kPens[run % kPens.size()];
}

}  // namespace

void PlotQualityComparison(std::span<const LabelledRun> runs, const HandModel& hand,
                           const PlotOptions& options, const std::string& path) {
  struct Run {
    std::span<const Frame> frames;
    std::vector<double> t, phi_true, phi_sensed, stability, threshold;
  };
  std::vector<Run> curves;
  Range time_range, phi_range, stability_range;
  std::string fingers;
  for (const LabelledRun& run : runs) {
    Run c;
    c.frames = Exploration(Newest(run.frames, options.last_s, path));
    int finger = std::max(0, ExploringFinger(c.frames.front()));
    const double start = c.frames.front().time_s;
    c.t = Column(c.frames, [&](const Frame& frame) { return frame.time_s - start; });
    c.phi_true =
        Column(c.frames, [&](const Frame& frame) { return TrueManipulability(frame, finger); });
    c.phi_sensed =
        Column(c.frames, [&](const Frame& frame) { return SensedManipulability(frame, finger); });
    c.stability = Column(c.frames, [](const Frame& frame) { return frame.stability.active; });
    c.threshold = Column(c.frames, [](const Frame& frame) { return frame.stability.threshold; });
    time_range.Add(c.t);
    phi_range.Add(c.phi_true);
    phi_range.Add(c.phi_sensed);
    stability_range.Add(c.stability);
    stability_range.Add(c.threshold);
    const std::string name = FingerName(hand, finger);
    if (fingers.find(name) == std::string::npos) fingers += (fingers.empty() ? "" : ", ") + name;
    curves.push_back(std::move(c));
  }
  if (curves.empty()) throw std::runtime_error(path + ": nothing to draw: no runs were given");

  Canvas canvas(SizeOf(options), path);
  DrawTitle(&canvas,
            options.title.empty()
                ? fmt::format("Exploring the object's surface with the {} finger", fingers)
                : options.title,
            Facts(curves.front().frames, hand, options.object_name));
  stability_range.Add(0);
  const double left = 150, width = canvas.width() - left - 290, top = 116;
  const double height = (canvas.height() - 90 - top - 30) / 2;
  const Axis time = NiceAxis(0, time_range.hi, 9, false, "time since the exploration began [s]");
  const auto axis = [](const Range& range, const std::string& label) {
    const Range padded = range.Padded(0.04, 0.06);
    return NiceAxis(std::max(0.0, padded.lo), padded.hi, 6, true, label);
  };
  const Panel upper{
      {left, top, width, height}, time, axis(phi_range, "manipulability  φ  [10⁻⁴ m³]")};
  const Panel lower{{left, top + height + 30, width, height},
                    time,
                    axis(stability_range, StabilityLabel(curves.front().frames))};
  DrawGrid(&canvas, upper, false);
  DrawGrid(&canvas, lower, true);

  std::vector<LegendEntry> legend;
  std::vector<std::string> gains;
  for (std::size_t i = 0; i < curves.size(); ++i)
    DrawCurve(&canvas, upper, curves[i].t, curves[i].phi_sensed,
              {Tint(PenOfRun(i).colour, 0.68), 1.5});
  const Run& longest =
      *std::max_element(curves.begin(), curves.end(),
                        [](const Run& a, const Run& b) { return a.t.back() < b.t.back(); });
  DrawCurve(&canvas, lower, longest.t, longest.threshold, {kGrey, 2, {12, 7}});
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const Pen pen = PenOfRun(i);
    DrawCurve(&canvas, upper, curves[i].t, curves[i].phi_true, pen);
    DrawCurve(&canvas, lower, curves[i].t, curves[i].stability, pen);
    legend.push_back(LineEntry(runs[i].label, pen));
    const auto valid = [](double v) { return v == v; };
    const auto& phi = curves[i].phi_true;
    const auto begin = std::find_if(phi.begin(), phi.end(), valid);
    const auto end = std::find_if(phi.rbegin(), phi.rend(), valid);
    if (begin != phi.end()) gains.push_back(fmt::format("{:.2f} → {:.2f}", *begin, *end));
  }
  DrawFrame(&canvas, upper);
  DrawFrame(&canvas, lower);

  const double side = left + width + 28;
  double y = DrawLegend(&canvas, {side, top}, "criterion, noise-free φ", legend) + 8;
  const std::array<LegendEntry, 1> sensed = {LineEntry("as sensed", {Tint(kInk, 0.68), 1.5})};
  y = DrawLegend(&canvas, {side, y}, "", sensed) + 8;
  y = DrawLegend(&canvas, {side, y}, "φ, start → end", {});
  for (std::size_t i = 0; i < gains.size(); ++i, y += 25)
    canvas.Text({side, y + 8}, gains[i], {.size = 17, .colour = PenOfRun(i).colour, .bold = true});
  std::vector<LegendEntry> below = legend;
  below.push_back(LineEntry("threshold", {kGrey, 2, {12, 7}}));
  DrawLegend(&canvas, {side, lower.area.y}, "stability, as sensed", below);
  canvas.Save();
}

}  // namespace regrasp
