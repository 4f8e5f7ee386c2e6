#pragma once

/// The jobs that commands start, as one table: what a job is called, which command starts it, from
/// which state and in which it runs. Dispatch, names, journals, handlers and the states of the
/// session follow from here. A new job is a word of each enumeration, a row, and its activity
/// (activity/all.h); what it takes and answers is its row in core/protocol/job_rows.h.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/common/info_table.h"

namespace regrasp {

enum class CommandType : std::uint8_t {
  kGrasp,
  kRelease,
  kExplore,
  kRotate,
  kMove,
  kStop,
  kNoise,
  kPush,
  kParameter,
  kCancelJob,
  kBranch,
};

/// The last two are the daemon's own: no command of a session starts them.
enum class JobMethod : std::uint8_t { kGrasp, kRelease, kExplore, kRotate, kMove, kStep, kRestore };

enum class SessionState : std::uint8_t {
  kIdle,
  kGrasping,
  kHolding,
  kExploring,
  kRotating,
  kMoving,
  kDropped,
  kFaulted,
  kReleasing
};
inline constexpr SessionState kLastState = SessionState::kReleasing;

struct JobInfo {
  JobMethod id;
  std::string_view name;  ///< on the wire, in journals and on the command line
  CommandType command;    ///< that starts it
  SessionState from;      ///< in which it may start: idle or holding
  SessionState state;     ///< in which it runs
  std::string_view state_name;
  bool holds;  ///< the fingers hold the object meanwhile, once the stand-in has let go
};

// clang-format off
inline constexpr auto kJobTable = std::to_array<JobInfo>({
  {JobMethod::kGrasp, "grasp", CommandType::kGrasp, SessionState::kIdle, SessionState::kGrasping, "grasping", true},
  {JobMethod::kRelease, "release", CommandType::kRelease, SessionState::kHolding, SessionState::kReleasing, "releasing", false},
  {JobMethod::kExplore, "explore", CommandType::kExplore, SessionState::kHolding, SessionState::kExploring, "exploring", true},
  {JobMethod::kRotate, "rotate", CommandType::kRotate, SessionState::kHolding, SessionState::kRotating, "rotating", true},
  {JobMethod::kMove, "move", CommandType::kMove, SessionState::kHolding, SessionState::kMoving, "moving", true},
});
// clang-format on
static_assert(InOrder(kJobTable) && kJobTable.size() == static_cast<std::size_t>(JobMethod::kStep));

/// The row whose `member` is `value`, or null.
template <typename T>
constexpr const JobInfo* FindJob(T JobInfo::*member, const T& value) {
  const auto row = std::ranges::find(kJobTable, value, member);
  return row == kJobTable.end() ? nullptr : &*row;
}

/// The job that a command starts, or nothing for a command that starts none.
constexpr std::optional<JobMethod> JobMethodOf(CommandType type) {
  const JobInfo* row = FindJob(&JobInfo::command, type);
  return row ? std::optional(row->id) : std::nullopt;
}

}  // namespace regrasp
