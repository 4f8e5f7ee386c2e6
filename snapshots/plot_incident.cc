#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/common/finger_letters.h"
#include "core/gait/gait_table.h"
#include "snapshots/axes.h"
#include "snapshots/gait_strip.h"
#include "snapshots/measures.h"
#include "snapshots/moment_labels.h"
#include "snapshots/plots.h"
#include "snapshots/timeline.h"

namespace regrasp {
namespace {

constexpr double kMillimetres = 1e3;
constexpr double kNarrowHeight = 1120;

/// What a finger does, for its strip.
enum class Activity { kHolds, kExplores, kMoves, kInTheAir, kNoContact };

int ActivityOf(const Frame& frame, int finger) {
  if (static_cast<std::size_t>(finger) >= frame.fingers.size()) return -1;
  const FingerFrame& f = frame.fingers[finger];
  Activity activity = Activity::kHolds;
  if (!f.true_contact)
    activity = frame.gait.active && frame.gait.finger == finger ? Activity::kInTheAir
                                                                : Activity::kNoContact;
  else if (f.role == FingerRole::kExplore)
    activity = Activity::kExplores;
  else if (f.role == FingerRole::kMove)
    activity = Activity::kMoves;
  return static_cast<int>(activity);
}

BandLook LookOfActivity(int finger, int value) {
  const Colour colour = LookOfFinger(finger).colour;
  switch (static_cast<Activity>(value)) {
    case Activity::kHolds:
      return {"holds", Tint(colour, 0.5)};
    case Activity::kExplores:
      return {"explores", Tint(colour, 0.1)};
    case Activity::kMoves:
      return {"moves", Tint(colour, 0.3)};
    case Activity::kInTheAir:
      return {"in the air", Tint(colour, 0.86)};
    case Activity::kNoContact:
      return {"no contact", kWhite};
  }
  return {"", kWhite};
}

std::string LetterOf(const HandModel& hand, int finger) {
  std::vector<std::string> names;
  for (const Finger& of : hand.fingers) names.push_back(of.name);
  return {FingerLetters(names)[static_cast<std::size_t>(finger)]};
}

/// Lines of at most `room` wide.
std::vector<std::string> Wrapped(const Canvas& canvas, const std::string& text, double size,
                                 bool bold, double room) {
  std::vector<std::string> lines(1);
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    std::string& line = lines.back();
    if (!line.empty() && canvas.TextWidth(line + " " + word, size, bold) > room)
      lines.push_back(word);
    else
      line += (line.empty() ? "" : " ") + word;
    begin = end + 1;
  }
  return lines;
}

/// Cause and facts at the top; returns the y below them.
double DrawHead(Canvas* canvas, const std::string& title, const std::string& facts) {
  const bool narrow = canvas->narrow();
  if (!canvas->with_title()) return narrow ? 14 : 34;
  const double left = narrow ? 14 : 40, room = canvas->width() - 2 * left;
  double y = narrow ? 24 : 34;
  const auto write = [&](const std::string& text, TextStyle style, double line_height) {
    for (const std::string& line : Wrapped(*canvas, text, style.size, style.bold, room)) {
      canvas->Text({left, y}, line, style);
      y += line_height;
    }
  };
  write(title, {.size = narrow ? 21.0 : 24.0, .bold = true}, narrow ? 22 : 32);
  write(facts, {.size = 18, .colour = kGrey}, narrow ? 19 : 26);
  return y;
}

std::vector<Moment> Moments(std::span<const Event> events, const IncidentNote& note,
                            const HandModel& hand, double dt) {
  std::vector<Moment> moments;
  for (const Event& event : events) {
    switch (event.kind) {
      case EventKind::kPush:
      case EventKind::kParameter:
      case EventKind::kNoise:
      case EventKind::kSlip:
      case EventKind::kStandIn:
        moments.push_back({static_cast<double>(event.tick) * dt - note.time_s, event.text, kInk});
        break;
      default:
        break;
    }
  }
  const auto first = std::ranges::find(note.ends, false, &IncidentNote::ContactEnd::lifted);
  std::string names;
  for (auto end = first; end != note.ends.end() && end->time_s == first->time_s; ++end)
    if (!end->lifted) names += (names.empty() ? "" : " and ") + FingerName(hand, end->finger);
  if (!names.empty())
    moments.push_back(
        {first->time_s - note.time_s, names + " lost contact", LookOfFinger(first->finger).colour});
  std::ranges::stable_sort(moments, {}, &Moment::before_s);
  return moments;
}

/// The letter in a disc of the finger's colour.
void DrawLetter(Canvas* canvas, Point2 at, const HandModel& hand, int finger) {
  canvas->Disc(at, 12, kWhite);
  canvas->Disc(at, 10.5, LookOfFinger(finger).colour);
  canvas->Text(at, LetterOf(hand, finger),
               {.size = 15, .colour = kWhite, .align_x = AlignX::kCentre, .bold = true});
}

/// One for each panel. `limit`: of the lines that must not be crossed; `events`: some are shown.
std::array<LegendGroup, 3> Legends(const IncidentNote& note, const HandModel& hand,
                                   const Pen& limit, bool events) {
  std::vector<LegendEntry> fingers;
  for (int f = 0; f < hand.num_fingers(); ++f)
    fingers.push_back({FingerName(hand, f), [&hand, f](Canvas* c, Point2 m) {
                         c->Line(m - Point2(22, 0), m + Point2(22, 0), {LookOfFinger(f).colour, 3});
                         DrawLetter(c, m, hand, f);
                       }});
  if (!note.ends.empty()) fingers.push_back(MarkEntry("last contact", Marker::kCross, kInk));
  if (events) fingers.push_back(LineEntry("event, see above", kMomentPen));
  return {
      LegendGroup{"normal force, true", std::move(fingers)},
      LegendGroup{"load margin ρ, sensed",
                  {LineEntry("of the grasp", {kInk, 3}),
                   LineEntry(fmt::format("limit {:.2g} N", note.margin_limit), limit)}},
      LegendGroup{"object, true",
                  {LineEntry("off its place", {kInk, 3}),
                   LineEntry(fmt::format("dropped: {:.2g} mm", note.drop_distance * kMillimetres),
                             limit)}}};
}

}  // namespace

