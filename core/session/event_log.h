#pragma once

/// What happened, until somebody takes it.

#include <cstdio>
#include <span>

#include "core/common/fixed_vector.h"
#include "core/session/frame.h"

namespace regrasp {

class EventLog {
 public:
  static constexpr std::size_t kMaxPending = 64;

  /// Appends an event; more than kMaxPending are dropped. `format`, `args`: its sentence. Returns
  /// it, to fill in more.
  template <typename... Args>
  Event& Emit(std::int64_t tick, EventKind kind, int finger, double value, const char* format,
              Args... args) {
    Event event;
    event.tick = tick;
    event.kind = kind;
    event.finger = finger;
    event.value = value;
    std::snprintf(event.text, sizeof(event.text), format, args...);
    if (!pending_.push_back(event)) return surplus_ = event;
    return pending_.back();
  }
  /// All of them, oldest first; they are gone with the next call.
  std::span<const Event> Take() {
    taken_.clear();  // not by assignment: that copies what is not used, too
    for (const Event& event : pending_) taken_.push_back(event);
    pending_.clear();
    return {taken_.data(), taken_.size()};
  }

 private:
  FixedVector<Event, kMaxPending> pending_, taken_;
  Event surplus_;
};

}  // namespace regrasp
