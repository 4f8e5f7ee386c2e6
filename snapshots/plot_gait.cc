#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "snapshots/axes.h"
#include "snapshots/measures.h"
#include "snapshots/snapshots.h"
#include "snapshots/timeline.h"

namespace regrasp {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

/// What a finger does, for its strip: its role, or touching against its role's expectation.
constexpr int kHoldWithoutContact = 10;

int ActivityOf(const Frame& frame, int finger) {
  if (static_cast<std::size_t>(finger) >= frame.fingers.size()) return -1;
  const FingerFrame& f = frame.fingers[finger];
  if (f.role == FingerRole::kFree) return -1;
  if (f.role == FingerRole::kHold && !f.in_contact) return kHoldWithoutContact;
  return static_cast<int>(f.role);
}

BandLook LookOfActivity(int finger, int value) {
  const Colour colour = LookOfFinger(finger).colour;
  if (value == kHoldWithoutContact) return {"no contact", kLightGrey};
  switch (static_cast<FingerRole>(value)) {
    case FingerRole::kHold:
      return {"hold", Tint(colour, 0.72)};
    case FingerRole::kExplore:
      return {"explore", Tint(colour, 0.1)};
    case FingerRole::kMove:
      return {"move", Tint(colour, 0.42)};
    case FingerRole::kFree:
      break;
  }
  return {"", kWhite};
}

}  // namespace

