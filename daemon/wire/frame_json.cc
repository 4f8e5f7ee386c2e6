#include "daemon/wire/frame_json.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "core/gait/finger_gait.h"
#include "core/journal/event_json.h"
#include "core/quality/measures.h"
#include "core/sensing/noise.h"
#include "daemon/output/incident.h"

namespace regrasp {
namespace {

Json Vector(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }
Json KnownOrNull(double x) { return std::isnan(x) ? Json() : Json(x); }
Json Wxyz(const Quaterniond& q) { return {q.w(), q.x(), q.y(), q.z()}; }

Json FingerName(const HandModel& hand, int finger) {
  if (finger < 0 || finger >= hand.num_fingers()) return nullptr;
  return hand.fingers[static_cast<std::size_t>(finger)].name;
}

/// Writes what the record of a job of one method has besides, each field by its name.
struct ResultWriter {
  static constexpr bool kHashes = false, kLoads = false, kWrites = false;
  struct FingerIndex {};
  static FingerIndex Finger() { return {}; }

  void operator()(const char* name, int finger, FingerIndex) {
    json[name] = FingerName(hand, finger);
  }
  void operator()(const char* name, const Vector3d& v) { json[name] = Vector(v); }
  template <typename T>
  void operator()(const char* name, T value) {
    json[name] = value;
  }
  /// A word; null where it has none.
  template <typename T>
  requires(std::is_enum_v<T>) void operator()(const char* name, T value, T /*last*/) {
    json[name] = Name(value).empty() ? Json() : Json(Name(value));
  }

