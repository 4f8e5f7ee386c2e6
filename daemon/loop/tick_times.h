#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>

namespace regrasp {

/// Times of ticks (how long, how late): the 99th percentile of the last kWindow. Written by the
/// control thread, whose loop reads the clock (a tick itself never does); read by any. Allocates
/// nothing.
class TickTimes {
 public:
  static constexpr std::size_t kWindow = 1024;  ///< ticks: a second of real time
  static constexpr std::size_t kEvery = 128;    ///< ticks between two looks: a look takes 10 µs

  void Add(double seconds) {
    seconds_[count_ % kWindow] = static_cast<float>(seconds);
    if (++count_ % kEvery != 0) return;
    const std::size_t filled = std::min(count_, kWindow);
    std::copy_n(seconds_.begin(), filled, sorted_.begin());
    const auto at = sorted_.begin() + static_cast<std::ptrdiff_t>(filled * 99 / 100);
    std::nth_element(sorted_.begin(), at, sorted_.begin() + static_cast<std::ptrdiff_t>(filled));
    p99_.store(*at, std::memory_order_relaxed);
  }
  /// [s]; 0 before the first kEvery ticks.
  double p99() const { return p99_.load(std::memory_order_relaxed); }

 private:
  std::array<float, kWindow> seconds_{}, sorted_{};
  std::size_t count_ = 0;
  std::atomic<double> p99_{0};
};

}  // namespace regrasp
