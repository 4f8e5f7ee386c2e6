#pragma once

#include <array>
#include <cassert>
#include <cstddef>

namespace regrasp {

/// A vector with room for N elements inside itself: no allocation, trivially copyable when T is.
template <typename T, std::size_t N>
class FixedVector {
 public:
  using value_type = T;
  /// Appends `value`. Returns false, and changes nothing, when full.
  bool push_back(const T& value) {
    if (size_ == N) return false;
    items_[size_++] = value;
    return true;
  }
  void clear() { size_ = 0; }
  /// New elements are value-initialised, those of Eigen zero. n <= N.
  void resize(std::size_t n) {
    assert(n <= N);
    for (std::size_t i = size_; i < n; ++i)
      if constexpr (requires { T::Zero(); })
        items_[i] = T::Zero();
      else
        items_[i] = T{};
    size_ = n;
  }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  bool full() const { return size_ == N; }
  static constexpr std::size_t capacity() { return N; }
  T& operator[](std::size_t i) {
    assert(i < size_);
    return items_[i];
  }
  const T& operator[](std::size_t i) const {
    assert(i < size_);
    return items_[i];
  }
  T& back() { return (*this)[size_ - 1]; }
  const T& back() const { return (*this)[size_ - 1]; }
  T* begin() { return items_.data(); }
  T* end() { return items_.data() + size_; }
  const T* begin() const { return items_.data(); }
  const T* end() const { return items_.data() + size_; }
  T* data() { return items_.data(); }
  const T* data() const { return items_.data(); }

 private:
  std::array<T, N> items_{};
  std::size_t size_ = 0;
};

}  // namespace regrasp
