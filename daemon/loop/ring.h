#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <utility>

namespace regrasp {

/// A queue of fixed size between exactly one producer thread and one consumer thread. No locks;
/// memory is taken at construction. N is a power of two.
template <typename T, std::size_t N>
class Ring {
  static_assert((N & (N - 1)) == 0);

 public:
  /// Producer. False, and nothing changed, when full.
  bool Push(const T& value) { return Put(value); }
  bool Push(T&& value) { return Put(std::move(value)); }
  /// Consumer. False when empty.
  bool Pop(T* value) {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head == tail_.load(std::memory_order_acquire)) return false;
    *value = std::move((*items_)[head % N]);
    head_.store(head + 1, std::memory_order_release);
    return true;
  }
  /// Either side; exact only for the caller's own end.
  std::size_t size() const {
    return tail_.load(std::memory_order_acquire) - head_.load(std::memory_order_acquire);
  }

 private:
  template <typename U>
  bool Put(U&& value) {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (tail - head_.load(std::memory_order_acquire) == N) return false;
    (*items_)[tail % N] = std::forward<U>(value);
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }

  std::unique_ptr<std::array<T, N>> items_ = std::make_unique<std::array<T, N>>();
  alignas(64) std::atomic<std::size_t> head_{0};
  alignas(64) std::atomic<std::size_t> tail_{0};
};

}  // namespace regrasp
