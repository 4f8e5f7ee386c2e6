#pragma once

/// Re-executes a journal at full speed and compares the state after every command.

#include <memory>

#include "core/journal/journal.h"

namespace regrasp {

/// The first place where a re-execution differs from what was recorded.
struct Divergence {
  std::int64_t tick = 0;                  ///< the first compared tick that differs
  std::int64_t last_equal = 0;            ///< the last compared tick that did not; -1: none
  int command = -1;                       ///< index of the command after which it shows; -1: none
  std::uint64_t recorded = 0, found = 0;  ///< state hashes
};

class Replay {
 public:
  /// Builds the session at tick 0. Throws ModelError as Session does.
  explicit Replay(std::shared_ptr<const Journal> journal);

  /// Steps until the session's tick is `tick`, applying the commands of earlier ticks; those of
  /// `tick` itself wait. Returns false, and goes no further, once a state differs.
  bool RunTo(std::int64_t tick);
  /// Applies the commands of the present tick, up to so many of the journal. Returns false when a
  /// state differs.
  bool ApplyDue(std::size_t commands = SIZE_MAX);
  /// Compares the present state with a recorded hash. Returns false when it differs.
  bool Compare(std::uint64_t recorded);

  bool diverged() const { return diverged_; }
  const Divergence& divergence() const { return divergence_; }
  /// States compared so far.
  std::int64_t compared() const { return compared_; }
  Session& session() { return *session_; }
  /// Hands the session over. Nothing else may be called afterwards.
  std::unique_ptr<Session> TakeSession() { return std::move(session_); }

 private:
  bool CompareAfter(int command, std::uint64_t recorded);

  std::shared_ptr<const Journal> journal_;
  std::unique_ptr<Session> session_;
  std::size_t next_ = 0;
  bool diverged_ = false;
  Divergence divergence_;
  std::int64_t last_equal_ = -1, compared_ = 0;
};

}  // namespace regrasp