void PlotIncident(std::span<const Frame> history, std::span<const Event> events,
                  const IncidentNote& note, const HandModel& hand, const PlotOptions& options,
                  const std::string& path) {
  const auto frames = Newest(history, options.last_s, path);
  Canvas canvas(SizeOf(options, kNarrowHeight), path);
  const int n = hand.num_fingers();
  const Pen limit{kVermillion, 2, {12, 7}};
  const auto before = Column(frames, [&](const Frame& f) { return f.time_s - note.time_s; });
  std::vector<Moment> moments =
      Moments(events, note, hand, note.time_s / std::max(1.0, static_cast<double>(note.tick)));
  std::erase_if(moments, [&](const Moment& m) { return m.before_s < before.front(); });
  std::array<LegendGroup, 3> legends = Legends(note, hand, limit, !moments.empty());
  const Layout layout(canvas, legends);
  const double left = layout.left, width = layout.width, bottom = layout.bottom;
  const double y = DrawHead(&canvas, options.title.empty() ? note.cause : options.title,
                            fmt::format("tick {} · {}", note.tick, Facts(frames, hand, options)));

  // Strips: state, gait (while there is one), every finger. Then the labels, then the panels.
  const bool gait = std::ranges::any_of(frames, [](const Frame& f) { return f.gait.active; });
  const double strip = std::min(24.0, 150.0 / std::max(1, n)), strips = y;
  const double fingers_top = strips + (gait ? 64 : 34);
  const double labels = fingers_top + n * (strip + 4) + 16;
  const Axis time =
      NiceAxis(before.front(), 0, canvas.narrow() ? 5 : 9, false, "time before the drop [s]");
  const auto placed = PlaceLabels(canvas, Panel{{left, 0, width, 1}, time, {}}, moments);
  if (std::ranges::any_of(placed, [](const MomentLabel& label) { return label.row < 0; }))
    legends[0].entries.back().text = "event, most are above";
  const double panels_top = labels + kLabelRow * std::max(1, RowsOf(placed)) - 6;
  const double room = bottom - panels_top - 2 * 22;

  std::vector<std::vector<double>> forces;
  Range force_range;
  force_range.Add(0);
  for (int f = 0; f < n; ++f) {
    forces.push_back(Column(frames, [f](const Frame& frame) {
      if (static_cast<std::size_t>(f) >= frame.fingers.size()) return kNoValue;
      const FingerFrame& finger = frame.fingers[f];
      return finger.true_contact ? -finger.true_force_W.dot(finger.true_normal_W) : 0.0;
    }));
    force_range.Add(forces.back());
  }
  const auto margin =
      Column(frames, [](const Frame& f) { return Holds(f) ? f.stability.load_margin : kNoValue; });
  // Before the fingers hold it the object has no place.
  const auto error = Column(frames, [](const Frame& f) {
    return Holds(f) ? (f.p_WO - f.p_WO_reference).norm() * kMillimetres : kNoValue;
  });
  Range margin_range, error_range;
  margin_range.Add(0);
  margin_range.Add(1.5 * note.margin_limit);
  margin_range.Add(margin);
  error_range.Add(0);
  error_range.Add(error);
  const auto axis = [](const Range& range, int ticks, std::string label) {
    const Range padded = range.Padded(0, 0.06);
    return NiceAxis(padded.lo, padded.hi, ticks, true, std::move(label));
  };
  const std::array<Panel, 3> panels = {
      Panel{{left, panels_top, width, 0.44 * room}, time, axis(force_range, 4, "force [N]")},
      Panel{{left, panels_top + 0.44 * room + 22, width, 0.28 * room},
            time,
            axis(margin_range, 3, "ρ [N]")},
      Panel{{left, bottom - 0.28 * room, width, 0.28 * room},
            time,
            axis(error_range, 3, "error [mm]")}};

  const auto bands = [&](const std::function<int(const Frame&)>& value) {
    std::vector<Band> shifted = Bands(frames, value);
    for (Band& band : shifted) {
      // What lasted until the last frame lasted until the drop.
      band.end_s = band.end_s >= frames.back().time_s ? 0 : band.end_s - note.time_s;
      band.begin_s -= note.time_s;
    }
    return shifted;
  };
  const auto states = bands([](const Frame& frame) { return static_cast<int>(frame.state); });
  DrawStrip(&canvas, panels[0], strips, 24, "state", states, [](int value) {
    const auto state = static_cast<SessionState>(value);
    return BandLook{std::string(Name(state)), StateColour(state)};
  });
  if (gait)
    DrawStrip(&canvas, panels[0], strips + 30, 24, "gait", bands(GaitStateOf), [&](int value) {
      if (value == kTurning) return BandLook{"all hold", Tint(kInk, 0.9)};
      const std::string row(GaitStateNameOf(hand, value).view());
      return BandLook{FingerName(hand, value) + " regrasps", Tint(LookOfFinger(value).colour, 0.42),
                      "S_{" + row.substr(2) + "}"};
    });
  for (int f = 0; f < n; ++f)
    DrawStrip(&canvas, panels[0], fingers_top + f * (strip + 4), strip, FingerName(hand, f),
              bands([f](const Frame& frame) { return ActivityOf(frame, f); }),
              [f](int value) { return LookOfActivity(f, value); });

  for (const Panel& panel : panels) {
    DrawStateBackground(&canvas, panel, states);
    DrawGrid(&canvas, panel, &panel == &panels.back());
  }
  const double limit_y = panels[1].At(0, note.margin_limit).y;
  canvas.FillBox({left, limit_y, width, panels[1].area.br().y - limit_y}, Tint(kVermillion, 0.72));
  DrawMoments(&canvas, panels, labels, moments, placed);

  for (int f = 0; f < n; ++f)
    DrawCurve(&canvas, panels[0], before, forces[f], {LookOfFinger(f).colour, 3});
  canvas.Line({left, limit_y}, {left + width, limit_y}, limit);
  const double lost_y = panels[2].At(0, note.drop_distance * kMillimetres).y;
  if (lost_y > panels[2].area.y) canvas.Line({left, lost_y}, {left + width, lost_y}, limit);
  DrawCurve(&canvas, panels[1], before, margin, {kInk, 3});
  DrawCurve(&canvas, panels[2], before, error, {kInk, 3});
  for (int f = 0; f < n && !before.empty(); ++f) {
    // Along the curves, so that they are told apart without colour.
    for (const double share : {0.02, 0.35, 0.68}) {
      const auto i =
          static_cast<std::size_t>((share + 0.05 * f) * static_cast<double>(before.size() - 1));
      if (i < before.size() && std::isfinite(forces[f][i]))
        DrawLetter(&canvas, panels[0].At(before[i], forces[f][i]), hand, f);
    }
  }
  for (const IncidentNote::ContactEnd& end : note.ends) {
    const double t = end.time_s - note.time_s;
    if (t < time.lo) continue;
    canvas.Mark(Marker::kCross, panels[0].At(t, 0), 9, LookOfFinger(end.finger).colour);
  }
  for (const Panel& panel : panels) DrawFrame(&canvas, panel);

  for (std::size_t i = 0; i < panels.size(); ++i) legends[i].y = panels[i].area.y;
  layout.DrawLegends(&canvas, legends);
  canvas.Save();
}

void DrawIncident(const PlotInput& input, const std::string& path) {
  PlotIncident(input.frames, input.events, input.incident, input.hand, input.options, path);
}

}  // namespace regrasp
