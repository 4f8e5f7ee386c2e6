#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/gait/gait_table.h"
#include "snapshots/axes.h"
#include "snapshots/gait_strip.h"
#include "snapshots/measures.h"
#include "snapshots/plots.h"
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

/// The paper's name of the state in which a finger regrasps: S_T thumb, S_F first, ...
BandLook LookOfGaitState(const HandModel& hand, int value) {
  if (value == kTurning) return {"turn", Tint(kInk, 0.9)};
  const std::string state(GaitStateNameOf(hand, value).view()), which = state.substr(2);
  return {"S_{" + which + "}", Tint(LookOfFinger(value).colour, 0.42), which};
}

/// The stability that the exploring finger maximises: in S_F that of the grasp without the thumb.
/// kNoValue while it maximises something else.
double StabilityObjective(const Frame& frame) {
  const ExplorationFrame& e = frame.exploration;
  const PhiOf phi_of = InfoOf(ActiveOf(e.criterion, e.on_stability)).phi_of;
  return e.active && phi_of == PhiOf::kStability ? e.phi : kNoValue;
}

bool AnyValue(std::span<const double> values) {
  return std::any_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

/// The events without the contacts that a regrasping finger breaks and makes on purpose: the strips
/// show those. A finger's regrasp is looked for this long around its event, the spacing of frames.
constexpr double kAround = 0.25;  // [s]

std::vector<Event> Unplanned(std::span<const Frame> frames, std::span<const Event> events) {
  const double dt =
      frames.back().tick > 0 ? frames.back().time_s / static_cast<double>(frames.back().tick) : 0;
  std::vector<Event> kept;
  for (const Event& event : events) {
    const double t = static_cast<double>(event.tick) * dt;
    const auto near =
        std::lower_bound(frames.begin(), frames.end(), t - kAround,
                         [](const Frame& frame, double value) { return frame.time_s < value; });
    const bool contact =
        event.kind == EventKind::kContactLost || event.kind == EventKind::kContactMade;
    bool planned = false;
    for (auto it = near; contact && it != frames.end() && it->time_s <= t + kAround; ++it)
      planned = planned || (it->gait.active && it->gait.finger == event.finger);
    if (!planned) kept.push_back(event);
  }
  return kept;
}

Axis AxisOver(std::initializer_list<std::span<const double>> columns, bool from_zero,
              std::string label, std::string short_label = "") {
  Range range;
  if (from_zero) range.Add(0);
  for (const auto& column : columns) range.Add(column);
  constexpr double kNothing = 0.02;  // of the range: so little below 0 needs no room of its own
  if (from_zero && -range.lo < kNothing * range.hi) range.lo = 0;
  const Range padded = range.Padded(from_zero ? 0 : 0.04, 0.06);
  Axis axis = NiceAxis(padded.lo, padded.hi, 4, true, std::move(label));
  axis.short_label = std::move(short_label);
  return axis;
}

std::vector<LegendEntry> Roles() {
  const auto patch = [](const char* text, Colour colour) {
    return LegendEntry{text, [colour](Canvas* c, Point2 m) {
                         c->FillBox({m.x - 22, m.y - 9, 44, 18}, colour);
                       }};
  };
  const auto role = [](FingerRole value) {
    return LookOfActivity(0, static_cast<int>(value)).colour;
  };
  return {patch("holds", role(FingerRole::kHold)), patch("moves", role(FingerRole::kMove)),
          patch("explores", role(FingerRole::kExplore)), patch("lost its contact", kLightGrey)};
}

}  // namespace

