#pragma once

/// A TOML file of models, every refusal of which names file, line, key, value and what is allowed.
/// The readers gather mistakes and give harmless values; ThrowIfAny() tells them all at once. Used
/// only by the loaders.

#include <toml++/toml.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/common/frames.h"
#include "core/hand/problems.h"

namespace regrasp {

class TomlFile {
 public:
  /// Throws ModelError where the file is not valid TOML.
  explicit TomlFile(const std::filesystem::path& path);
  const toml::table& root() const { return root_; }

  template <typename... Args>
  void Add(int line, fmt::format_string<Args...> format, Args&&... args) const {
    problems_.Add(line, format, std::forward<Args>(args)...);
  }
  template <typename... Args>
  void Add(const toml::node& at, fmt::format_string<Args...> format, Args&&... args) const {
    Add(LineOf(at), format, std::forward<Args>(args)...);
  }
  /// Where a key or a value stands.
  template <typename Source>
  static int LineOf(const Source& at) {
    return static_cast<int>(at.source().begin.line);
  }
  /// What a file that this one names was refused for.
  void Add(const ModelError& error) const { problems_.Add(error); }
  std::size_t count() const { return problems_.count(); }
  void ThrowIfAny() const { problems_.ThrowIfAny(); }

  void CheckKeys(const toml::table& table, const std::vector<std::string>& allowed) const;
  /// The node of a key; nullptr and a problem where it is missing.
  const toml::node* Require(const toml::table& table, const char* key) const;
  /// A number within the range; `min` where it is none.
  double Number(const toml::node& node, std::string_view key, double min, double max) const;
  /// The same of a key that must be there.
  double Number(const toml::table& table, const char* key, double min, double max) const;
  /// A string that is not empty.
  std::string Text(const toml::table& table, const char* key) const;
  /// A table; an empty one where it is none.
  const toml::table& Table(const toml::table& table, const char* key) const;
  /// Each component within +-limit.
  Vector3d Vector(const toml::table& table, const char* key, double limit) const;
  /// true or false; false where the key is missing.
  bool Flag(const toml::table& table, const char* key) const;

 private:
  mutable Problems problems_;
  toml::table root_;
};

}  // namespace regrasp
