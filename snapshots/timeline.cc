#include "snapshots/timeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>

#include "core/sensing/noise.h"
#include "snapshots/refused.h"

namespace regrasp {
namespace {

struct EventLook {
  const char* text;
  Marker marker;
};

/// Nothing for kinds that the strips already show, and for those that come too often to mark.
std::optional<EventLook> LookOfEvent(const Event& event) {
  switch (event.kind) {
    case EventKind::kContactLost:
      return EventLook{"contact lost", Marker::kCross};
    case EventKind::kContactMade:
      return EventLook{"contact made", Marker::kPlus};
    case EventKind::kSlip:
      return EventLook{"slip", Marker::kDiamond};
    case EventKind::kDropped:
      return EventLook{"object dropped", Marker::kDown};
    case EventKind::kFault:
      return EventLook{"fault", Marker::kStar};
    case EventKind::kNoise:
      return EventLook{"noise, or its seed, changed", Marker::kSquare};
    case EventKind::kParameter:
      return EventLook{"parameter changed", Marker::kRight};
    case EventKind::kFriction:
      return EventLook{"friction felt", Marker::kRing};
    case EventKind::kPush:
      return EventLook{"push", Marker::kUp};
    case EventKind::kReset:
      return EventLook{"reset or restored", Marker::kStar};
    case EventKind::kStandIn:
      return EventLook{"stand-in lets go", Marker::kDisc};
    default:
      return std::nullopt;
  }
}

bool Within(std::span<const Frame> frames, const Event& event) {
  return event.tick >= frames.front().tick && event.tick <= frames.back().tick;
}

}  // namespace

std::span<const Frame> Newest(std::span<const Frame> history, double last_s,
                              const std::string& path) {
  if (history.empty()) throw PictureRefused(path, "nothing to draw: the history is empty");
  std::size_t start = history.size() - 1;
  while (start > 0 && history[start - 1].time_s <= history[start].time_s) --start;
  history = history.subspan(start);
  if (history.size() < 2 && history.front().tick == 0)
    throw PictureRefused(path, "nothing to draw: no time has passed since the run began");
  if (last_s <= 0) return history;
  const double from = history.back().time_s - last_s;
  const auto first = std::find_if(history.begin(), history.end(), [from](const Frame& frame) {
    return frame.time_s >= from - 1e-9;
  });
  return history.subspan(static_cast<std::size_t>(first - history.begin()));
}

/// Of a branch with another seed both: neither makes the picture again alone.
std::string SeedsOf(std::span<const Frame> frames) {
  std::string text = fmt::format("seed {}", frames.front().seed);
  for (std::size_t i = 1; i < frames.size(); ++i)
    if (frames[i].seed != frames[i - 1].seed)
      text += fmt::format(", from {:.2f} s on {}", frames[i].time_s, frames[i].seed);
  return text;
}

std::vector<std::string> FactList(std::span<const Frame> frames, const HandModel& hand,
                                  const std::string& object, const std::string& changed) {
  const Frame& last = frames.back();
  return {SeedsOf(frames),
          fmt::format("noise {}", NoiseName(last.noise)),
          "hand " + hand.name,
          fmt::format("{}({:.0f} g, µ {:.2g})", object.empty() ? "" : "object " + object + " ",
                      last.mass_kg * 1e3, last.friction),
          frames.size() == 1 ? fmt::format("simulated time {:.2f} s", last.time_s)
                             : fmt::format("simulated time {:.2f} to {:.2f} s",
                                           frames.front().time_s, last.time_s),
          changed.empty() ? "default parameters" : "changed: " + changed};
}

std::string Facts(std::span<const Frame> frames, const HandModel& hand, const std::string& object,
                  const std::string& changed) {
  std::vector<std::string> facts = FactList(frames, hand, object, changed);
  if (changed.empty()) facts.pop_back();
  return fmt::format("{}", fmt::join(facts, " · "));
}

std::string Facts(std::span<const Frame> frames, const HandModel& hand,
                  const PlotOptions& options) {
  return Facts(frames, hand, options.object_name, options.changed);
}

Axis TimeAxis(std::span<const Frame> frames, const Canvas& canvas) {
  double lo = frames.front().time_s;
  if (lo - std::floor(lo) < 0.1) lo = std::floor(lo);
  return NiceAxis(lo, frames.back().time_s, canvas.narrow() ? 5 : 9, false, "simulated time [s]");
}

std::string FingerName(const HandModel& hand, int finger) {
  if (finger >= 0 && finger < hand.num_fingers()) return hand.fingers[finger].name;
  return fmt::format("finger {}", finger);
}

std::vector<Band> Bands(std::span<const Frame> frames,
                        const std::function<int(const Frame&)>& value) {
  std::vector<Band> bands;
  for (const Frame& frame : frames) {
    const int now = value(frame);
    if (!bands.empty()) bands.back().end_s = frame.time_s;
    if (bands.empty() || bands.back().value != now)
      bands.push_back({frame.time_s, frame.time_s, now});
  }
  std::erase_if(bands, [](const Band& band) { return band.value < 0; });
  return bands;
}

void DrawStrip(Canvas* canvas, const Panel& panel, double y, double height, const std::string& name,
               std::span<const Band> bands, const std::function<BandLook(int)>& look) {
  for (const Band& band : bands) {
    const double from = panel.At(band.begin_s, 0).x, to = panel.At(band.end_s, 0).x;
    if (to <= from) continue;
    const BandLook how = look(band.value);
    canvas->FillBox({from, y, to - from, height}, how.colour);
    const double size = std::min(17.0, 0.72 * height);
    for (const std::string& label : {how.label, how.short_label})
      if (!label.empty() && canvas->TextWidth(label, size) + 8 < to - from) {
        canvas->Text({(from + to) / 2, y + height / 2}, label,
                     {.size = size, .align_x = AlignX::kCentre});
        break;
      }
    canvas->Line({from, y}, {from, y + height}, {kWhite, 1.5});
  }
  const Box all(panel.area.x, y, panel.area.width, height);
  const std::vector<Point2> corners = {
      all.tl(), {all.br().x, y}, all.br(), {all.x, y + height}, all.tl()};
  canvas->Polyline(corners, {kLightGrey, 1});
  canvas->Text({all.x - 12, y + height / 2}, name,
               {.size = 18, .colour = kGrey, .align_x = AlignX::kRight});
}

void DrawStateBackground(Canvas* canvas, const Panel& panel, std::span<const Band> states) {
  canvas->Clip(panel.area);
  for (const Band& band : states) {
    const double from = panel.At(band.begin_s, 0).x, to = panel.At(band.end_s, 0).x;
    canvas->FillBox({from, panel.area.y, to - from, panel.area.height},
                    Tint(StateColour(static_cast<SessionState>(band.value)), 0.72));
  }
  canvas->Unclip();
}

void DrawEvents(Canvas* canvas, std::span<const Panel> panels, double y,
                std::span<const Frame> frames, std::span<const Event> events) {
  const Frame& last = frames.back();
  const double dt = last.tick > 0 ? last.time_s / static_cast<double>(last.tick) : 1e-3;
  const Panel& top = panels.front();
  double previous_x = -1e9;
  for (const Event& event : events) {
    const auto look = LookOfEvent(event);
    if (!look || !Within(frames, event)) continue;
    // What happens to one finger has its colour.
    const Colour colour = event.finger >= 0 ? LookOfFinger(event.finger).colour : kInk;
    const double x = top.At(static_cast<double>(event.tick) * dt, 0).x;
    if (x - previous_x > 3)
      for (const Panel& panel : panels)
        canvas->Line({x, panel.area.y}, {x, panel.area.br().y}, {Tint(colour, 0.45), 1, {3, 5}});
    previous_x = x;
    canvas->Mark(look->marker, {x, y}, 5.5, colour);
  }
}

std::vector<LegendEntry> EventLegend(std::span<const Frame> frames, std::span<const Event> events) {
  std::map<EventKind, LegendEntry> legend;
  for (const Event& event : events)
    if (const auto look = LookOfEvent(event); look && Within(frames, event))
      legend.try_emplace(event.kind, MarkEntry(look->text, look->marker, kInk));
  std::vector<LegendEntry> entries;
  for (auto& [kind, entry] : legend) entries.push_back(std::move(entry));
  return entries;
}

}  // namespace regrasp
