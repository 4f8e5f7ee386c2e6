#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>

namespace regrasp {

/// `--speed max`: no pacing.
inline constexpr double kMaxSpeed = std::numeric_limits<double>::infinity();

/// When the next tick is due. Simulated time keeps up with `speed` times the wall clock; after a
/// stall of more than 50 ms the lost time is given up rather than caught up in a burst.
class Pacing {
 public:
  using Clock = std::chrono::steady_clock;
  /// dt: simulated seconds per tick; speed > 0, or kMaxSpeed.
  Pacing(double dt, double speed) : period_(std::isinf(speed) ? 0 : dt / speed) {}

  /// Starts afresh at `now`: after a pause, a reset, at the beginning.
  void Restart(Clock::time_point now) {
    start_ = now;
    ticks_ = 0;
  }
  /// Due time of the next tick; empty when it is due at once.
  std::optional<Clock::time_point> Due(Clock::time_point now) {
    if (period_ == 0) return {};
    const auto due =
        start_ + std::chrono::duration_cast<Clock::duration>(
                     std::chrono::duration<double>(static_cast<double>(ticks_) * period_));
    if (now >= due) {
      if (now - due > std::chrono::milliseconds(50)) Restart(now);
      return {};
    }
    return due;
  }
  /// How long after its due time the next tick would begin now [s]; 0 without pacing.
  double Lateness(Clock::time_point now) const {
    if (period_ == 0) return 0;
    const double elapsed = std::chrono::duration<double>(now - start_).count();
    return std::max(0.0, elapsed - static_cast<double>(ticks_) * period_);
  }
  void Ticked() { ++ticks_; }

 private:
  double period_;
  Clock::time_point start_{};
  long long ticks_ = 0;
};

}  // namespace regrasp
