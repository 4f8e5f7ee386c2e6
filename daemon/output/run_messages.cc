#include "daemon/output/run_messages.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "core/gait/finger_gait.h"
#include "core/journal/journal.h"
#include "daemon/wire/frame_json.h"

namespace regrasp {
namespace {

double Round(double x) { return std::round(x * 1e7) / 1e7 + 0.0; }  // no -0

template <typename Vector>
Json List(const Vector& v) {
  Json json = Json::array();
  for (Eigen::Index i = 0; i < v.size(); ++i) json.push_back(Round(v[i]));
  return json;
}
Json Wxyz(const Quaterniond& q) { return List(Eigen::Vector4d(q.w(), q.x(), q.y(), q.z())); }

/// What one sample is made of.
struct Sample {
  const Published& published;
  const Frame& frame;
};
using S = const Sample&;
using F = const FingerFrame&;

/// One field of a topic: its place in the schema, and how a sample fills it. Topics that are not
/// sampled (run, commands, events) are written elsewhere and have no `get`.
struct Field {
  std::string name;
  const char* type;  ///< of JSON
  std::string meaning;
  std::function<Json(S)> get = {};
};

/// A list with an entry for each finger.
Field PerFinger(const char* name, const char* meaning, Json (*get)(F)) {
  return {name, "array", meaning, [get](S s) {
            Json json = Json::array();
            for (const FingerFrame& finger : s.frame.fingers) json.push_back(get(finger));
            return json;
          }};
}

const Field kSegment = {"segment", "integer", "counts resets and restores within the file"};
const Field kTick = {"tick", "integer", "number of steps since the reset"};
const Field kTime = {"t_s", "number", "tick times dt [s]"};

std::vector<Field> QualityFields() {
  std::vector<Field> fields = {
      PerFinger("manipulability", "per finger", [](F f) { return Json(Round(f.manipulability)); }),
      PerFinger("true_manipulability", "per finger",
                [](F f) { return Json(Round(f.true_manipulability)); }),
      PerFinger("load_margin_without_n", "per finger",
                [](F f) { return Json(Round(f.load_margin_without)); }),
      {"load_margin_n", "number", "of the whole grasp",
       [](S s) { return Round(s.frame.stability.load_margin); }},
      {"stability", "number", "the selected measure",
       [](S s) { return Round(s.frame.stability.active); }},
      {"stability_measure", "string", "its name",
       [](S s) { return Json(InfoOf(s.frame.stability.measure).name); }},
      {"threshold", "number", "of the criterion switched",
       [](S s) { return Round(s.frame.stability.threshold); }}};
  for (std::size_t i = 0; i < kNumFrameMeasures; ++i) {
    const MeasureInfo& info = kMeasureTable[i];
    fields.push_back({std::string(info.name), "number", std::string(info.meaning),
                      [i](S s) { return Round(s.frame.stability.values[i]); }});
  }
  fields.insert(
      fields.end(),
      {{"exploring", "integer", "index of the finger, -1: none",
        [](S s) { return s.frame.exploration.active ? s.frame.exploration.finger : -1; }},
       {"phi", "number", "of the exploration", [](S s) { return Round(s.frame.exploration.phi); }},
       {"gradient_norm_1_m", "number", "of the exploration",
        [](S s) { return Round(s.frame.exploration.gradient_norm); }}});
  return fields;
}

std::vector<Field> JointFields() {
  return {{"angle_rad", "array", "sensed, per joint", [](S s) { return List(s.frame.q_sensed); }},
          {"true_angle_rad", "array", "per joint", [](S s) { return List(s.frame.q); }},
          {"true_rate_rad_s", "array", "per joint", [](S s) { return List(s.frame.qdot); }},
          {"torque_nm", "array", "applied, per joint", [](S s) { return List(s.frame.torque); }}};
}

std::vector<Field> ContactFields() {
  return {PerFinger("role", "per finger: free, hold, explore, move",
                    [](F f) { return Json(Name(f.role)); }),
          PerFinger("in_contact", "sensed, per finger", [](F f) { return Json(f.in_contact); }),
          PerFinger("p_WC_m", "sensed contact points in W, per finger",
                    [](F f) { return List(f.p_WC); }),
          PerFinger("normal_W", "sensed outward normals of the object, per finger",
                    [](F f) { return List(f.normal_W); }),
          PerFinger("force_n", "sensed normal force, per finger",
                    [](F f) { return Json(Round(f.force)); }),
          PerFinger("true_p_WC_m", "per finger; zero without contact",
                    [](F f) { return List(f.true_p_WC); })};
}

std::vector<Field> ForceFields() {
  return {PerFinger("force_command_W_n", "on the object, that control asks for, per finger",
                    [](F f) { return List(f.f_command_W); }),
          PerFinger("true_force_W_n", "on the object, per finger",
                    [](F f) { return List(f.true_force_W); })};
}

std::vector<Field> ObjectFields() {
  return {{"p_WO_m", "array", "sensed", [](S s) { return List(s.frame.p_WO_sensed); }},
          {"q_WO_wxyz", "array", "sensed", [](S s) { return Wxyz(s.frame.q_WO_sensed); }},
          {"true_p_WO_m", "array", "", [](S s) { return List(s.frame.p_WO); }},
          {"true_q_WO_wxyz", "array", "", [](S s) { return Wxyz(s.frame.q_WO); }},
          {"true_v_m_s", "array", "", [](S s) { return List(s.frame.v_WO); }},
          {"true_w_rad_s", "array", "", [](S s) { return List(s.frame.w_WO); }}};
}

std::vector<Field> GaitFields() {
  return {{"phase", "string", "of the gait",
           [](S s) { return Json(Name(static_cast<GaitPhase>(s.frame.gait.phase))); }},
          {"finger", "integer", "index of the finger that regrasps, -1: none",
           [](S s) { return Json(s.frame.gait.finger); }},
          {"state", "string", "of the gait table: S_T, ..., object motion while all hold",
           [](S s) { return Json(s.frame.gait.state); }},
          {"reference_angle_rad", "number", "of the object's reference so far",
           [](S s) { return Json(Round(s.frame.gait.reference_angle_rad)); }},
          {"target_angle_rad", "number", "the same, by its older name",
           [](S s) { return Json(Round(s.frame.gait.target_angle_rad)); }},
          {"achieved_angle_rad", "number", "",
           [](S s) { return Json(Round(s.frame.gait.achieved_angle_rad)); }},
          {"cycles", "integer", "", [](S s) { return Json(s.frame.gait.cycles); }},
          {"regrasps", "integer", "", [](S s) { return Json(s.frame.gait.regrasps); }}};
}

/// Fields of a topic after segment, tick and time.
std::vector<Field> OwnFields(RunTopic topic) {
  switch (topic) {
    case RunTopic::kRun:
      return {{"format", "string", "regrasp-run/1"},
              {"build", "string", "version, commit, compiler, flags"},
              {"seed", "integer", "of start and noise"},
              {"noise", "object", "levels at tick 0"},
              {"parameters", "object", "values at tick 0"},
              {"changed_parameters", "object", "those that differ from their defaults"},
              {"world", "object", "time step and stepper"},
              {"model", "object", "hand, object, scenario"}};
    case RunTopic::kCommands:
      return {{"seq", "integer", "counts the commands of the segment"},
              {"method", "string", "as on the wire; branch: a restored checkpoint began here"},
              {"state_hash", "string", "right after the command"}};
    case RunTopic::kState:
      return {{"state", "string",
               "idle, grasping, holding, exploring, rotating, moving, releasing, dropped, faulted",
               [](S s) { return Json(Name(s.frame.state)); }},
              {"commands", "integer", "of the segment, applied before this state",
               [](S s) { return Json(s.published.commands); }},
              {"state_hash", "string", "of the whole simulation and controller",
               [](S s) { return Json(HashText(s.frame.state_hash)); }}};
    case RunTopic::kEvents:
      return {{"kind", "string", ""}, {"text", "string", "one sentence"}};
    case RunTopic::kJoints:
      return JointFields();
    case RunTopic::kContacts:
      return ContactFields();
    case RunTopic::kForces:
      return ForceFields();
    case RunTopic::kObject:
      return ObjectFields();
    case RunTopic::kQuality:
      return QualityFields();
    case RunTopic::kGait:
      return GaitFields();
  }
  return {};
}

/// Every field of a topic, in the order of its message.
const std::vector<Field>& Fields(RunTopic topic) {
  static const auto all = [] {
    std::array<std::vector<Field>, kRunTopics.size()> lists;
    for (std::size_t i = 0; i < lists.size(); ++i) {
      lists[i] = {kSegment};
      if (static_cast<RunTopic>(i) != RunTopic::kRun)
        lists[i].insert(lists[i].end(), {kTick, kTime});
      const std::vector<Field> own = OwnFields(static_cast<RunTopic>(i));
      lists[i].insert(lists[i].end(), own.begin(), own.end());
    }
    return lists;
  }();
  return all[static_cast<std::size_t>(topic)];
}

}  // namespace

std::string RunFieldTable() {
  std::string text = "| topic | field | type | meaning |\n|---|---|---|---|\n";
  for (std::size_t i = 0; i < kRunTopics.size(); ++i)
    for (const Field& field : Fields(static_cast<RunTopic>(i)))
      text += fmt::format("| `{}` | `{}` | {} | {} |\n", kRunTopics[i], field.name, field.type,
                          field.meaning);
  return text;
}

std::string RunSchema(RunTopic topic) {
  Json properties = Json::object(), required = Json::array();
  for (const Field& field : Fields(topic)) {
    properties[field.name] = {{"type", field.type}};
    if (!field.meaning.empty()) properties[field.name]["description"] = field.meaning;
    required.push_back(field.name);
  }
  return Json{{"type", "object"}, {"properties", properties}, {"required", required}}.dump();
}

std::string RunEvent(const Event& event, const HandModel& hand, double dt, int segment) {
  Json json = {{"segment", segment}};
  json.update(EventJson(event, hand, dt));
  json.erase("incident");  // a file beside the daemon, which may have another name by then
  return json.dump();
}

std::string RunSample(RunTopic topic, const Published& published, int segment) {
  const Frame& frame = published.frame;
  Json json = {{"segment", segment}, {"tick", frame.tick}, {"t_s", frame.time_s}};
  const Sample sample{published, frame};
  for (const Field& field : Fields(topic))
    if (field.get) json[field.name] = field.get(sample);
  return json.dump();
}

}  // namespace regrasp
