#pragma once

/// A run file as a replay needs it: per segment the journal and the state hashes on the way.

#include <memory>
#include <string>
#include <vector>

#include "core/journal/journal.h"
#include "core/mcap/mcap_reader.h"

namespace regrasp::run {

struct Segment {
  std::shared_ptr<Journal> journal = std::make_shared<Journal>();
  std::string build;  ///< that recorded it
  struct State {
    std::int64_t tick = 0;
    std::size_t commands = 0;  ///< of the journal, applied before it
    std::uint64_t hash = 0;
  };
  std::vector<State> states;  ///< in order of ticks
  /// The last tick the file knows of.
  std::int64_t last_tick() const;
};

struct RunFile {
  std::vector<Segment> segments;
  bool complete = false;  ///< false: its writer was killed
  std::uint64_t messages = 0;
  std::vector<McapLoss> lost;  ///< what could not be read
};

/// Of a damaged file, what leads without a gap from the beginning of each segment. Throws
/// McapError, JournalError (which name file and place).
RunFile ReadRunFile(const std::string& path);

}  // namespace regrasp::run
