#include "core/journal/run_messages.h"

#include <array>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/gait/finger_gait.h"
#include "core/journal/check.h"
#include "core/journal/checked_json.h"
#include "core/journal/event_json.h"
#include "core/journal/journal_text.h"
#include "core/journal/model_fields.h"
#include "core/journal/run_scene.h"
#include "core/journal/saved_state.h"

namespace regrasp {
namespace {

using Json = nlohmann::ordered_json;

double Round(double x) { return std::round(x * 1e7) / 1e7 + 0.0; }  // no -0

template <typename Vector>
Json List(const Vector& v) {
  Json json = Json::array();
  for (Eigen::Index i = 0; i < v.size(); ++i) json.push_back(Round(v[i]));
  return json;
}
Json Wxyz(const Quaterniond& q) { return List(Eigen::Vector4d(q.w(), q.x(), q.y(), q.z())); }
/// Of three numbers that are not known.
Json Unknown3() { return {nullptr, nullptr, nullptr}; }
Json Known(bool known, double x) { return known ? Json(Round(x)) : Json(); }

/// What one sample is made of.
struct Sample {
  const Frame& frame;
  const HandModel& hand;
  std::size_t commands;
  bool grasp;  ///< there is one: a finger that holds is in contact
};
using S = const Sample&;
using F = const FingerFrame&;

/// What a field's value is called in a schema, and for how many: one, or an object with a member
/// for each finger or joint.
struct Type {
  const char* name;        ///< of JSON
  const char* items = "";  ///< of an array
  enum class Per { kSample, kFinger, kJoint } per = Per::kSample;
};
using Per = Type::Per;
constexpr Type kNumber{"number"}, kInteger{"integer"}, kText{"string"}, kBoolean{"boolean"},
    kNumbers{"array", "number"}, kStructure{"object"};

/// One field of a topic: its place in the schema, and how a sample fills it. Topics that are not
/// sampled (run, commands, events) are written elsewhere and have no `get`.
struct Field {
  std::string name;
  Type type;
  std::string meaning;
  std::function<Json(S)> get = {};
  bool always = true;  ///< every message has it
};

/// An object with a member for each finger.
Field PerFinger(const char* name, Type type, const char* meaning, Json (*get)(F)) {
  type.per = Per::kFinger;
  return {name, type, meaning, [get](S s) {
            Json json = Json::object();
            for (std::size_t i = 0; i < s.frame.fingers.size(); ++i)
              json[s.hand.fingers[i].name] = get(s.frame.fingers[i]);
            return json;
          }};
}

/// An object with a member for each driven joint.
Field PerJoint(const char* name, const char* meaning, JointVector Frame::*values) {
  return {name, {"number", "", Per::kJoint}, meaning, [values](S s) {
            Json json = Json::object();
            for (Eigen::Index i = 0; i < (s.frame.*values).size(); ++i)
              json[s.hand.joints[static_cast<std::size_t>(i)].name] = Round((s.frame.*values)[i]);
            return json;
          }};
}

/// Nothing but sometimes.
Field Sometimes(const char* name, Type type, const char* meaning) {
  return {name, type, meaning, {}, false};
}

Json FingerName(const HandModel& hand, int finger) {
  if (finger < 0 || finger >= hand.num_fingers()) return nullptr;
  return hand.fingers[static_cast<std::size_t>(finger)].name;
}

const Field kSegment = {"segment", kInteger, "counts resets and restores within the file"};
const Field kTick = {"tick", kInteger, "number of steps since the reset"};
const Field kTime = {"t_s", kNumber, "tick times dt [s]"};

std::vector<Field> QualityFields() {
  std::vector<Field> fields = {
      PerFinger("manipulability", kNumber, "as sensed",
                [](F f) { return Json(Round(f.manipulability)); }),
      PerFinger("true_manipulability", kNumber, "null without contact",
                [](F f) { return Known(f.true_contact, f.true_manipulability); }),
      {"load_margin_without_n",
       {"number", "", Per::kFinger},
       "of the grasp without this finger; null where there is none",
       [](S s) {
         Json json = Json::object();
         for (std::size_t i = 0; i < s.frame.fingers.size(); ++i)
           json[s.hand.fingers[i].name] = Known(s.grasp, s.frame.fingers[i].load_margin_without);
         return json;
       }},
      {"load_margin_n", kNumber, "of the whole grasp; null where there is none",
       [](S s) { return Known(s.grasp, s.frame.stability.load_margin); }},
      {"stability", kNumber, "the selected measure; null where there is no grasp",
       [](S s) { return Known(s.grasp, s.frame.stability.active); }},
      {"stability_measure", kText, "its name",
       [](S s) { return Json(InfoOf(s.frame.stability.measure).name); }},
      {"threshold", kNumber, "of the criterion switched; null before the first tick",
       [](S s) { return Known(s.frame.tick > 0, s.frame.stability.threshold); }}};
  for (std::size_t i = 0; i < kNumFrameMeasures; ++i) {
    const MeasureInfo& info = kMeasureTable[i];
    fields.push_back({std::string(info.name), kNumber, std::string(info.meaning),
                      [i](S s) { return Known(s.grasp, s.frame.stability.values[i]); }});
  }
  fields.insert(fields.end(),
                {{"exploring", kText, "the finger; null: none",
                  [](S s) {
                    const ExplorationFrame& e = s.frame.exploration;
                    return e.active ? FingerName(s.hand, e.finger) : Json();
                  }},
                 {"phi", kNumber, "of the exploration; null: none",
                  [](S s) { return Known(s.frame.exploration.active, s.frame.exploration.phi); }},
                 {"gradient_norm_1_m", kNumber, "of the exploration; null: none", [](S s) {
                    const ExplorationFrame& e = s.frame.exploration;
                    return Known(e.active, e.gradient_norm);
                  }}});
  return fields;
}

std::vector<Field> JointFields() {
  return {PerJoint("angle_rad", "as sensed", &Frame::q_sensed),
          PerJoint("true_angle_rad", "", &Frame::q), PerJoint("true_rate_rad_s", "", &Frame::qdot),
          PerJoint("torque_nm", "applied", &Frame::torque)};
}

std::vector<Field> ContactFields() {
  return {
      PerFinger("role", kText, "free, hold, explore, move", [](F f) { return Json(Name(f.role)); }),
      PerFinger("in_contact", kBoolean, "as sensed", [](F f) { return Json(f.in_contact); }),
      PerFinger("p_WC_m", kNumbers, "sensed contact point in W; nulls without contact",
                [](F f) { return f.in_contact ? List(f.p_WC) : Unknown3(); }),
      PerFinger("normal_W", kNumbers, "sensed outward normal of the object; nulls without contact",
                [](F f) { return f.in_contact ? List(f.normal_W) : Unknown3(); }),
      PerFinger("force_n", kNumber, "sensed normal force",
                [](F f) { return Json(Round(f.force)); }),
      PerFinger("true_p_WC_m", kNumbers, "nulls without contact",
                [](F f) { return f.true_contact ? List(f.true_p_WC) : Unknown3(); })};
}

std::vector<Field> ForceFields() {
  return {PerFinger("force_command_W_n", kNumbers, "on the object, that control asks for",
                    [](F f) { return List(f.f_command_W); }),
          PerFinger("true_force_W_n", kNumbers, "on the object",
                    [](F f) { return List(f.true_force_W); })};
}

std::vector<Field> ObjectFields() {
  return {{"p_WO_m", kNumbers, "as sensed", [](S s) { return List(s.frame.p_WO_sensed); }},
          {"q_WO_wxyz", kNumbers, "as sensed", [](S s) { return Wxyz(s.frame.q_WO_sensed); }},
          {"true_p_WO_m", kNumbers, "", [](S s) { return List(s.frame.p_WO); }},
          {"true_q_WO_wxyz", kNumbers, "", [](S s) { return Wxyz(s.frame.q_WO); }},
          {"true_v_m_s", kNumbers, "", [](S s) { return List(s.frame.v_WO); }},
          {"true_w_rad_s", kNumbers, "", [](S s) { return List(s.frame.w_WO); }}};
}

std::vector<Field> GaitFields() {
  return {{"phase", kText, "of the gait",
           [](S s) { return Json(Name(static_cast<GaitPhase>(s.frame.gait.phase))); }},
          {"finger", kText, "that regrasps; null: none",
           [](S s) { return FingerName(s.hand, s.frame.gait.finger); }},
          {"state", kText, "of the gait table: S_T, ..., object motion while all hold",
           [](S s) { return Json(s.frame.gait.state); }},
          {"reference_angle_rad", kNumber, "of the object's reference so far",
           [](S s) { return Json(Round(s.frame.gait.reference_angle_rad)); }},
          {"target_angle_rad", kNumber, "the same, by its older name",
           [](S s) { return Json(Round(s.frame.gait.target_angle_rad)); }},
          {"achieved_angle_rad", kNumber, "",
           [](S s) { return Json(Round(s.frame.gait.achieved_angle_rad)); }},
          {"cycles", kInteger, "", [](S s) { return Json(s.frame.gait.cycles); }},
          {"regrasps", kInteger, "", [](S s) { return Json(s.frame.gait.regrasps); }}};
}

std::vector<Field> CommandFields() {
  return {{"seq", kInteger, "counts the commands of the segment"},
          {"method", kText, "as on the wire; branch: a restored checkpoint began here"},
          Sometimes("job", kInteger, "that it started"),
          Sometimes("finger", kText, "explore"),
          Sometimes("criterion", kInteger, "explore"),
          Sometimes("estimator", kInteger, "explore"),
          Sometimes("seed", kInteger, "explore, branch"),
          Sometimes("max_cycles", kInteger, "explore"),
          Sometimes("continuous", kBoolean, "rotate"),
          Sometimes("angle_rad", kNumber, "rotate"),
          Sometimes("axis_W", kNumbers, "rotate"),
          Sometimes("speed_rad_s", kNumber, "rotate"),
          Sometimes("offset_m", kNumbers, "move"),
          Sometimes("rotation_rad", kNumbers, "move"),
          Sometimes("noise", kStructure, "noise.set: every level"),
          Sometimes("force_W_n", kNumbers, "push"),
          Sometimes("duration_s", kNumber, "push"),
          Sometimes("name", kText, "param.set"),
          Sometimes("value", kNumbers, "param.set"),
          Sometimes("reseed", kBoolean, "branch"),
          {"state_hash", kText, "right after the command"}};
}

std::vector<Field> EventFields() {
  return {{"kind", kText, ""},
          {"finger", kText, "null: of no finger"},
          {"value", kNumber, "see the event's kind"},
          Sometimes("state", kText, "that was entered"),
          Sometimes("job", kInteger, "that began or ended"),
          Sometimes("from", kNumber, "regrasp: the objective where the finger began to explore"),
          {"text", kText, "one sentence"},
          {"timestamp", kStructure, "the same moment, for viewers: {sec, nsec} of the file"},
          {"level", kInteger, "for viewers: 2 information, 3 warning, 4 error"},
          {"message", kText, "for viewers: the sentence"},
          {"name", kText, "for viewers: who says so"},
          {"file", kText, "for viewers: empty"},
          {"line", kInteger, "for viewers: 0"}};
}

/// Fields of a topic after segment, tick and time.
std::vector<Field> OwnFields(RunTopic topic) {
  switch (topic) {
    case RunTopic::kRun:
      return {{"format", kText, "regrasp-run/2"},
              {"build", kText, "version, commit, compiler, flags"},
              {"hand_name", kText, ""},
              {"object_name", kText, ""},
              {"seed", kInteger, "of start and noise"},
              {"noise", kStructure, "levels at tick 0"},
              {"parameters", kStructure, "values at tick 0"},
              {"changed_parameters", kStructure, "those that differ from their defaults"},
              {"world", kStructure, "time step and stepper"},
              {"model", kStructure, "hand, object, scenario"}};
    case RunTopic::kCommands:
      return CommandFields();
    case RunTopic::kState:
      return {{"state", kText,
               "idle, grasping, holding, exploring, rotating, moving, releasing, dropped, faulted",
               [](S s) { return Json(Name(s.frame.state)); }},
              {"commands", kInteger, "of the segment, applied before this state",
               [](S s) { return Json(s.commands); }},
              {"state_hash", kText, "of the whole simulation and controller",
               [](S s) { return Json(HashText(s.frame.state_hash)); }}};
    case RunTopic::kEvents:
      return EventFields();
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
    case RunTopic::kSavedStates:
      return {{"commands", kInteger, "of the segment, applied before this state"},
              {"state_hash", kText, "of the whole simulation and controller"},
              {"saved_state", kText, "in base64; only the build that wrote it reads it"}};
    case RunTopic::kTransforms:
    case RunTopic::kScene:
    case RunTopic::kContactScene:
      break;
  }
  return {};
}

/// Every field of a topic, in the order of its message.
const std::vector<Field>& Fields(RunTopic topic) {
  static const auto all = [] {
    std::array<std::vector<Field>, kRunTopics.size()> lists;
    for (std::size_t i = 0; i < lists.size(); ++i) {
      const std::vector<Field> own = OwnFields(static_cast<RunTopic>(i));
      if (own.empty()) continue;  // a public schema
      lists[i] = {kSegment};
      if (static_cast<RunTopic>(i) != RunTopic::kRun)
        lists[i].insert(lists[i].end(), {kTick, kTime});
      lists[i].insert(lists[i].end(), own.begin(), own.end());
    }
    return lists;
  }();
  return all[static_cast<std::size_t>(topic)];
}

/// "number per finger", "array of number", ...
std::string TypeText(const Type& type) {
  std::string text = type.name;
  if (*type.items != 0) text += std::string(" of ") + type.items;
  if (type.per == Per::kFinger) text += " per finger";
  if (type.per == Per::kJoint) text += " per joint";
  return text;
}

/// The schema of what `value` is an example of. Lists hold one kind of thing: what the first lacks,
/// another may have. An empty list has no `items` yet.
Json Example(const Json& value) {
  if (value.is_object()) {
    Json properties = Json::object();
    for (const auto& [name, member] : value.items()) properties[name] = Example(member);
    return {{"type", "object"}, {"properties", std::move(properties)}};
  }
  if (value.is_array()) {
    Json schema = {{"type", "array"}};
    for (const Json& item : value) schema["items"].merge_patch(Example(item));
    return schema;
  }
  return {{"type", value.is_boolean()          ? "boolean"
                   : value.is_string()         ? "string"
                   : value.is_number_integer() ? "integer"
                                               : "number"}};
}

/// Lists of which no example had an item hold numbers.
void CompleteItems(Json* schema) {
  if ((*schema)["type"] == "array" && !schema->contains("items"))
    (*schema)["items"] = {{"type", "number"}};
  if (schema->contains("items")) CompleteItems(&(*schema)["items"]);
  if (schema->contains("properties"))
    for (auto& [name, member] : (*schema)["properties"].items()) CompleteItems(&member);
}

Json SchemaOf(const Json& value) {
  Json schema = Example(value);
  CompleteItems(&schema);
  return schema;
}

Json FieldSchema(const Field& field, const HandModel& hand) {
  Json one = {{"type", field.type.name}};
  if (*field.type.items != 0) one["items"] = {{"type", field.type.items}};
  if (field.type.per == Per::kSample) return one;
  Json members = Json::object();
  if (field.type.per == Per::kFinger)
    for (const Finger& finger : hand.fingers) members[finger.name] = one;
  else
    for (int j = 0; j < hand.num_joints(); ++j)
      members[hand.joints[static_cast<std::size_t>(j)].name] = one;
  return {{"type", "object"}, {"properties", std::move(members)}};
}

/// 2 information, 3 warning, 4 error, as foxglove.Log has them.
int LogLevel(EventKind kind) {
  if (kind == EventKind::kFault || kind == EventKind::kDropped) return 4;
  const bool warning =
      kind == EventKind::kContactLost || kind == EventKind::kRefused || kind == EventKind::kSlip;
  return warning ? 3 : 2;
}

bool HasGrasp(const Frame& frame) {
  for (F f : frame.fingers)
    if (f.role != FingerRole::kFree && f.in_contact) return true;
  return false;
}

}  // namespace

bool IsTabular(std::string_view topic) {
  return topic != "transforms" && topic != "scene" && topic != "contact_scene" &&
         topic != "saved_states";
}

std::string RunFieldTable() {
  std::string text = "| topic | field | type | meaning |\n|---|---|---|---|\n";
  for (std::size_t i = 0; i < kRunTopics.size(); ++i) {
    const std::string topic = "| `" + std::string(kRunTopics[i]) + "` | ";
    for (const Field& field : Fields(static_cast<RunTopic>(i)))
      text +=
          topic + "`" + field.name + "` | " + TypeText(field.type) + " | " + field.meaning + " |\n";
  }
  text +=
      "| `transforms` | as foxglove.FrameTransforms | | links and object in W, by the truth |\n";
  text += "| `scene` | as foxglove.SceneUpdate | | shapes of links and object |\n";
  text += "| `contact_scene` | as foxglove.SceneUpdate | | true contacts of the object, forces |\n";
  return text;
}

std::string RunSchemaName(RunTopic topic) {
  switch (topic) {
    case RunTopic::kEvents:
      return "foxglove.Log";
    case RunTopic::kTransforms:
      return "foxglove.FrameTransforms";
    case RunTopic::kScene:
    case RunTopic::kContactScene:
      return "foxglove.SceneUpdate";
    default:
      return "regrasp." + std::string(kRunTopics[static_cast<std::size_t>(topic)]);
  }
}

std::string RunSchema(RunTopic topic, const SessionConfig& config) {
  if (topic == RunTopic::kTransforms) return scene::TransformsSchema().dump();
  if (topic == RunTopic::kScene || topic == RunTopic::kContactScene)
    return scene::SceneSchema().dump();
  Json example = Json::object();  // of what is a structure
  if (topic == RunTopic::kRun) example = ParseFileJson(ConfigText(config, 0));
  if (topic == RunTopic::kCommands) example["noise"] = fields::ToJson(config.noise);
  if (topic == RunTopic::kEvents) example["timestamp"] = scene::Time(0);
  Json properties = Json::object(), required = Json::array();
  for (const Field& field : Fields(topic)) {
    Json& schema = properties[field.name];
    const bool structure = std::string_view(field.type.name) == "object";
    schema = structure ? SchemaOf(example.at(field.name)) : FieldSchema(field, config.model.hand);
    if (!field.meaning.empty()) schema["description"] = field.meaning;
    if (field.always) required.push_back(field.name);
  }
  if (topic == RunTopic::kSavedStates) properties["saved_state"]["contentEncoding"] = "base64";
  return Json{{"type", "object"}, {"properties", properties}, {"required", required}}.dump();
}

std::string RunEvent(const Event& event, const RunPlace& place) {
  Json json = {{"segment", place.segment}};
  json.update(EventJson(event, place.config.model.hand, place.config.world.dt));
  json["timestamp"] = scene::Time(place.time_ns);
  json["level"] = LogLevel(event.kind);
  json["message"] = event.text;
  json["name"] = "regrasp";
  json["file"] = "";
  json["line"] = 0;
  return json.dump();
}

std::string RunScene(const RunPlace& place) { return scene::Shapes(place).dump(); }

std::string RunSample(RunTopic topic, const Frame& frame, std::size_t commands,
                      const RunPlace& place) {
  if (topic == RunTopic::kTransforms) return scene::Transforms(frame, place).dump();
  if (topic == RunTopic::kContactScene) return scene::Contacts(frame, place).dump();
  Json json = {{"segment", place.segment},
               {"tick", frame.tick},
               {"t_s", TickSeconds(frame.tick, place.config.world.dt)}};
  const Sample sample{frame, place.config.model.hand, commands, HasGrasp(frame)};
  for (const Field& field : Fields(topic))
    if (field.get) json[field.name] = field.get(sample);
  return json.dump();
}

std::string SavedStateText(const RunSavedState& state, double dt) {
  return Json{{"segment", state.segment},
              {"tick", state.tick},
              {"t_s", TickSeconds(state.tick, dt)},
              {"commands", state.commands},
              {"state_hash", HashText(state.state_hash)},
              {"saved_state", ToBase64(state.bytes)}}
      .dump();
}

RunSavedState ParseSavedState(std::string_view text) {
  const fields::Json json = ParseFileJson(text);
  fields::Load load{json};
  RunSavedState state;
  std::string hash, bytes;
  load("segment", state.segment);
  load("tick", state.tick);
  load("commands", state.commands);
  load("state_hash", hash);
  load("saved_state", bytes);
  CheckRange("tick of a saved state", static_cast<double>(state.tick), 0,
             static_cast<double>(kMaxTick));
  state.state_hash = ParseHash(hash);
  state.bytes = FromBase64(bytes);
  return state;
}

}  // namespace regrasp
