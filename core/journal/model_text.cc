#include "core/journal/model_text.h"

#include <concepts>
#include <utility>

#include "core/journal/model_fields.h"

namespace regrasp {
namespace {

/// Appends the bits of whatever the fields of a structure name; of texts and lists their length
/// first.
struct Bytes {
  std::string* bytes;

  template <typename T>
  void operator()(const char*, T& value) {
    Add(value);
  }

  void Raw(const void* data, std::size_t size) {
    bytes->append(static_cast<const char*>(data), size);
  }
  template <typename T>
  void Add(T& value) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
      Raw(&value, sizeof value);
    } else if constexpr (fields::Matrix<T>) {
      Add(value.size());
      Raw(value.data(), sizeof(double) * static_cast<std::size_t>(value.size()));
    } else if constexpr (std::same_as<T, Isometry3d>) {
      Raw(value.data(), sizeof(double) * 16);
    } else {
      Fields(*this, value);
    }
  }
  void Add(const Eigen::Index& size) { Raw(&size, sizeof size); }
  void Add(std::string& text) {
    Add(static_cast<Eigen::Index>(text.size()));
    Raw(text.data(), text.size());
  }
  template <typename T>
  void Add(std::vector<T>& values) {
    Add(static_cast<Eigen::Index>(values.size()));
    if constexpr (std::same_as<T, Vector3d> || std::same_as<T, Eigen::Vector3i>)
      Raw(values.data(), sizeof(T) * values.size());
    else
      for (T& value : values) Add(value);
  }
};

template <typename T>
std::string BytesOf(const T& value) {
  std::string bytes;
  Bytes{&bytes}.Add(const_cast<T&>(value));  // which only reads
  return bytes;
}

constexpr std::string_view kBefore = ",\"model\":";

}  // namespace

std::string HandBytes(const HandModel& hand) { return BytesOf(hand); }

std::string ModelJson(const LoadedScenario& model) { return fields::ToJson(model).dump(); }

const std::string& ModelText::Of(const LoadedScenario& model) {
  std::string bytes = BytesOf(model);
  if (bytes == bytes_) return text_;
  // All or nothing, also where memory ends in between.
  std::string text = ModelJson(model);
  LoadedScenario copy = model;
  copy.report = {};
  text_ = std::move(text);
  model_ = std::move(copy);
  bytes_ = std::move(bytes);
  return text_;
}

std::optional<std::string> ModelText::Without(std::string_view config) const {
  if (text_.empty() || !config.ends_with('}')) return std::nullopt;
  config.remove_suffix(1);
  if (!config.ends_with(text_)) return std::nullopt;
  config.remove_suffix(text_.size());
  // Whatever stands before, the text in this place is a value by that name, or no JSON at all.
  if (!config.ends_with(kBefore)) return std::nullopt;
  return std::string(config) + "null}";
}

}  // namespace regrasp
