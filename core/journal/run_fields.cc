#include "core/journal/run_fields.h"

#include <array>
#include <cmath>

#include "core/gait/finger_gait.h"
#include "core/journal/model_fields.h"
namespace regrasp {
namespace {

using Json = nlohmann::ordered_json;
using S = const RunSampleSource&;
using F = const FingerFrame&;
using Type = RunFieldType;
using Field = RunField;
using Per = Type::Per;
constexpr Type kNumber{"number"}, kInteger{"integer"}, kText{"string"}, kBoolean{"boolean"},
    kNumbers{"array", "number"}, kStructure{"object"};

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
Json Known(bool known, double x) { return known && !std::isnan(x) ? Json(Round(x)) : Json(); }

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
          {"target_angle_rad", kNumber, "equal to reference_angle_rad; kept for scripts",
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

std::string NamesOfStates() {
  std::string names;
  for (int i = 0; i <= static_cast<int>(kLastState); ++i)
    names += (i > 0 ? ", " : "") + std::string(Name(static_cast<SessionState>(i)));
  return names;
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
      return {{"state", kText, NamesOfStates(), [](S s) { return Json(Name(s.frame.state)); }},
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

}  // namespace

const std::vector<RunField>& FieldsOf(RunTopic topic) {
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

}  // namespace regrasp