  Json& json;
  const HandModel& hand;
};

Json Tick(std::int64_t tick) { return tick < 0 ? Json() : Json(tick); }

/// The measure that exploration maximises now, or would: the rule of `switched` (Sec. II).
std::string_view ActiveCriterion(const Frame& frame) {
  const ExplorationFrame& exploration = frame.exploration;
  if (exploration.active) return Name(ActiveOf(exploration.criterion, exploration.on_stability));
  return Name(ActiveOf(Criterion::kSwitched, frame.stability.active < frame.stability.threshold));
}

/// The sensed contacts that hold the object, about its sensed centre.
std::vector<GraspContact> HoldingContacts(const Frame& frame) {
  std::vector<GraspContact> contacts;
  for (const FingerFrame& f : frame.fingers)
    if (f.role != FingerRole::kFree && f.in_contact)
      contacts.push_back({f.p_WC - frame.p_WO_sensed, -f.normal_W, frame.friction_counted});
  return contacts;
}

/// Their mean distance from the centre, by which torques are divided [m]; 0 where there are none.
double TorqueScale(const std::vector<GraspContact>& contacts) {
  double sum = 0;
  for (const GraspContact& contact : contacts) sum += contact.position.norm();
  return contacts.empty() ? 0 : sum / static_cast<double>(contacts.size());
}

/// Every measure of stability: what the frame has, and `on_request` what is too slow for the
/// simulation; null where it is not known.
void AddMeasures(const Frame& frame, const std::vector<GraspContact>& contacts, bool on_request,
                 Json* json) {
  MeasureInput input(contacts, TorqueScale(contacts), kMonitorEdges);
  Json names = Json::array();
  for (const MeasureInfo& info : kMeasureTable) {
    const bool here = info.cost == MeasureCost::kOnRequest;
    if (here && !on_request) continue;
    names.push_back(info.name);
    (*json)[std::string(info.name)] = contacts.empty() ? Json()
                                      : here           ? Json(info.compute(input))
                                                       : Json(frame.stability.of(info.id));
  }
  (*json)["measures"] = std::move(names);
}

}  // namespace

Json ContactsJson(const Frame& frame, const HandModel& hand, const Parameters& parameters) {
  Json fingers = Json::object();
  for (std::size_t i = 0; i < frame.fingers.size(); ++i) {
    const FingerFrame& f = frame.fingers[i];
    fingers[hand.fingers[i].name] = {{"role", Name(f.role)},
                                     {"in_contact", f.in_contact},
                                     {"p_WC_m", f.in_contact ? Vector(f.p_WC) : Json()},
                                     {"normal_W", f.in_contact ? Vector(f.normal_W) : Json()},
                                     {"force_n", f.force},
                                     {"force_command_W_n", Vector(f.f_command_W)}};
  }
  return {{"tick", frame.tick},
          {"time_s", frame.time_s},
          {"object",
           {{"p_WO_m", Vector(frame.p_WO_sensed)},
            {"q_WO_wxyz", Wxyz(frame.q_WO_sensed)},
            {"p_WO_reference_m",
             HoldsAlone(frame.state, frame.stand_in) ? Vector(frame.p_WO_reference) : Json()}}},
          {"normals", "outward"},
          {"friction", frame.friction_counted},
          {"weight_n", Vector(parameters.control.mass_estimate * parameters.gravity_W)},
          {"max_force_n", parameters.control.max_normal_force},
          {"fingers", std::move(fingers)}};
}

Json JointsJson(const Frame& frame, const HandModel& hand) {
  std::vector<int> owner(hand.joints.size(), -1);
  for (int f = 0; f < hand.num_fingers(); ++f)
    for (const int j : hand.fingers[static_cast<std::size_t>(f)].joints)
      owner[static_cast<std::size_t>(j)] = f;
  Json joints = Json::array();
  for (Eigen::Index i = 0; i < frame.q_sensed.size(); ++i) {
    const Joint& joint = hand.joints[static_cast<std::size_t>(i)];
    joints.push_back({{"name", joint.name},
                      {"finger", FingerName(hand, owner[static_cast<std::size_t>(i)])},
                      {"angle_rad", frame.q_sensed[i]},
                      {"torque_nm", frame.torque[i]},
                      {"lower_rad", joint.lower},
                      {"upper_rad", joint.upper}});
  }
  return {{"tick", frame.tick}, {"time_s", frame.time_s}, {"joints", std::move(joints)}};
}

Json QualityJson(const Frame& frame, const HandModel& hand, bool on_request) {
  const std::vector<GraspContact> holding = HoldingContacts(frame);
  const StabilityFrame& s = frame.stability;
  const auto known = [&holding](double x) { return holding.empty() ? Json() : Json(x); };
  Json fingers = Json::object();
  for (std::size_t i = 0; i < frame.fingers.size(); ++i) {
    const FingerFrame& f = frame.fingers[i];
    fingers[hand.fingers[i].name] = {{"manipulability", f.manipulability},
                                     {"load_margin_without_n", known(f.load_margin_without)},
                                     {"joint_limit_margin_rad", f.joint_limit_margin}};
  }
  Json exploration;
  if (const ExplorationFrame& e = frame.exploration; e.active)
    exploration = {{"finger", FingerName(hand, e.finger)},
                   {"criterion", Name(e.criterion)},
                   {"cycle", e.cycle},
                   {"phi", KnownOrNull(e.phi)},
                   {"gradient_norm_1_m", KnownOrNull(e.gradient_norm)},
                   {"gradient_threshold_1_m", e.epsilon}};
  Json json = {{"tick", frame.tick},
               {"time_s", frame.time_s},
               {"criterion", ActiveCriterion(frame)},
               {"stability", known(s.active)},
               {"stability_measure", InfoOf(s.measure).name},
               {"threshold", s.threshold},
               {"load_margin_n", known(s.load_margin)}};
  AddMeasures(frame, holding, on_request, &json);
  json["torque_scale_m"] = holding.empty() ? Json() : Json(TorqueScale(holding));
  json["exploration"] = std::move(exploration);
  json["fingers"] = std::move(fingers);
  return json;
}

Json TruthJson(const Frame& frame, const HandModel& hand) {
  Json contacts = Json::array();
  for (const Frame::Contact& c : frame.contacts)
    contacts.push_back(
        {{"link", c.link < 0 ? Json() : Json(hand.links[static_cast<std::size_t>(c.link)].name)},
         {"finger", FingerName(hand, c.finger)},
         {"p_WC_m", Vector(c.p_WC)},
         {"normal_W", Vector(c.normal_W)},
         {"force_W_n", Vector(c.force_W)},
         {"depth_m", c.depth}});
  Json fingers = Json::object();
  for (std::size_t i = 0; i < frame.fingers.size(); ++i) {
    const FingerFrame& f = frame.fingers[i];
    fingers[hand.fingers[i].name] = {
        {"in_contact", f.true_contact},
        {"manipulability", f.true_contact ? Json(f.true_manipulability) : Json()},
        {"p_WC_m", f.true_contact ? Vector(f.true_p_WC) : Json()},
        {"p_WF_m", Vector(f.true_tip_W)}};
  }
  return {{"tick", frame.tick},
          {"time_s", frame.time_s},
          {"object",
           {{"p_WO_m", Vector(frame.p_WO)},
            {"q_WO_wxyz", Wxyz(frame.q_WO)},
            {"v_m_s", Vector(frame.v_WO)},
            {"w_rad_s", Vector(frame.w_WO)},
            {"mass_kg", frame.mass_kg},
            {"friction", frame.friction}}},
          {"contacts", std::move(contacts)},
          {"fingers", std::move(fingers)},
          {"gravity_W_m_s2", Vector(frame.gravity_W)},
          {"stand_in", frame.stand_in}};
}

Json GaitJson(const GaitFrame& gait, const HandModel& hand) {
  return {{"active", gait.active},
          {"phase", gait.active ? Json(Name(static_cast<GaitPhase>(gait.phase))) : Json()},
          {"finger", FingerName(hand, gait.finger)},
          {"state", gait.active ? Json(gait.state) : Json()},
          {"reference_angle_rad", gait.reference_angle_rad},
          {"target_angle_rad", gait.target_angle_rad},
          {"achieved_angle_rad", gait.achieved_angle_rad},
          {"cycles", gait.cycles},
          {"regrasps", gait.regrasps}};
}

Json EventNewsJson(const Event& event, const HandModel& hand, double dt) {
  Json json = EventJson(event, hand, dt);
  if (event.kind == EventKind::kDropped || event.kind == EventKind::kFault)
    json["incident"] = IncidentName(event.tick) + ".json";
  return json;
}

Json NoiseJson(const NoiseLevels& n) {
  return {{"preset", NoiseName(n)},
          {"position_m", n.position_m},
          {"normal_rad", n.normal_rad},
          {"force_n", n.force_n},
          {"joint_rad", n.joint_rad},
          {"object_position_m", n.object_position_m},
          {"object_rotation_rad", n.object_rotation_rad},
          {"taxel_pitch_m", n.taxel_pitch_m},
          {"object_rate_hz", n.object_rate_hz},
          {"object_delay_frames", n.object_delay_frames},
          {"position_bias_m", n.position_bias_m},
          {"force_bias_n", n.force_bias_n},
          {"joint_bias_rad", n.joint_bias_rad},
          {"object_bias_m", n.object_bias_m},
          {"position_drift_m", n.position_drift_m},
          {"force_drift_n", n.force_drift_n},
          {"object_drift_m", n.object_drift_m},
          {"dropout_fraction", n.dropout},
          {"dropout_gap_s", n.dropout_gap_s},
          {"latency_s", n.latency_s}};
}

Json JobJson(const JobRecord& job, const HandModel& hand, double dt) {
  const auto seconds = [dt](std::int64_t tick) {
    return tick < 0 ? Json() : Json(TickSeconds(tick, dt));
  };
  const bool ended = job.state != JobState::kQueued && job.state != JobState::kRunning;
  Json json = {{"id", job.id},
               {"method", Name(job.method)},
               {"state", Name(job.state)},
               {"error", job.error[0] ? Json(job.error) : Json()},
               {"progress", job.progress},
               {"start_tick", Tick(job.start_tick)},
               {"end_tick", Tick(job.end_tick)},
               {"started_s", seconds(job.start_tick)},
               {"ended_s", seconds(job.end_tick)}};
  ResultWriter writer{json, hand};
  const_cast<JobRecord&>(job).ResultFields(writer);  // only reads
  // The record counts the cycles when they have ended; what it has not seen by then is 0.
  if (job.method == JobMethod::kExplore && job.explore.cycles == 0)
    for (const char* phi : {"phi_initial", "phi_final", "phi_true_initial", "phi_true_final"})
      if (ended || json[phi] == 0) json[phi] = nullptr;
  json["finished"] = ended;
  return json;
}

Json ParameterValueJson(const ParameterInfo& info, const Vector3d& value) {
  switch (info.type) {
    case ParameterType::kReal:
      return value.x();
    case ParameterType::kInteger:
      return static_cast<std::int64_t>(value.x());
    case ParameterType::kBoolean:
      return value.x() != 0;
    case ParameterType::kWord:
      return info.words[static_cast<std::size_t>(value.x())];
    case ParameterType::kVector:
      return Vector(value);
  }
  return {};
}

}  // namespace regrasp
