#pragma once

/// The fields of the topics of a run file, as one list: schema, messages and documentation follow
/// from it. For this folder only.

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/journal/run_messages.h"

namespace regrasp {

/// What one sample is made of.
struct RunSampleSource {
  const Frame& frame;
  const HandModel& hand;
  std::size_t commands;
  bool grasp;  ///< there is one: a finger that holds is in contact
};

/// What a field's value is called in a schema, and for how many: one, or an object with a member
/// for each finger or joint.
struct RunFieldType {
  const char* name;        ///< of JSON
  const char* items = "";  ///< of an array
  enum class Per { kSample, kFinger, kJoint } per = Per::kSample;
};

/// One field of a topic: its place in the schema, and how a sample fills it. Topics that are not
/// sampled (run, commands, events) are written elsewhere and have no `get`.
struct RunField {
  std::string name;
  RunFieldType type;
  std::string meaning;
  std::function<nlohmann::ordered_json(const RunSampleSource&)> get = {};
  bool always = true;  ///< every message has it
};

/// Every field of a topic, in the order of its message; none of one with a public schema.
const std::vector<RunField>& FieldsOf(RunTopic topic);

}  // namespace regrasp
