#pragma once

/// A set of fingers of one hand.

#include <bit>
#include <cstdint>
#include <initializer_list>

#include "core/common/limits.h"

namespace regrasp {

/// Fingers by their index in HandModel::fingers, in 0 .. kMaxFingers - 1. Iteration goes in order
/// of the index. A negative index means "no finger": it is in no set, and adding or removing it
/// changes nothing.
class FingerSet {
 public:
  class Iterator {
   public:
    constexpr explicit Iterator(std::uint32_t bits) : bits_(bits) {}
    constexpr int operator*() const { return std::countr_zero(bits_); }
    constexpr Iterator& operator++() {
      bits_ &= bits_ - 1;
      return *this;
    }
    constexpr bool operator==(const Iterator&) const = default;

   private:
    std::uint32_t bits_;  // of the fingers that are still to come
  };

  constexpr FingerSet() = default;
  constexpr FingerSet(std::initializer_list<int> fingers) {
    for (int finger : fingers) bits_ |= Bit(finger);
  }
  /// The first `n` fingers, n in 0 .. kMaxFingers.
  static constexpr FingerSet First(int n) {
    FingerSet set;
    set.bits_ = Bit(n) - 1;
    return set;
  }

  constexpr bool contains(int finger) const { return (bits_ & Bit(finger)) != 0; }
  constexpr bool empty() const { return bits_ == 0; }
  constexpr int size() const { return std::popcount(bits_); }
  constexpr FingerSet with(int finger) const {
    FingerSet set = *this;
    set.bits_ |= Bit(finger);
    return set;
  }
  constexpr FingerSet without(int finger) const {
    FingerSet set = *this;
    set.bits_ &= ~Bit(finger);
    return set;
  }
  constexpr void add(int finger) { *this = with(finger); }
  constexpr void remove(int finger) { *this = without(finger); }
  constexpr Iterator begin() const { return Iterator(bits_); }
  constexpr Iterator end() const { return Iterator(0); }
  constexpr bool operator==(const FingerSet&) const = default;
  /// Bit i set: finger i is in the set.
  constexpr std::uint32_t bits() const { return bits_; }
  template <typename V>
  void Fields(V& v) {
    v("bits", bits_, v.FingerBits());
  }

 private:
  static constexpr std::uint32_t Bit(int finger) {
    return finger < 0 ? 0 : std::uint32_t{1} << finger;
  }
  std::uint32_t bits_ = 0;
};
static_assert(kMaxFingers < 32);

}  // namespace regrasp