void PlotGait(std::span<const Frame> history, std::span<const Event> events, const HandModel& hand,
              const PlotOptions& options, const std::string& path) {
  const auto frames = Newest(history, options.last_s, path);
  Canvas canvas(options.width, options.height, path);
  const std::vector<double> t = Times(frames);
  DrawTitle(&canvas, options.title.empty() ? "Finger gait" : options.title,
            Facts(frames, hand, options.object_name));

  const double left = 150, width = canvas.width() - left - 290, bottom = canvas.height() - 90;
  const Axis time = NiceAxis(t.front(), t.back(), 9, false, "simulated time [s]");
  const int n = std::max(1, hand.num_fingers());
  const double strip = std::min(32.0, 190.0 / n), strips = 104, first = strips + 40;
  const double panels_top = first + n * (strip + 6) + 44, room = bottom - panels_top - 2 * 26;

  const auto angle = [](const Frame& frame, double GaitFrame::*field) {
    return frame.gait.active ? frame.gait.*field * kDegrees : kNoValue;
  };
  const auto target =
      Column(frames, [&](const Frame& f) { return angle(f, &GaitFrame::target_angle_rad); });
  const auto achieved =
      Column(frames, [&](const Frame& f) { return angle(f, &GaitFrame::achieved_angle_rad); });
  const auto phi =
      Column(frames, [](const Frame& f) { return TrueManipulability(f, ExploringFinger(f)); });
  const auto stability =
      Column(frames, [](const Frame& f) { return Holds(f) ? f.stability.active : kNoValue; });
  const auto threshold = Column(frames, [](const Frame& f) { return f.stability.threshold; });
  Range angles, phis, stabilities;
  angles.Add(target);
  angles.Add(achieved);
  phis.Add(0);
  phis.Add(phi);
  stabilities.Add(0);
  stabilities.Add(stability);
  stabilities.Add(threshold);
  if (angles.empty()) angles.Add(0), angles.Add(1);
  if (phis.hi == 0) phis.Add(1);
  const auto axis = [](const Range& range, const std::string& label) {
    const Range padded = range.Padded(0, 0.06);
    return NiceAxis(padded.lo, padded.hi, 4, true, label);
  };
  const double each = room / 3;
  const Panel upper{{left, panels_top, width, each}, time, axis(angles, "object angle [°]")};
  const Panel middle{{left, panels_top + each + 26, width, each}, time, axis(phis, "φ  [10⁻⁴ m³]")};
  const Panel lower{{left, panels_top + 2 * each + 52, width, each},
                    time,
                    axis(stabilities, StabilityLabel(frames).substr(0, 9))};
  const std::array<Panel, 3> panels = {upper, middle, lower};

  const auto states =
      Bands(frames, [](const Frame& frame) { return static_cast<int>(frame.state); });
  DrawStrip(&canvas, upper, strips, 26, "state", states, [](int value) {
    const auto state = static_cast<SessionState>(value);
    return BandLook{std::string(Name(state)), StateColour(state)};
  });
  for (int f = 0; f < hand.num_fingers(); ++f)
    DrawStrip(&canvas, upper, first + f * (strip + 6), strip, FingerName(hand, f),
              Bands(frames, [f](const Frame& frame) { return ActivityOf(frame, f); }),
              [f](int value) { return LookOfActivity(f, value); });
  for (const Panel& panel : panels) {
    DrawStateBackground(&canvas, panel, states);
    DrawGrid(&canvas, panel, &panel == &panels.back());
  }
  const auto marks = DrawEvents(&canvas, panels, panels_top - 20, frames, events);
  canvas.Text({left - 12, panels_top - 20}, "events",
              {.size = 18, .colour = kGrey, .align_x = AlignX::kRight});

  DrawCurve(&canvas, upper, t, target, {kGrey, 2, {10, 6}});
  DrawCurve(&canvas, upper, t, achieved, {kInk, 3});
  std::vector<LegendEntry> explorers;
  for (int f = 0; f < hand.num_fingers(); ++f) {
    std::vector<double> own = phi;
    for (std::size_t i = 0; i < frames.size(); ++i)
      if (ExploringFinger(frames[i]) != f) own[i] = kNoValue;
    const Pen pen{LookOfFinger(f).colour, 3.5};
    DrawCurve(&canvas, middle, t, own, pen);
    if (std::any_of(own.begin(), own.end(), [](double v) { return v == v; }))
      explorers.push_back(LineEntry(FingerName(hand, f), pen));
  }
  DrawCurve(&canvas, lower, t, stability, {kInk, 2.5});
  DrawCurve(&canvas, lower, t, threshold, {kVermillion, 2, {12, 7}});
  for (const Panel& panel : panels) DrawFrame(&canvas, panel);
  const auto note = [&](const Panel& panel, const std::vector<double>& values, const char* text) {
    if (std::any_of(values.begin(), values.end(), [](double v) { return v == v; })) return;
    canvas.Text({panel.area.x + width / 2, panel.area.y + each / 2}, text,
                {.size = 20, .colour = kGrey, .align_x = AlignX::kCentre});
  };
  note(upper, achieved, "no rotation in this stretch of time");
  note(middle, phi, "no exploration in this stretch of time");

  const double side = left + width + 28;
  const auto role = [](const char* text, FingerRole value) {
    return LegendEntry{text, [value](Canvas* c, Point2 middle_point) {
                         Colour colour = LookOfActivity(0, static_cast<int>(value)).colour;
                         c->FillBox({middle_point.x - 22, middle_point.y - 9, 44, 18}, colour);
                       }};
  };
  const std::array<LegendEntry, 4> roles = {
      role("holds", FingerRole::kHold), role("moves", FingerRole::kMove),
      role("explores", FingerRole::kExplore),
      LegendEntry{"lost its contact", [](Canvas* c, Point2 m) {
                    c->FillBox({m.x - 22, m.y - 9, 44, 18}, kLightGrey);
                  }}};
  double y = DrawLegend(&canvas, {side, first}, "finger", roles) + 8;
  if (!marks.empty()) y = DrawLegend(&canvas, {side, y}, "events", marks) + 8;
  const std::array<LegendEntry, 2> rotation = {LineEntry("achieved", {kInk, 3}),
                                               LineEntry("reference", {kGrey, 2, {10, 6}})};
  y = std::max(y, upper.area.y);
  y = DrawLegend(&canvas, {side, y}, "object angle", rotation);
  const GaitFrame& gait = frames.back().gait;
  if (gait.active) {
    canvas.Text({side, y + 12}, fmt::format("{} cycles, {} regrasps", gait.cycles, gait.regrasps),
                {.size = 18});
    y += 30;
  }
  if (!explorers.empty())
    y = DrawLegend(&canvas, {side, std::max(y + 8, middle.area.y)}, "φ, noise-free", explorers);
  const std::array<LegendEntry, 2> holding = {LineEntry("holding fingers", {kInk, 2.5}),
                                              LineEntry("threshold", {kVermillion, 2, {12, 7}})};
  DrawLegend(&canvas, {side, std::max(y + 8, lower.area.y)}, "stability, as sensed", holding);
  canvas.Save();
}

}  // namespace regrasp
