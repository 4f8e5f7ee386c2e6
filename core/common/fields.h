#pragma once

/// One list of fields per class: what the state hash covers is what a saved state holds.
///
///   class Filter {
///    public:
///     template <typename V>
///     void Fields(V& v) {
///       v("ticks", ticks_);                     // a count: 0 or more
///       v("phase", phase_, Phase::kDone);       // an enumeration: up to its last value
///       v("finger", finger_, v.Finger());       // an index of a finger, or -1
///       v("value_m", value_m_);                 // a number, vector, array, structure with fields
///     }
///
/// Every member that can influence what comes later is named once, in any order that stays.
/// Visitors: FieldHasher, FieldSaver, FieldLoader, which checks every number it reads.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>

#include "core/common/fixed_vector.h"
#include "core/common/hash.h"

namespace regrasp {

/// What a number may be, inclusive.
struct FieldRange {
  double min, max;
};
/// Any number but NaN.
inline constexpr FieldRange kUnbounded{-std::numeric_limits<double>::infinity(),
                                       std::numeric_limits<double>::infinity()};
/// -1 or a count.
inline constexpr FieldRange kCountOrNone{-1, 9e15};

/// What is wrong with a saved state: the field, its value, what is allowed.
class StateError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

namespace field_walk {

template <typename T>
concept Number = std::is_arithmetic_v<T>;
template <typename T>
concept Enumeration = std::is_enum_v<T>;
template <typename T>
concept Dense = std::is_base_of_v<Eigen::MatrixBase<T>, T>;

/// What a number may be where its field does not say: a flag, a count, any word of 64 bits, a
/// finite number of a size that physics can have.
template <Number T>
constexpr FieldRange DefaultRange() {
  if constexpr (std::is_same_v<T, bool>) return {0, 1};
  if constexpr (std::is_floating_point_v<T>) return {-1e9, 1e9};
  return {0, static_cast<double>(std::numeric_limits<T>::max())};
}

/// Walks every kind of field down to numbers; `Visitor` does something with each of those.
template <typename Visitor>
class Walk {
 public:
  explicit Walk(int num_fingers) : num_fingers_(num_fingers) {}

  template <Number T>
  void operator()(const char* name, T& value, FieldRange range = DefaultRange<T>()) {
    self().Visit(name, value, range);
  }
  template <Enumeration T>
  void operator()(const char* name, T& value, T last) {
    using Raw = std::underlying_type_t<T>;
    Raw raw = static_cast<Raw>(value);
    self().Visit(name, raw, FieldRange{0, static_cast<double>(last)});
    value = static_cast<T>(raw);
  }
  /// Fixed size, or a vector of free length up to its room.
  template <Dense T>
  void operator()(const char* name, T& matrix,
                  FieldRange range = DefaultRange<typename T::Scalar>()) {
    self().Enter(name);
    if constexpr (T::RowsAtCompileTime == Eigen::Dynamic) {
      auto rows = static_cast<std::int32_t>(matrix.rows());
      self().Visit("size", rows, FieldRange{0, static_cast<double>(T::MaxRowsAtCompileTime)});
      if (rows != matrix.rows()) matrix.resize(rows);
    }
    for (Eigen::Index j = 0; j < matrix.cols(); ++j)
      for (Eigen::Index i = 0; i < matrix.rows(); ++i) self().Visit("", matrix(i, j), range);
    self().Leave();
  }
  void operator()(const char* name, Eigen::Quaterniond& q) {
    (*this)(name, q.coeffs(), FieldRange{-1.000001, 1.000001});
  }
  template <typename T, std::size_t n, typename... Limits>
  void operator()(const char* name, std::array<T, n>& values, Limits... limits) {
    Each(name, values.data(), n, limits...);
  }
  template <typename T, std::size_t n, typename... Limits>
  void operator()(const char* name, FixedVector<T, n>& values, Limits... limits) {
    auto size = static_cast<std::int32_t>(values.size());
    self().Enter(name);
    self().Visit("size", size, FieldRange{0, static_cast<double>(n)});
    self().Leave();
    values.resize(static_cast<std::size_t>(size));
    Each(name, values.data(), values.size(), limits...);
  }
  /// Text that ends with 0.
  template <std::size_t n>
  void operator()(const char* name, char (&text)[n]) {
    self().Enter(name);
    text[n - 1] = 0;
    for (char& c : text) {
      self().Visit("", c, FieldRange{-128, 127});
      if (c == 0) break;
    }
    self().Leave();
  }
  /// A structure with fields of its own.
  template <typename T>
  requires(std::is_class_v<T> && !Dense<T>) void operator()(const char* name, T& structure) {
    self().Enter(name);
    structure.Fields(self());
    self().Leave();
  }

