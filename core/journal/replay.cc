#include "core/journal/replay.h"

#include <algorithm>

namespace regrasp {

Replay::Replay(std::shared_ptr<const Journal> journal)
    : journal_(std::move(journal)), session_(std::make_unique<Session>(journal_->config)) {}

bool Replay::RunTo(std::int64_t tick) {
  while (!diverged_ && session_->tick() < tick) {
    if (!ApplyDue()) return false;
    session_->Tick();
  }
  return !diverged_;
}

bool Replay::ApplyDue(std::size_t commands) {
  const auto& entries = journal_->entries;
  const std::size_t end = std::min(commands, entries.size());
  while (!diverged_ && next_ < end && entries[next_].tick <= session_->tick()) {
    const JournalEntry& entry = entries[next_];
    session_->Apply(entry.command);
    CompareAfter(static_cast<int>(next_++), entry.state_hash);
  }
  return !diverged_;
}

bool Replay::Compare(std::uint64_t recorded) { return CompareAfter(-1, recorded); }

bool Replay::CompareAfter(int command, std::uint64_t recorded) {
  if (diverged_) return false;
  const std::uint64_t found = session_->StateHash();
  ++compared_;
  if (found == recorded) {
    last_equal_ = session_->tick();
    return true;
  }
  diverged_ = true;
  divergence_ = {session_->tick(), last_equal_, command, recorded, found};
  return false;
}

}  // namespace regrasp
