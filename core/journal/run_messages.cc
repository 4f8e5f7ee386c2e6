#include "core/journal/run_messages.h"

#include <nlohmann/json.hpp>
#include <vector>

#include "core/journal/check.h"
#include "core/journal/checked_json.h"
#include "core/journal/event_json.h"
#include "core/journal/journal_text.h"
#include "core/journal/model_fields.h"
#include "core/journal/run_fields.h"
#include "core/journal/run_scene.h"
#include "core/journal/saved_state.h"

namespace regrasp {
namespace {

using Json = nlohmann::ordered_json;
using Per = RunFieldType::Per;

/// "number per finger", "array of number", ...
std::string TypeText(const RunFieldType& type) {
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

Json FieldSchema(const RunField& field, const HandModel& hand) {
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
  for (const FingerFrame& f : frame.fingers)
    if (f.role != FingerRole::kFree && f.in_contact) return true;
  return false;
}

}  // namespace

bool IsTabular(std::string_view topic) {
  return topic != "transforms" && topic != "scene" && topic != "contact_scene" &&
         topic != "saved_states";
}

bool IsText(std::string_view topic, std::string_view field) {
  for (std::size_t i = 0; i < kRunTopics.size(); ++i)
    for (const RunField& known : FieldsOf(static_cast<RunTopic>(i)))
      if (kRunTopics[i] == topic && known.name == field)
        return known.type.name == std::string_view("string") &&
               known.type.per == RunFieldType::Per::kSample;
  return false;
}

std::string RunFieldTable() {
  std::string text = "| topic | field | type | meaning |\n|---|---|---|---|\n";
  for (std::size_t i = 0; i < kRunTopics.size(); ++i) {
    const std::string topic = "| `" + std::string(kRunTopics[i]) + "` | ";
    for (const RunField& field : FieldsOf(static_cast<RunTopic>(i)))
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
  for (const RunField& field : FieldsOf(topic)) {
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
  const RunSampleSource sample{frame, place.config.model.hand, commands, HasGrasp(frame)};
  for (const RunField& field : FieldsOf(topic))
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
