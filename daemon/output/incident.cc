#include "daemon/output/incident.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace regrasp {
namespace {

using Frames = std::vector<std::shared_ptr<const Frame>>;

/// A touch of fewer frames than this (30 ms) is the object brushing past.
constexpr std::size_t kTouchFrames = 3;
constexpr std::size_t kDisturbancesTold = 5;  // in the sentence, the last ones; the record has more
constexpr std::size_t kEventsKept = 500;      // in the record, the last ones

std::string FingerName(const HandModel& hand, int finger) {
  if (finger < 0 || finger >= hand.num_fingers()) return "?";
  return hand.fingers[static_cast<std::size_t>(finger)].name;
}

const FingerFrame* FingerOf(const Frame& frame, int finger) {
  const auto i = static_cast<std::size_t>(finger);
  return i < frame.fingers.size() ? &frame.fingers[i] : nullptr;
}

bool Touches(const Frame& frame, int finger) {
  const FingerFrame* f = FingerOf(frame, finger);
  return f && f->true_contact;
}

/// Index behind the last touch of at least kTouchFrames frames; 0: it never touched.
std::size_t TouchEnd(const Frames& frames, int finger) {
  std::size_t run = 0;
  for (std::size_t i = frames.size(); i-- > 0;) {
    run = Touches(*frames[i], finger) ? run + 1 : 0;
    if (run == kTouchFrames) return i + kTouchFrames;
  }
  return 0;
}

void FindContactEnds(const HandModel& hand, Incident* incident) {
  const Frames& frames = incident->frames;
  for (int f = 0; f < hand.num_fingers(); ++f) {
    const std::size_t end = TouchEnd(frames, f);
    if (end == 0 || end == frames.size()) continue;
    const GaitFrame& gait = frames[end]->gait;
    incident->ends.push_back({f, frames[end - 1]->time_s, gait.active && gait.finger == f});
  }
  std::ranges::stable_sort(incident->ends, {}, &ContactEnd::time_s);
  const auto first = std::ranges::find(incident->ends, false, &ContactEnd::lifted);
  incident->onset_s = first == incident->ends.end() ? incident->time_s : first->time_s;
}

void FindMarginAndLifted(Incident* incident) {
  for (const auto& frame : incident->frames) {
    if (frame->time_s > incident->onset_s) break;
    incident->lifted = -1;
    if (frame->gait.active && frame->gait.finger >= 0 && !Touches(*frame, frame->gait.finger))
      incident->lifted = frame->gait.finger;
    const bool alone = HoldsAlone(frame->state, frame->stand_in);
    const double margin = frame->stability.load_margin;
    if (!alone || (incident->has_margin && margin >= incident->least_margin)) continue;
    incident->has_margin = true;
    incident->least_margin = margin;
    incident->least_margin_s = frame->time_s;
  }
}

/// Of each finger that holds and touches in the half second before the onset, but for its last
/// tenth, in which what is lost begins to slip.
void FindWeak(const HandModel& hand, Incident* incident) {
  constexpr double kWindow = 0.5, kSlips = 0.1;  // [s]
  constexpr int kFewest = 20;                    // frames (0.2 s)
  constexpr double kShare = 0.6, kLeast = 0.5;   // of what is asked for; what is asked for [N]
  for (int f = 0; f < hand.num_fingers(); ++f) {
    WeakFinger sum;
    int count = 0;
    for (const auto& frame : incident->frames) {
      const double before = incident->onset_s - frame->time_s;
      const FingerFrame* finger = FingerOf(*frame, f);
      if (before > kWindow || before < kSlips || !finger || !finger->true_contact ||
          finger->role != FingerRole::kHold)
        continue;
      sum.force += finger->true_force_W.norm();
      sum.asked += finger->f_command_W.norm();
      ++count;
    }
    if (count < kFewest || sum.asked < count * kLeast || sum.force > kShare * sum.asked) continue;
    incident->weak.push_back({f, sum.force / count, sum.asked / count});
  }
}

/// The last frame until the onset.
const Frame& OnsetFrame(const Incident& incident) {
  const auto after = std::ranges::find_if(
      incident.frames, [&](const auto& frame) { return frame->time_s > incident.onset_s; });
  return after == incident.frames.begin() ? **after : **std::prev(after);
}

std::string Situation(const Incident& incident, const HandModel& hand) {
  std::string text(Name(incident.state));
  const Frame& onset = OnsetFrame(incident);
  if (onset.state == SessionState::kExploring && onset.exploration.active)
    return text + " with " + FingerName(hand, onset.exploration.finger);
  if (incident.lifted >= 0)
    return text + fmt::format(", {} off the object to regrasp", FingerName(hand, incident.lifted));
  if (onset.gait.active && onset.gait.finger >= 0)
    return text + fmt::format(", {} regrasping", FingerName(hand, onset.gait.finger));
  return text;
}

std::string DisturbanceText(const Incident& incident) {
  std::string text;
  const std::size_t count = incident.disturbances.size();
  const std::size_t first = count > kDisturbancesTold ? count - kDisturbancesTold : 0;
  if (first > 0) text = fmt::format("{} earlier disturbances", first);
  for (std::size_t i = first; i < count; ++i) {
    const Event& event = incident.disturbances[i];
    text += fmt::format("{}{} {} {:.2f} s before", text.empty() ? "" : ", ", event.text,
                        event.kind == EventKind::kPush ? "began" : "was set",
                        incident.time_s - static_cast<double>(event.tick) * incident.dt);
  }
  if (text.empty())
    return fmt::format("no push and no change of parameters in the last {:g} s", kIncidentWindow);
  return text;
}

std::string EndsText(const Incident& incident, const HandModel& hand) {
  std::vector<std::string> first;
  for (const ContactEnd& end : incident.ends)
    if (!end.lifted && end.time_s <= incident.onset_s)
      first.push_back(FingerName(hand, end.finger));
  if (first.empty()) return "no holding finger lost its contact, the object left its place";
  return fmt::format("{} lost {} first, {:.2f} s before", fmt::join(first, " and "),
                     first.size() > 1 ? "their contacts" : "its contact",
                     incident.time_s - incident.onset_s);
}

std::string MarginText(const Incident& incident) {
  if (!incident.has_margin) return "";
  const double limit = incident.parameters.gait.margin_min;
  if (incident.least_margin < limit)
    return fmt::format(" The load margin had been down to {:.2f} N, below the limit of {:.2f} N.",
                       incident.least_margin, limit);
  return fmt::format(" The load margin had been at least {:.2f} N (limit {:.2f} N).",
                     incident.least_margin, limit);
}

std::string WeakText(const Incident& incident, const HandModel& hand) {
  std::string text;
  for (const WeakFinger& weak : incident.weak)
    text += fmt::format(" {} pressed with {:.1f} N where {:.1f} N were asked for.",
                        FingerName(hand, weak.finger), weak.force, weak.asked);
  return text;
}

std::string FrictionText(const Incident& incident) {
  const double friction = incident.frames.back()->friction;
  const double counted_on = incident.frames.back()->friction_counted;
  if (friction >= counted_on) return "";
  return fmt::format(" Friction was {:.2g}, where control counts on {:.2g}.", friction, counted_on);
}

std::string MassText(const Incident& incident) {
  constexpr double kMuch = 1.25;
  const double mass = incident.frames.back()->mass_kg;
  const double counted_on = incident.parameters.control.mass_estimate;
  if (mass <= kMuch * counted_on && counted_on <= kMuch * mass) return "";
  return fmt::format(" The object weighed {:.3g} g, where load margins count on {:.3g} g.",
                     1e3 * mass, 1e3 * counted_on);
}

std::string Cause(const Incident& incident, const HandModel& hand) {
  const bool dropped = incident.event.kind == EventKind::kDropped;
  std::string text = dropped ? "Dropped" : fmt::format("Stopped ({})", incident.event.text);
  if (incident.frames.empty()) return text + "; nothing is known of the time before.";
  text += " while " + Situation(incident, hand) + ": " + DisturbanceText(incident);
  return text + "; " + EndsText(incident, hand) + "." + MarginText(incident) +
         WeakText(incident, hand) + FrictionText(incident) + MassText(incident);
}

}  // namespace

