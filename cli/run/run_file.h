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
  /// A state to go on from; what it must be like at that moment.
  struct Saved {
    std::int64_t tick = 0;
    std::size_t commands = 0;
    std::uint64_t hash = 0;
    std::uint64_t digest = 0;  ///< DigestOf() its bytes
  };
  std::vector<Saved> saved;     ///< in order of ticks
  std::uint64_t offset_ns = 0;  ///< of its tick 0 in the file's time
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
/// Only configurations and commands, which leaves most of a whole file unread. `chunks`: its index.
RunFile ReadJournals(const std::string& path, std::vector<McapChunk>* chunks);

/// A message of the topic `state`. Throws JournalError.
Segment::State ParseState(std::string_view text, int* segment);
/// 64 bits over all bytes of a saved state.
std::uint64_t DigestOf(std::string_view bytes);

}  // namespace regrasp::run
