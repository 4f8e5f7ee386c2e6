// The record of an incident as JSON, and its picture.

#include "core/files/json_text.h"
#include "core/gait/finger_gait.h"
#include "daemon/output/files.h"
#include "daemon/output/incident.h"
#include "daemon/wire/frame_json.h"
#include "snapshots/plots.h"

namespace regrasp {
namespace {

Json NameOrNull(const HandModel& hand, int finger) {
  if (finger < 0 || finger >= hand.num_fingers()) return nullptr;
  return hand.fingers[static_cast<std::size_t>(finger)].name;
}

Json FindingsJson(const Incident& incident, const HandModel& hand) {
  Json ends = Json::array();
  for (const ContactEnd& end : incident.ends)
    ends.push_back({{"finger", NameOrNull(hand, end.finger)},
                    {"time_s", end.time_s},
                    {"before_s", incident.time_s - end.time_s},
                    {"lifted", end.lifted}});
  Json margin;
  if (incident.has_margin)
    margin = {{"load_margin_n", incident.least_margin},
              {"time_s", incident.least_margin_s},
              {"before_s", incident.time_s - incident.least_margin_s}};
  Json weak = Json::array();
  for (const WeakFinger& finger : incident.weak)
    weak.push_back({{"finger", NameOrNull(hand, finger.finger)},
                    {"force_n", finger.force},
                    {"asked_n", finger.asked}});
  Json disturbances = Json::array();
  for (const Event& event : incident.disturbances)
    disturbances.push_back(EventNewsJson(event, hand, incident.dt));
  return {{"contacts_ended", std::move(ends)},
          {"least_load_margin", std::move(margin)},
          {"lifted_finger", NameOrNull(hand, incident.lifted)},
          {"weak_fingers", std::move(weak)},
          {"disturbances", std::move(disturbances)}};
}

/// One array per quantity, all of the same length.
Json SamplesJson(const Incident& incident, const HandModel& hand) {
  Json samples = {{"tick", Json::array()},
                  {"time_s", Json::array()},
                  {"state", Json::array()},
                  {"gait_phase", Json::array()},
                  {"regrasping_finger", Json::array()},
                  {"exploring_finger", Json::array()},
                  {"stability", Json::array()},
                  {"load_margin_n", Json::array()},
                  {"object_error_m", Json::array()},
                  {"friction", Json::array()}};
  Json fingers = Json::object();
  for (const auto& shared : incident.frames) {
    const Frame& frame = *shared;
    samples["tick"].push_back(frame.tick);
    samples["time_s"].push_back(frame.time_s);
    samples["state"].push_back(Name(frame.state));
    const GaitFrame& gait = frame.gait;
    samples["gait_phase"].push_back(gait.active ? Json(Name(static_cast<GaitPhase>(gait.phase)))
                                                : Json());
    samples["regrasping_finger"].push_back(NameOrNull(hand, gait.active ? gait.finger : -1));
    samples["exploring_finger"].push_back(
        NameOrNull(hand, frame.exploration.active ? frame.exploration.finger : -1));
    samples["stability"].push_back(frame.stability.active);
    samples["load_margin_n"].push_back(frame.stability.load_margin);
    samples["object_error_m"].push_back(HoldsAlone(frame.state, frame.stand_in)
                                            ? Json((frame.p_WO - frame.p_WO_reference).norm())
                                            : Json());
    samples["friction"].push_back(frame.friction);
    for (std::size_t i = 0; i < frame.fingers.size(); ++i) {
      const FingerFrame& f = frame.fingers[i];
      Json& finger = fingers[hand.fingers[i].name];
      finger["role"].push_back(Name(f.role));
      finger["in_contact"].push_back(f.in_contact);
      finger["force_n"].push_back(f.force);
      finger["true_contact"].push_back(f.true_contact);
      finger["true_force_n"].push_back(-f.true_force_W.dot(f.true_normal_W));
      finger["true_force_norm_n"].push_back(f.true_force_W.norm());
      finger["asked_n"].push_back(f.f_command_W.norm());
      finger["load_margin_without_n"].push_back(f.load_margin_without);
      finger["manipulability"].push_back(f.manipulability);
      finger["joint_limit_margin_rad"].push_back(f.joint_limit_margin);
    }
  }
  samples["fingers"] = std::move(fingers);
  return samples;
}

}  // namespace

Json IncidentJson(const Incident& incident, const HandModel& hand) {
  Json events = Json::array();
  for (const Event& event : incident.events)
    events.push_back(EventNewsJson(event, hand, incident.dt));
  const Frame* last = incident.frames.empty() ? nullptr : incident.frames.back().get();
  return {{"schema", 1},
          {"kind", Name(incident.event.kind)},
          {"tick", incident.event.tick},
          {"time_s", incident.time_s},
          {"cause", incident.cause},
          {"text", incident.event.text},
          {"state_before", last ? Json(Name(incident.state)) : Json()},
          {"seed", last ? Json(last->seed) : Json()},
          {"hand", hand.name},
          {"object", incident.object},
          {"mass_kg", last ? Json(last->mass_kg) : Json()},
          {"friction", last ? Json(last->friction) : Json()},
          {"noise", last ? NoiseJson(last->noise) : Json()},
          {"changed_parameters", incident.changed},
          {"limits",
           {{"drop_distance_m", incident.parameters.control.drop_distance},
            {"load_margin_n", incident.parameters.gait.margin_min},
            {"friction_estimate", last ? Json(last->friction_counted) : Json()}}},
          {"findings", FindingsJson(incident, hand)},
          {"job", incident.job.id != 0 ? JobJson(incident.job, hand, incident.dt) : Json()},
          {"events", std::move(events)},
          {"samples", SamplesJson(incident, hand)}};
}

std::string IncidentText(const Incident& incident, const HandModel& hand) {
  return JsonText(IncidentJson(incident, hand)) + "\n";
}

void PruneIncidents(const std::filesystem::path& directory, std::size_t keep) {
  std::vector<std::filesystem::path> records = FilesIn(directory, {".json"});
  std::erase_if(records, [](const std::filesystem::path& file) {
    return !file.filename().string().starts_with("incident-");
  });
  RemoveOldest(records, keep, [](std::filesystem::path record) {
    std::error_code ignored;
    std::filesystem::remove(record.replace_extension(".png"), ignored);
  });
}

PlotInput PictureOf(const Incident& incident, const HandModel& hand) {
  PlotInput input;
  for (const auto& frame : incident.frames) input.frames.push_back(*frame);
  input.events = incident.events;
  input.hand = hand;
  input.options.object_name = incident.object;
  input.options.changed = incident.changed_text;
  IncidentNote& note = input.incident;
  note.tick = incident.event.tick;
  note.time_s = incident.time_s;
  note.cause = incident.cause;
  note.margin_limit = incident.parameters.gait.margin_min;
  note.drop_distance = incident.parameters.control.drop_distance;
  for (const ContactEnd& end : incident.ends)
    note.ends.push_back({end.finger, end.time_s, end.lifted});
  return input;
}

}  // namespace regrasp
