#pragma once

/// What a run is made of. A session is deterministic: the same build, configuration and list of
/// (tick, command) give the same bits, so this list is the run. Run files and checkpoints are
/// journals; a state saved beside one is only the quicker way to the same place.

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/session/session.h"

namespace regrasp {

/// What is wrong with a run file or a checkpoint: file, place, what was expected.
class JournalError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A command that the session took.
struct JournalEntry {
  std::int64_t tick = 0;  ///< it was applied before this tick's step, in the order of the list
  Command command;
  std::uint64_t state_hash = 0;  ///< right after it was applied
};

/// One run, from tick 0.
struct Journal {
  SessionConfig config;
  std::vector<JournalEntry> entries;  ///< ticks never decrease
};

/// A place to go on from: the journal up to it.
struct Checkpoint {
  std::string name;
  std::int64_t tick = 0;
  std::uint64_t state_hash = 0;  ///< after every command of the journal
  std::string build;             ///< BuildIdentity() of the program that saved it
  std::string state;             ///< of the session, "holding"
  JobRecord job;                 ///< the job that was running; id 0 = none
  std::size_t commands = 0;      ///< of the journal, as the first line of the file says
  Journal journal;
  /// Of the session: ToBase64(SaveState()), see saved_state.h; empty: there is only the journal.
  std::string saved_state;
};

/// Version, commit, compiler and flags of this program: "0.1.0 a1b2c3d gcc-12.2.0 5f0e…". Equal
/// identities give equal bits; `+` after the commit: built from changed files.
std::string_view BuildIdentity();

/// 16 hex digits, as in `status`.
std::string HashText(std::uint64_t hash);
/// Throws JournalError.
std::uint64_t ParseHash(const std::string& text);

}  // namespace regrasp