std::string IncidentName(std::int64_t tick) { return fmt::format("incident-{}", tick); }

Incident MakeIncident(const IncidentSource& source, const HandModel& hand) {
  Incident incident;
  incident.event = source.event;
  incident.dt = source.dt;
  incident.time_s = static_cast<double>(source.event.tick) * source.dt;
  incident.parameters = source.parameters;
  incident.changed = source.changed;
  incident.changed_text = source.changed_text;
  incident.object = source.object;
  const double since = incident.time_s - kIncidentWindow - 0.5 * source.dt;
  for (const auto& frame : source.frames)
    if (frame->time_s >= since && frame->tick <= source.event.tick)
      incident.frames.push_back(frame);
  for (const Event& event : source.events) {
    const double time_s = static_cast<double>(event.tick) * source.dt;
    if (time_s < since || event.tick > source.event.tick) continue;
    incident.events.push_back(event);
    if (event.kind == EventKind::kPush || event.kind == EventKind::kParameter ||
        event.kind == EventKind::kNoise)
      incident.disturbances.push_back(event);
  }
  for (auto* kept : {&incident.events, &incident.disturbances})
    if (kept->size() > kEventsKept)
      kept->erase(kept->begin(), kept->end() - static_cast<std::ptrdiff_t>(kEventsKept));
  if (source.job.id != 0 && source.job.end_tick >= source.event.tick) incident.job = source.job;
  if (!incident.frames.empty()) incident.state = incident.frames.back()->state;
  FindContactEnds(hand, &incident);
  FindMarginAndLifted(&incident);
  FindWeak(hand, &incident);
  incident.cause = Cause(incident, hand);
  return incident;
}

}  // namespace regrasp