void PlotGait(std::span<const Frame> history, std::span<const Event> events, const HandModel& hand,
              const PlotOptions& options, const std::string& path) {
  const auto frames = Newest(history, options.last_s, path);
  Canvas canvas(SizeOf(options, 1050), path);
  const std::vector<double> t = Times(frames);
  const double strips = DrawTitle(&canvas, options.title.empty() ? "Finger gait" : options.title,
                                  Facts(frames, hand, options));

  const auto angle = [&](double GaitFrame::*field) {
    return Column(frames, [field](const Frame& f) {
      return f.gait.active ? f.gait.*field * kDegrees : kNoValue;
    });
  };
  const auto target = angle(&GaitFrame::reference_angle_rad),
             achieved = angle(&GaitFrame::achieved_angle_rad);
  const auto phi =
      Column(frames, [](const Frame& f) { return TrueManipulability(f, ExploringFinger(f)); });
  const auto stability =
      Column(frames, [](const Frame& f) { return Holds(f) ? f.stability.active : kNoValue; });
  const auto threshold = Column(frames, Threshold);

  const auto objective = Column(frames, StabilityObjective);

  // Strips: state, gait (while there is one), every finger, events. Panels: what has values.
  const bool rotates = AnyValue(achieved) || AnyValue(target), explores = AnyValue(phi);
  const int n = hand.num_fingers();
  const auto own = [&](const std::vector<double>& values, int finger) {
    std::vector<double> result = values;
    for (std::size_t i = 0; i < frames.size(); ++i)
      if (ExploringFinger(frames[i]) != finger) result[i] = kNoValue;
    return result;
  };
  const std::vector<Event> unplanned = Unplanned(frames, events);
  const auto pen = [](int finger) {
    return Pen{LookOfFinger(finger).colour, 3.5, LookOfFinger(finger).dash};
  };
  std::vector<LegendEntry> explorers, rotation;
  std::vector<LegendEntry> holding = {LineEntry("holding fingers", {kInk, 2.5}),
                                      LineEntry("threshold", {kGrey, 2, {12, 7}})};
  for (int f = 0; f < n; ++f) {
    if (explores && AnyValue(own(phi, f)))
      explorers.push_back(LineEntry(FingerName(hand, f), pen(f)));
    if (AnyValue(own(objective, f)))
      holding.push_back(LineEntry(
          rotates ? "objective in " + LookOfGaitState(hand, f).label : "objective", pen(f)));
  }
  if (rotates) {
    const auto last =
        std::find_if(frames.rbegin(), frames.rend(), [](const Frame& f) { return f.gait.active; });
    rotation = {
        LineEntry("achieved", {kInk, 3}),
        LineEntry("reference", {kGrey, 2, {10, 6}}),
        {fmt::format("{} cycles, {} regrasps", last->gait.cycles, last->gait.regrasps), {}}};
  }
  std::vector<LegendGroup> legends = {{"finger", Roles()},
                                      {"events", EventLegend(frames, unplanned)},
                                      {"object angle", rotation},
                                      {"φ, noise-free", explorers},
                                      {"stability, as sensed", holding}};
  const Layout layout(canvas, legends);
  const double left = layout.left, width = layout.width, bottom = layout.bottom;
  const double strip = std::min(32.0, (canvas.narrow() ? 130.0 : 190.0) / std::max(1, n));
  const double fingers_top = strips + (rotates ? 78 : 40),
               panels_top = fingers_top + n * (strip + 6) + 48;
  const int panel_count = 1 + rotates + explores;
  const double each = (bottom - panels_top - 26 * (panel_count - 1)) / panel_count;
  const Axis time = TimeAxis(frames, canvas);
  std::vector<Panel> panels;
  const auto add = [&](Axis y) {
    panels.push_back(
        {{left, panels_top + (each + 26) * static_cast<double>(panels.size()), width, each},
         time,
         std::move(y)});
    return panels.back();
  };
  const Panel upper = rotates ? add(AxisOver({target, achieved}, true, "angle [°]")) : Panel{};
  const Panel middle = explores ? add(AxisOver({phi}, true, "φ  [10⁻⁴ m³]")) : Panel{};
  const Panel lower = add(AxisOver({stability, threshold, objective}, true, StabilityLabel(frames),
                                   StabilityShortLabel(frames)));

  const auto states =
      Bands(frames, [](const Frame& frame) { return static_cast<int>(frame.state); });
  DrawStrip(&canvas, lower, strips, 26, "state", states, [](int value) {
    const auto state = static_cast<SessionState>(value);
    return BandLook{std::string(Name(state)), StateColour(state)};
  });
  if (rotates)
    DrawStrip(&canvas, lower, strips + 36, 26, "gait", Bands(frames, GaitStateOf),
              [&](int value) { return LookOfGaitState(hand, value); });
  for (int f = 0; f < n; ++f)
    DrawStrip(&canvas, lower, fingers_top + f * (strip + 6), strip, FingerName(hand, f),
              Bands(frames, [f](const Frame& frame) { return ActivityOf(frame, f); }),
              [f](int value) { return LookOfActivity(f, value); });
  for (const Panel& panel : panels) {
    DrawStateBackground(&canvas, panel, states);
    DrawGrid(&canvas, panel, &panel == &panels.back());
  }
  DrawEvents(&canvas, panels, panels_top - 22, frames, unplanned);
  if (!legends[1].entries.empty())
    canvas.Text({left - 20, panels_top - 22}, "events",
                {.size = 18, .colour = kGrey, .align_x = AlignX::kRight});

  if (rotates) {
    DrawCurve(&canvas, upper, t, target, {kGrey, 2, {10, 6}});
    DrawCurve(&canvas, upper, t, achieved, {kInk, 3});
  }
  for (int f = 0; explores && f < n; ++f) DrawCurve(&canvas, middle, t, own(phi, f), pen(f));
  DrawCurve(&canvas, lower, t, stability, {kInk, 2.5});
  DrawCurve(&canvas, lower, t, threshold, {kGrey, 2, {12, 7}});
  for (int f = 0; f < n; ++f) DrawCurve(&canvas, lower, t, own(objective, f), pen(f));
  for (const Panel& panel : panels) DrawFrame(&canvas, panel);

  legends[0].y = fingers_top;
  legends[2].y = upper.area.y;
  legends[3].y = middle.area.y;
  legends[4].y = lower.area.y;
  layout.DrawLegends(&canvas, legends);
  canvas.Save();
}

void DrawGait(const PlotInput& input, const std::string& path) {
  PlotGait(input.frames, input.events, input.hand, input.options, path);
}

}  // namespace regrasp
