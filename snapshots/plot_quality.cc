#include <fmt/format.h>

#include <array>
#include <cmath>

#include "snapshots/axes.h"
#include "snapshots/measures.h"
#include "snapshots/plots.h"
#include "snapshots/timeline.h"

namespace regrasp {
namespace {

// Values of the criterion strip.
constexpr int kOnStability = 100;

/// Finger and objective that are active, as one number; -1 while nothing explores.
int ActiveObjective(const Frame& frame) {
  const ExplorationFrame& e = frame.exploration;
  if (!e.active) return -1;
  return static_cast<int>(e.criterion) * 1000 + (e.on_stability ? kOnStability : 0) + e.finger;
}

std::string CriterionText(Criterion criterion, bool on_stability) {
  const Criterion active = ActiveOf(criterion, on_stability);
  return fmt::format("{}{}{}", Name(criterion), active == criterion ? "" : ": ",
                     active == criterion ? "" : Name(active));
}

/// How pale a band of this criterion is.
double PaleOf(PhiOf phi_of) {
  switch (phi_of) {
    case PhiOf::kStability:
      return 0.25;
    case PhiOf::kEither:
    case PhiOf::kManipulability:
      return 0.6;
    case PhiOf::kBoth:
      return 0.42;
    case PhiOf::kOther:
      return 0.78;
  }
  return 0;
}

BandLook LookOfObjective(const HandModel& hand, int value) {
  const int finger = value % kOnStability;
  const bool on_stability = value % 1000 >= kOnStability;
  const auto criterion = static_cast<Criterion>(value / 1000);
  const PhiOf phi_of = InfoOf(ActiveOf(criterion, on_stability)).phi_of;
  return {FingerName(hand, finger) + ", " + CriterionText(criterion, on_stability),
          Tint(LookOfFinger(finger).colour, PaleOf(phi_of)), FingerName(hand, finger)};
}

/// "  1.21 → 1.87": noise-free manipulability over the finger's last exploration, and whether it
/// ended without a contact; empty without one.
std::string Gain(std::span<const Frame> frames, int finger) {
  double first = kNoValue, last = kNoValue;
  bool exploring = false, lost = false;
  for (const Frame& frame : frames) {
    const bool now = ExploringFinger(frame) == finger;
    if (now && !exploring) first = last = kNoValue;
    if (now) {
      const double phi = TrueManipulability(frame, finger);
      lost = !std::isfinite(phi);
      if (!lost) last = phi;
      if (!std::isfinite(first)) first = phi;
    }
    exploring = now;
  }
  return std::isfinite(last) ? fmt::format("  {:.2f} → {:.2f}{}", first, last, lost ? ", lost" : "")
                             : "";
}

// Places of legends.
constexpr std::size_t kStabilityGroup = 2, kLoadGroup = 4;

std::vector<LegendGroup> Legends(std::span<const Frame> frames, std::span<const Event> events,
                                 const HandModel& hand) {
  std::vector<LegendEntry> fingers, kinds;
  bool explores = false;
  for (int f = 0; f < hand.num_fingers(); ++f) {
    const FingerLook look = LookOfFinger(f);
    const std::string gain = Gain(frames, f);
    explores = explores || !gain.empty();
    fingers.push_back(LineEntry(FingerName(hand, f) + gain, {look.colour, 2, look.dash}));
  }
  if (explores)
    kinds = {LineEntry("while it explores", {kInk, 4}),
             LineEntry("as sensed", {Tint(kInk, 0.62), 1.5})};
  return {
      {explores ? "φ, last exploration" : "finger, noise-free", fingers},
      {"", kinds},
      {"stability, as sensed",
       {LineEntry("holding fingers", {kInk, 2.5}), LineEntry("threshold", {kGrey, 2, {12, 7}})}},
      {"events", EventLegend(frames, events)},
      {"load margin", {LineEntry("all in contact", {kInk, 2.5})}}};
}

void Draw(Canvas* canvas, std::span<const Frame> frames, std::span<const Event> events,
          const HandModel& hand, const PlotOptions& options) {
  const std::vector<double> t = Times(frames);
  const double strips = DrawTitle(
      canvas, options.title.empty() ? "Manipulability and grasp stability" : options.title,
      Facts(frames, hand, options));
  const Axis time = TimeAxis(frames, *canvas);

  Range phi_range;
  phi_range.Add(0);
  std::vector<std::vector<double>> phi_true, phi_sensed;
  for (int f = 0; f < hand.num_fingers(); ++f) {
    phi_true.push_back(
        Column(frames, [f](const Frame& frame) { return TrueManipulability(frame, f); }));
    phi_sensed.push_back(Column(frames, [f](const Frame& frame) {
      return ExploringFinger(frame) == f ? SensedManipulability(frame, f) : kNoValue;
    }));
    phi_range.Add(phi_true.back());
    phi_range.Add(phi_sensed.back());
  }
  const auto stability = Column(
      frames, [](const Frame& frame) { return Holds(frame) ? frame.stability.active : kNoValue; });
  const auto threshold = Column(frames, Threshold);
  const auto margin = Column(frames, [](const Frame& frame) {
    return Holds(frame) ? frame.stability.load_margin : kNoValue;
  });
  Range stability_range, margin_range;
  stability_range.Add(0);
  stability_range.Add(stability);
  stability_range.Add(threshold);
  margin_range.Add(0);
  margin_range.Add(margin);
  const auto axis = [](const Range& range, int ticks, const std::string& label,
                       const std::string& short_label) {
    const Range padded = range.Padded(0, 0.06);
    Axis result = NiceAxis(padded.lo, padded.hi, ticks, true, label);
    result.short_label = short_label;
    return result;
  };
  std::vector<LegendGroup> legends = Legends(frames, events, hand);
  const Layout layout(*canvas, legends);
  const double left = layout.left, width = layout.width;
  const double first = strips + 100, room = layout.bottom - first - 2 * 26;
  const Panel upper{{left, first, width, 0.47 * room},
                    time,
                    axis(phi_range, 6, "manipulability  φ  [10⁻⁴ m³]", "φ  [10⁻⁴ m³]")};
  const Panel middle{{left, upper.area.br().y + 26, width, 0.32 * room},
                     time,
                     axis(stability_range, 5, StabilityLabel(frames), StabilityShortLabel(frames))};
  const Panel lower{{left, middle.area.br().y + 26, width, 0.21 * room},
                    time,
                    axis(margin_range, 3, "margin  ρ  [N]", "ρ  [N]")};
  const std::array<Panel, 3> panels = {upper, middle, lower};

  const auto states =
      Bands(frames, [](const Frame& frame) { return static_cast<int>(frame.state); });
  DrawStrip(canvas, upper, strips, 26, "state", states, [](int value) {
    const auto state = static_cast<SessionState>(value);
    return BandLook{std::string(Name(state)), StateColour(state)};
  });
  DrawStrip(canvas, upper, strips + 32, 26, "objective", Bands(frames, ActiveObjective),
            [&](int value) { return LookOfObjective(hand, value); });
  for (const Panel& panel : panels) {
    DrawStateBackground(canvas, panel, states);
    DrawGrid(canvas, panel, &panel == &panels.back());
  }
  DrawEvents(canvas, panels, strips + 78, frames, events);
  canvas->Text({left - 20, strips + 78}, "events",
               {.size = 18, .colour = kGrey, .align_x = AlignX::kRight});

  for (int f = 0; f < hand.num_fingers(); ++f) {
    const FingerLook look = LookOfFinger(f);
    DrawCurve(canvas, upper, t, phi_sensed[f], {Tint(look.colour, 0.62), 1.5});
  }
  for (int f = 0; f < hand.num_fingers(); ++f) {
    const FingerLook look = LookOfFinger(f);
    DrawCurve(canvas, upper, t, phi_true[f], {Tint(look.colour, 0.15), 1.5, look.dash});
    std::vector<double> bold = phi_true[f];
    for (std::size_t i = 0; i < frames.size(); ++i)
      if (ExploringFinger(frames[i]) != f) bold[i] = kNoValue;
    DrawCurve(canvas, upper, t, bold, {look.colour, 4, look.dash});
  }
  DrawCurve(canvas, middle, t, stability, {kInk, 2.5});
  DrawCurve(canvas, middle, t, threshold, {kGrey, 2, {12, 7}});
  DrawCurve(canvas, lower, t, margin, {kInk, 2.5});
  for (const Panel& panel : panels) DrawFrame(canvas, panel);

  legends[kStabilityGroup].y = middle.area.y;
  legends[kLoadGroup].y = lower.area.y;
  legends[0].y = upper.area.y;
  layout.DrawLegends(canvas, legends);
}

constexpr double kNarrowHeight = 800;

}  // namespace

void PlotQuality(std::span<const Frame> history, std::span<const Event> events,
                 const HandModel& hand, const PlotOptions& options, const std::string& path) {
  const auto frames = Newest(history, options.last_s, path);
  Canvas canvas(SizeOf(options, kNarrowHeight), path);
  Draw(&canvas, frames, events, hand, options);
  canvas.Save();
}

Pixels QualityPixels(std::span<const Frame> history, std::span<const Event> events,
                     const HandModel& hand, const PlotOptions& options) {
  const auto frames = Newest(history, options.last_s, "picture");
  Canvas canvas(SizeOf(options, kNarrowHeight));
  Draw(&canvas, frames, events, hand, options);
  const std::string bytes = canvas.Bytes();
  return {bytes.begin(), bytes.end()};
}

void DrawQuality(const PlotInput& input, const std::string& path) {
  PlotQuality(input.frames, input.events, input.hand, input.options, path);
}

}  // namespace regrasp
