#pragma once

/// What a run file holds, topic by topic: JSON messages and their schemas. Lists are in the order
/// of the hand's joints or fingers (topic `run`, field `model`); units are in the names.

#include <array>
#include <string>
#include <string_view>

#include "core/hand/hand_model.h"
#include "core/session/frame.h"
#include "daemon/loop/control_loop.h"

namespace regrasp {

/// Topics, in the order of their channels.
enum class RunTopic : std::uint8_t {
  kRun,       ///< the configuration; one at the beginning and one at each reset
  kCommands,  ///< every command with its tick
  kState,     ///< state hashes
  kEvents,
  kJoints,
  kContacts,
  kForces,
  kObject,
  kQuality,
  kGait,  ///< only while rotating
};
inline constexpr std::array<std::string_view, 10> kRunTopics = {
    "run",      "commands", "state",  "events",  "joints",
    "contacts", "forces",   "object", "quality", "gait"};

/// Every field of every topic, as a table in Markdown: topic, field, type, meaning.
std::string RunFieldTable();

/// The JSON schema of a topic.
std::string RunSchema(RunTopic topic);

/// The message of a sampled topic (state, joints ... gait). Samples are rounded to 1e-7.
std::string RunSample(RunTopic topic, const Published& published, int segment);
std::string RunEvent(const Event& event, const HandModel& hand, double dt, int segment);

}  // namespace regrasp
