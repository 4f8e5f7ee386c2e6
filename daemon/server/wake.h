#pragma once

#include <atomic>
#include <chrono>
#include <optional>

namespace regrasp {

/// Wakes one sleeping thread from another: an eventfd that is written at most once per sleep.
class Wake {
 public:
  /// Throws std::system_error when the system has no descriptor left.
  Wake();
  ~Wake();
  Wake(const Wake&) = delete;
  Wake& operator=(const Wake&) = delete;

  /// Any thread; never blocks.
  void Notify();
  /// The sleeper: returns after a Notify() since the last Clear(), or at `until` (never, when
  /// empty).
  void WaitUntil(std::optional<std::chrono::steady_clock::time_point> until);
  /// The sleeper, before it looks for work: everything posted before the next Notify() will be
  /// seen.
  void Clear();
  /// For an event loop that polls: readable while notified.
  int fd() const { return fd_; }

 private:
  int fd_ = -1;
  std::atomic<bool> notified_{false};
};

}  // namespace regrasp
