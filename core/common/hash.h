#pragma once

/// The state hash: 64 bits over every number that can influence the future of a run. Not
/// cryptographic; two runs that differ in one bit differ in the hash with overwhelming probability.

#include <Eigen/Core>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace regrasp {

class StateHasher {
 public:
  /// Adds one number (integer, enum, bool, double), bit by bit. -0.0 and 0.0 differ.
  template <typename T>
  requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) void Add(T value) {
    std::uint64_t word = 0;
    static_assert(sizeof(T) <= sizeof(word));
    std::memcpy(&word, &value, sizeof(T));
    state_ = (state_ ^ word) * 0x9e3779b97f4a7c15ULL;
    state_ ^= state_ >> 29;
  }
  /// Adds every coefficient of a dense Eigen matrix or vector.
  template <typename Derived>
  void Add(const Eigen::MatrixBase<Derived>& matrix) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j)
      for (Eigen::Index i = 0; i < matrix.rows(); ++i) Add(static_cast<double>(matrix(i, j)));
  }
  template <typename Derived>
  void Add(const Eigen::QuaternionBase<Derived>& q) {
    Add(q.coeffs());
  }
  std::uint64_t Digest() const {
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }

 private:
  std::uint64_t state_ = 0x243f6a8885a308d3ULL;
};

}  // namespace regrasp
