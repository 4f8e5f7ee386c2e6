#include "core/hand/toml_file.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "core/common/nearest_name.h"
#include "core/files/toml_text.h"

namespace regrasp {
TomlFile::TomlFile(const std::filesystem::path& path) : problems_(path.string()) {
  try {
    root_ = toml::parse(ReadTomlText(path.string()));
  } catch (const toml::parse_error& error) {
    throw ModelError(fmt::format("{}:{}: not valid TOML: {}", path.string(),
                                 error.source().begin.line, error.description()));
  } catch (const std::runtime_error& error) {
    throw ModelError(error.what());
  }
}

void TomlFile::CheckKeys(const toml::table& table, const std::vector<std::string>& allowed) const {
  for (const auto& [key, value] : table) {
    if (std::ranges::find(allowed, key.str()) != allowed.end()) continue;
    const std::string name(key.str().substr(0, 64));
    Add(LineOf(key), "unknown key \"{}\"{}; allowed are {}", name, OrNearest(name, allowed),
        fmt::join(allowed, ", "));
  }
}

const toml::node* TomlFile::Require(const toml::table& table, const char* key) const {
  const toml::node* node = table.get(key);
  if (node == nullptr) Add(table, "key \"{}\" is missing", key);
  return node;
}

double TomlFile::Number(const toml::node& node, std::string_view key, double min,
                        double max) const {
  const auto value = node.is_number() ? node.value<double>() : std::nullopt;
  if (!value)
    Add(node, "{} must be a number", key);
  else if (!(*value >= min && *value <= max))
    Add(node, "{} = {:.6g}; allowed {:.6g} .. {:.6g}", key, *value, min, max);
  else
    return *value;
  return min;
}

double TomlFile::Number(const toml::table& table, const char* key, double min, double max) const {
  const toml::node* node = Require(table, key);
  return node == nullptr ? min : Number(*node, key, min, max);
}

std::string TomlFile::Text(const toml::table& table, const char* key) const {
  const toml::node* node = Require(table, key);
  if (node == nullptr) return "";
  const auto value = node->value_exact<std::string>();
  if (value && !value->empty()) return *value;
  Add(*node, "{} must be a string that is not empty", key);
  return "";
}

const toml::table& TomlFile::Table(const toml::table& table, const char* key) const {
  static const toml::table kEmpty;
  const toml::node* node = Require(table, key);
  if (node == nullptr) return kEmpty;
  if (node->is_table()) return *node->as_table();
  Add(*node, "{} must be a table", key);
  return kEmpty;
}

Vector3d TomlFile::Vector(const toml::table& table, const char* key, double limit) const {
  Vector3d v = Vector3d::Zero();
  const toml::node* node = Require(table, key);
  if (node == nullptr) return v;
  const toml::array* array = node->as_array();
  if (array == nullptr || array->size() != 3) {
    Add(*node, "{} must be an array of 3 numbers", key);
    return v;
  }
  for (int i = 0; i < 3; ++i)
    v[i] = Number(*array->get(static_cast<std::size_t>(i)), key, -limit, limit);
  return v;
}

bool TomlFile::Flag(const toml::table& table, const char* key) const {
  const toml::node* node = table.get(key);
  if (node == nullptr) return false;
  const auto value = node->value_exact<bool>();
  if (!value) Add(*node, "{} must be true or false", key);
  return value.value_or(false);
}

}  // namespace regrasp