  // Ranges that depend on the hand.
  FieldRange Finger() const { return {-1, num_fingers_ - 1.0}; }  ///< index, or -1
  FieldRange FingerBits() const { return {0, std::exp2(num_fingers_) - 1}; }

  /// What follows from others is made anew after it was loaded: if constexpr (V::kLoads) ...
  /// A name, not a number that acts, is not hashed: if constexpr (!V::kHashes) ...

 protected:
  void Enter(const char*) {}
  void Leave() {}

 private:
  Visitor& self() { return static_cast<Visitor&>(*this); }
  template <typename T, typename... Limits>
  void Each(const char* name, T* values, std::size_t n, Limits... limits) {
    for (std::size_t i = 0; i < n; ++i) (*this)(name, values[i], limits...);
  }

  int num_fingers_;
};

}  // namespace field_walk

/// Feeds every field to a StateHasher.
class FieldHasher : public field_walk::Walk<FieldHasher> {
 public:
  static constexpr bool kHashes = true, kLoads = false, kWrites = false;
  explicit FieldHasher(StateHasher* hasher) : Walk(0), hasher_(hasher) {}

  template <typename T>
  void Visit(const char*, T& value, FieldRange) {
    hasher_->Add(value);
  }

 private:
  friend class field_walk::Walk<FieldHasher>;
  StateHasher* hasher_;
};

/// Appends every field to a buffer.
class FieldSaver : public field_walk::Walk<FieldSaver> {
 public:
  static constexpr bool kHashes = false, kLoads = false, kWrites = false;
  explicit FieldSaver(std::string* out) : Walk(0), out_(out) {}

  template <typename T>
  void Visit(const char*, T& value, FieldRange) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    out_->append(bytes, sizeof(T));
  }

 private:
  friend class field_walk::Walk<FieldSaver>;
  std::string* out_;
};

/// Reads every field from what FieldSaver wrote. Throws StateError, with the way to the field, at
/// the first number that is not allowed; what was loaded until then must be thrown away.
class FieldLoader : public field_walk::Walk<FieldLoader> {
 public:
  static constexpr bool kHashes = false, kLoads = true, kWrites = true;
  FieldLoader(std::string_view bytes, int num_fingers) : Walk(num_fingers), bytes_(bytes) {}

  template <typename T>
  void Visit(const char* name, T& value, FieldRange range) {
    if (bytes_.size() < sizeof(T)) Refuse(name, "is missing: the state ends too early");
    T read;
    if constexpr (std::is_same_v<T, bool>) {
      const auto byte = static_cast<unsigned char>(bytes_.front());
      if (byte > 1) Refuse(name, "is " + std::to_string(byte) + ", allowed: 0 or 1");
      read = byte == 1;
    } else {
      std::memcpy(&read, bytes_.data(), sizeof(T));
      const auto number = static_cast<double>(read);
      if (!(number >= range.min && number <= range.max)) RefuseNumber(name, number, range);
    }
    bytes_.remove_prefix(sizeof(T));
    value = read;
  }
  std::string_view rest() const { return bytes_; }  ///< not read yet
  /// Nothing may be left when all is read.
  void Finish() {
    if (!bytes_.empty()) Refuse("", std::to_string(bytes_.size()) + " bytes too many");
  }
  [[noreturn]] void Refuse(const char* name, const std::string& what) const {
    std::string path;
    for (std::size_t i = 0; i < std::min(depth_, kDepth); ++i) (path += path_[i]) += '.';
    path += name;
    while (path.ends_with('.')) path.pop_back();
    throw StateError("saved state: " + (path.empty() ? what : path + " " + what));
  }

 private:
  friend class field_walk::Walk<FieldLoader>;
  static constexpr std::size_t kDepth = 16;
  void Enter(const char* name) { path_[depth_++ % kDepth] = name; }
  void Leave() { --depth_; }
  [[noreturn]] void RefuseNumber(const char* name, double number, FieldRange range) const {
    char text[120];
    std::snprintf(text, sizeof(text), "is %g, allowed: %g to %g", number, range.min, range.max);
    Refuse(name, text);
  }

  std::string_view bytes_;
  std::array<const char*, kDepth> path_{};
  std::size_t depth_ = 0;
};

/// Adds all fields of `object` to the hash.
template <typename T>
void HashFields(const T& object, StateHasher* hasher) {
  FieldHasher visitor(hasher);
  const_cast<T&>(object).Fields(visitor);  // only reads
}

}  // namespace regrasp
