#pragma once

/// What a run file holds, topic by topic: JSON messages and their schemas, in the form that viewers
/// of MCAP files take: objects with named members, lists of numbers, no lists in lists. Units are
/// in the names; what is not known is null.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/session/session.h"

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
  kGait,          ///< only while rotating
  kTransforms,    ///< for viewers: where links and object are
  kScene,         ///< for viewers: their shapes; one at the beginning and one at each reset
  kContactScene,  ///< for viewers: every contact of the object, with its force
  kSavedStates,   ///< to go on from there at once
};
inline constexpr std::array<std::string_view, 14> kRunTopics = {
    "run",    "commands", "state", "events",     "joints", "contacts",      "forces",
    "object", "quality",  "gait",  "transforms", "scene",  "contact_scene", "saved_states"};

/// Whether a topic is of use in a table: those for viewers and the saved states are not.
bool IsTabular(std::string_view topic);

/// Whether a field of a topic holds a text, or null.
bool IsText(std::string_view topic, std::string_view field);

/// Every field of every topic, as a table in Markdown: topic, field, type, meaning.
std::string RunFieldTable();

/// The JSON schema of a topic in the file of a run with this configuration, and its name.
std::string RunSchema(RunTopic topic, const SessionConfig& config);
std::string RunSchemaName(RunTopic topic);

/// Where a message belongs.
struct RunPlace {
  const SessionConfig& config;  ///< of the segment
  int segment = 0;              ///< counts resets and restores within the file
  std::uint64_t time_ns = 0;    ///< in the file
};

/// The message of a sampled topic (state, joints ... gait, transforms, contact_scene). `commands`:
/// of the segment, applied before this frame. Samples are rounded to 1e-7, what viewers get to
/// 1e-10.
std::string RunSample(RunTopic topic, const Frame& frame, std::size_t commands,
                      const RunPlace& place);
std::string RunEvent(const Event& event, const RunPlace& place);
/// The shapes of hand and object.
std::string RunScene(const RunPlace& place);

/// A state to go on from; see saved_state.h.
struct RunSavedState {
  std::int64_t tick = 0;
  std::size_t commands = 0;  ///< of the segment, applied before it
  std::uint64_t state_hash = 0;
  int segment = 0;
  std::string bytes;  ///< SaveState()
};
std::string SavedStateText(const RunSavedState& state, double dt);
/// Throws JournalError, StateError. The bytes themselves are checked where they are loaded.
RunSavedState ParseSavedState(std::string_view text);

}  // namespace regrasp
