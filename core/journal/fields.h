#pragma once

/// Both directions of JSON from one list of fields: `Fields(archive, value)` names every member
/// once; Save and Load walk the same list. Numbers keep every bit.

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/common/frames.h"
#include "core/common/limits.h"
#include "core/journal/journal.h"

namespace regrasp::fields {

using Json = nlohmann::ordered_json;

template <typename T>
Json ToJson(const T& value);
template <typename T>
void FromJson(const Json& json, T* value);

struct Save {
  Json json = Json::object();
  template <typename T>
  void operator()(const char* key, const T& value) {
    json[key] = ToJson(value);
  }
};

struct Load {
  const Json& json;
  template <typename T>
  void operator()(const char* key, T& value) {
    const auto found = json.find(key);
    if (found == json.end()) throw JournalError(std::string(key) + " is missing");
    try {
      FromJson(*found, &value);
    } catch (const JournalError& e) {
      throw JournalError(std::string(key) + ": " + e.what());
    } catch (const nlohmann::json::exception&) {
      throw JournalError(std::string(key) + " is of another kind than expected");
    }
  }
};

// How single values look.
template <typename T>
concept Plain = std::is_arithmetic_v<T> || std::is_same_v<T, std::string>;
template <typename T>
concept Enumeration = std::is_enum_v<T>;
template <typename T>
concept Matrix = std::is_base_of_v<Eigen::MatrixBase<T>, T>;

template <typename T>
struct Value {  // a structure
  static Json To(const T& value) {
    Save save;
    Fields(save, const_cast<T&>(value));  // Save only reads
    return std::move(save.json);
  }
  static void From(const Json& json, T* value) {
    Load load{json};
    Fields(load, *value);
  }
};
template <Plain T>
struct Value<T> {
  static Json To(const T& value) { return value; }
  static void From(const Json& json, T* value) {
    // The library would cut or round what does not fit.
    if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>) {
      if (!json.is_number_integer()) throw JournalError("an integer is expected");
      const bool fits = json.is_number_unsigned() ? std::in_range<T>(json.get<std::uint64_t>())
                                                  : std::in_range<T>(json.get<std::int64_t>());
      if (!fits) throw JournalError("an integer is out of range");
    } else if constexpr (std::is_floating_point_v<T>) {
      if (!json.is_number()) throw JournalError("a number is expected");
    }
    *value = json.get<T>();
  }
};
template <Enumeration T>
struct Value<T> {
  static Json To(const T& value) { return static_cast<int>(value); }
  static void From(const Json& json, T* value) {
    int number = 0;
    FromJson(json, &number);
    *value = static_cast<T>(number);
    if (static_cast<int>(*value) != number) throw JournalError("a choice is out of range");
  }
};
template <Matrix T>
struct Value<T> {  // row by row; a vector of free length takes the length it finds
  static Json To(const T& value) {
    Json json = Json::array();
    for (Eigen::Index i = 0; i < value.rows(); ++i)
      for (Eigen::Index j = 0; j < value.cols(); ++j) json.push_back(value(i, j));
    return json;
  }
  static void From(const Json& json, T* value) {
    const auto size = static_cast<Eigen::Index>(json.size());
    if constexpr (T::RowsAtCompileTime == Eigen::Dynamic) {
      if (size > T::MaxRowsAtCompileTime) throw JournalError("a vector has too many numbers");
      value->resize(size);
    }
    if (size != value->size()) throw JournalError("a vector has the wrong number of numbers");
    if (!json.is_array()) throw JournalError("a list of numbers is expected");
    for (Eigen::Index i = 0; i < size; ++i)
      FromJson(json[static_cast<std::size_t>(i)], &(*value)(i / value->cols(), i % value->cols()));
  }
};
template <>
struct Value<Isometry3d> {  // the upper three rows
  static Json To(const Isometry3d& X) {
    return Value<Eigen::Matrix<double, 3, 4>>::To(X.matrix().topRows<3>());
  }
  static void From(const Json& json, Isometry3d* X) {
    Eigen::Matrix<double, 3, 4> rows;
    Value<Eigen::Matrix<double, 3, 4>>::From(json, &rows);
    X->setIdentity();
    X->matrix().topRows<3>() = rows;
  }
};
template <typename T>
struct Value<std::vector<T>> {
  static Json To(const std::vector<T>& values) {
    Json json = Json::array();
    for (const T& value : values) json.push_back(ToJson(value));
    return json;
  }
  static void From(const Json& json, std::vector<T>* values) {
    values->clear();
    if (!json.is_array()) throw JournalError("a list is expected");
    for (const Json& item : json) FromJson(item, &values->emplace_back());
  }
};

/// Vectors of one length one after another: readers of run files take no lists in lists. Former
/// versions wrote them so.
template <typename Scalar, int n>
struct Value<std::vector<Eigen::Matrix<Scalar, n, 1>>> {
  using Vector = Eigen::Matrix<Scalar, n, 1>;
  static Json To(const std::vector<Vector>& values) {
    Json json = Json::array();
    for (const Vector& value : values)
      for (int i = 0; i < n; ++i) json.push_back(value[i]);
    return json;
  }
  static void From(const Json& json, std::vector<Vector>* values) {
    if (!json.is_array()) throw JournalError("a list is expected");
    values->clear();
    if (!json.empty() && json.front().is_array()) {
      for (const Json& item : json) FromJson(item, &values->emplace_back());
      return;
    }
    if (json.size() % n != 0) throw JournalError("a list has the wrong number of numbers");
    values->resize(json.size() / n);
    for (std::size_t i = 0; i < json.size(); ++i)
      FromJson(json[i], &(*values)[i / n][static_cast<Eigen::Index>(i % n)]);
  }
};

template <typename T>
Json ToJson(const T& value) {
  return Value<T>::To(value);
}
template <typename T>
void FromJson(const Json& json, T* value) {
  Value<T>::From(json, value);
}

}  // namespace regrasp::fields
