#include "daemon/output/run_messages.h"

#include <cmath>
#include <vector>

#include "core/gait/finger_gait.h"
#include "core/journal/journal.h"
#include "daemon/wire/frame_json.h"

namespace regrasp {
namespace {

struct Field {
  const char* name;
  const char* type;  ///< of JSON
  const char* meaning;
};

constexpr Field kSegment = {"segment", "integer", "counts resets and restores within the file"};
constexpr Field kTick = {"tick", "integer", "number of steps since the reset"};
constexpr Field kTime = {"t_s", "number", "tick times dt [s]"};

std::vector<Field> Fields(RunTopic topic) {
  switch (topic) {
    case RunTopic::kRun:
      return {kSegment,
              {"format", "string", "regrasp-run/1"},
              {"build", "string", "version, commit, compiler, flags"},
              {"seed", "integer", "of start and noise"},
              {"noise", "object", "levels at tick 0"},
              {"parameters", "object", "values at tick 0"},
              {"changed_parameters", "object", "those that differ from their defaults"},
              {"world", "object", "time step and stepper"},
              {"model", "object", "hand, object, scenario"}};
    case RunTopic::kCommands:
      return {kSegment,
              kTick,
              kTime,
              {"seq", "integer", "counts the commands of the segment"},
              {"method", "string", "as on the wire; branch: a restored checkpoint began here"},
              {"state_hash", "string", "right after the command"}};
    case RunTopic::kState:
      return {kSegment,
              kTick,
              kTime,
              {"state", "string",
               "idle, grasping, holding, exploring, rotating, moving, releasing, dropped, faulted"},
              {"commands", "integer", "of the segment, applied before this state"},
              {"state_hash", "string", "of the whole simulation and controller"}};
    case RunTopic::kEvents:
      return {kSegment, kTick, kTime, {"kind", "string", ""}, {"text", "string", "one sentence"}};
    case RunTopic::kJoints:
      return {kSegment,
              kTick,
              kTime,
              {"angle_rad", "array", "sensed, per joint"},
              {"true_angle_rad", "array", "per joint"},
              {"true_rate_rad_s", "array", "per joint"},
              {"torque_nm", "array", "applied, per joint"}};
    case RunTopic::kContacts:
      return {kSegment,
              kTick,
              kTime,
              {"role", "array", "per finger: free, hold, explore, move"},
              {"in_contact", "array", "sensed, per finger"},
              {"p_WC_m", "array", "sensed contact points in W, per finger"},
              {"normal_W", "array", "sensed outward normals of the object, per finger"},
              {"force_n", "array", "sensed normal force, per finger"},
              {"true_p_WC_m", "array", "per finger; zero without contact"}};
    case RunTopic::kForces:
      return {kSegment,
              kTick,
              kTime,
              {"force_command_W_n", "array", "on the object, that control asks for, per finger"},
              {"true_force_W_n", "array", "on the object, per finger"}};
    case RunTopic::kObject:
      return {kSegment,
              kTick,
              kTime,
              {"p_WO_m", "array", "sensed"},
              {"q_WO_wxyz", "array", "sensed"},
              {"true_p_WO_m", "array", ""},
              {"true_q_WO_wxyz", "array", ""},
              {"true_v_m_s", "array", ""},
              {"true_w_rad_s", "array", ""}};
    case RunTopic::kQuality:
      return {kSegment,
              kTick,
              kTime,
              {"manipulability", "array", "per finger"},
              {"true_manipulability", "array", "per finger"},
              {"load_margin_without_n", "array", "per finger"},
              {"load_margin_n", "number", "of the whole grasp"},
              {"stability", "number", "the selected measure"},
              {"threshold", "number", "of the criterion switched"},
              {"min_singular_value", "number", ""},
              {"epsilon", "number", ""},
              {"sqrt_det", "number", ""},
              {"isotropy", "number", ""},
              {"exploring", "integer", "index of the finger, -1: none"},
              {"phi", "number", "of the exploration"},
              {"gradient_norm_1_m", "number", "of the exploration"}};
    case RunTopic::kGait:
      return {kSegment,
              kTick,
              kTime,
              {"phase", "string", "of the gait"},
              {"finger", "integer", "index of the finger that regrasps, -1: none"},
              {"state", "string", "of the gait table: S_T, ..., object motion while all hold"},
              {"reference_angle_rad", "number", "of the object's reference so far"},
              {"target_angle_rad", "number", "the same, by its older name"},
              {"achieved_angle_rad", "number", ""},
              {"cycles", "integer", ""},
              {"regrasps", "integer", ""}};
  }
  return {};
}

double Round(double x) { return std::round(x * 1e7) / 1e7 + 0.0; }  // no -0

template <typename Vector>
Json List(const Vector& v) {
  Json json = Json::array();
  for (Eigen::Index i = 0; i < v.size(); ++i) json.push_back(Round(v[i]));
  return json;
}
Json Wxyz(const Quaterniond& q) { return List(Eigen::Vector4d(q.w(), q.x(), q.y(), q.z())); }

template <typename Get>
Json PerFinger(const Frame& frame, Get get) {
  Json json = Json::array();
  for (const FingerFrame& finger : frame.fingers) json.push_back(get(finger));
  return json;
}

}  // namespace

std::string RunSchema(RunTopic topic) {
  Json properties = Json::object(), required = Json::array();
  for (const Field& field : Fields(topic)) {
    properties[field.name] = {{"type", field.type}};
    if (*field.meaning) properties[field.name]["description"] = field.meaning;
    required.push_back(field.name);
  }
  return Json{{"type", "object"}, {"properties", properties}, {"required", required}}.dump();
}

std::string RunEvent(const Event& event, const HandModel& hand, double dt, int segment) {
  Json json = {{"segment", segment}};
  json.update(EventJson(event, hand, dt));
  return json.dump();
}

std::string RunSample(RunTopic topic, const Published& published, int segment) {
  const Frame& frame = published.frame;
  Json json = {{"segment", segment}, {"tick", frame.tick}, {"t_s", frame.time_s}};
  using F = const FingerFrame&;
  switch (topic) {
    case RunTopic::kState:
      json["state"] = Name(frame.state);
      json["commands"] = published.commands;
      json["state_hash"] = HashText(frame.state_hash);
      break;
    case RunTopic::kJoints:
      json["angle_rad"] = List(frame.q_sensed);
      json["true_angle_rad"] = List(frame.q);
      json["true_rate_rad_s"] = List(frame.qdot);
      json["torque_nm"] = List(frame.torque);
      break;
    case RunTopic::kContacts:
      json["role"] = PerFinger(frame, [](F f) { return Json(Name(f.role)); });
      json["in_contact"] = PerFinger(frame, [](F f) { return Json(f.in_contact); });
      json["p_WC_m"] = PerFinger(frame, [](F f) { return List(f.p_WC); });
      json["normal_W"] = PerFinger(frame, [](F f) { return List(f.normal_W); });
      json["force_n"] = PerFinger(frame, [](F f) { return Json(Round(f.force)); });
      json["true_p_WC_m"] = PerFinger(frame, [](F f) { return List(f.true_p_WC); });
      break;
    case RunTopic::kForces:
      json["force_command_W_n"] = PerFinger(frame, [](F f) { return List(f.f_command_W); });
      json["true_force_W_n"] = PerFinger(frame, [](F f) { return List(f.true_force_W); });
      break;
    case RunTopic::kObject:
      json["p_WO_m"] = List(frame.p_WO_sensed);
      json["q_WO_wxyz"] = Wxyz(frame.q_WO_sensed);
      json["true_p_WO_m"] = List(frame.p_WO);
      json["true_q_WO_wxyz"] = Wxyz(frame.q_WO);
      json["true_v_m_s"] = List(frame.v_WO);
      json["true_w_rad_s"] = List(frame.w_WO);
      break;
    case RunTopic::kQuality:
      json["manipulability"] = PerFinger(frame, [](F f) { return Json(Round(f.manipulability)); });
      json["true_manipulability"] =
          PerFinger(frame, [](F f) { return Json(Round(f.true_manipulability)); });
      json["load_margin_without_n"] =
          PerFinger(frame, [](F f) { return Json(Round(f.load_margin_without)); });
      json["load_margin_n"] = Round(frame.stability.load_margin);
      json["stability"] = Round(frame.stability.active);
      json["threshold"] = Round(frame.stability.threshold);
      json["min_singular_value"] = Round(frame.stability.min_singular_value);
      json["epsilon"] = Round(frame.stability.epsilon);
      json["sqrt_det"] = Round(frame.stability.sqrt_det);
      json["isotropy"] = Round(frame.stability.isotropy);
      json["exploring"] = frame.exploration.active ? frame.exploration.finger : -1;
      json["phi"] = Round(frame.exploration.phi);
      json["gradient_norm_1_m"] = Round(frame.exploration.gradient_norm);
      break;
    case RunTopic::kGait:
      json["phase"] = Name(static_cast<GaitPhase>(frame.gait.phase));
      json["finger"] = frame.gait.finger;
      json["state"] = frame.gait.state;
      json["reference_angle_rad"] = Round(frame.gait.reference_angle_rad);
      json["target_angle_rad"] = Round(frame.gait.target_angle_rad);
      json["achieved_angle_rad"] = Round(frame.gait.achieved_angle_rad);
      json["cycles"] = frame.gait.cycles;
      json["regrasps"] = frame.gait.regrasps;
      break;
    case RunTopic::kRun:
    case RunTopic::kCommands:
    case RunTopic::kEvents:
      break;
  }
  return json.dump();
}

}  // namespace regrasp
