#pragma once

/// What is wrong with a file, gathered so that its reader hears of everything at once; and what is
/// only worth telling.

#include <fmt/format.h>

#include <string>
#include <vector>

#include "core/hand/model_error.h"

namespace regrasp {

struct ModelReport;

class Problems {
 public:
  /// `report`: where warnings go, if anywhere.
  explicit Problems(std::string file, ModelReport* report = nullptr)
      : file_(std::move(file)), report_(report) {}

  /// "FILE:LINE: message"; without a line (0) "FILE: message".
  template <typename... Args>
  void Add(int line, fmt::format_string<Args...> format, Args&&... args) {
    AddText(line, fmt::format(format, std::forward<Args>(args)...));
  }
  void AddText(int line, const std::string& message);
  /// A message that names its file itself.
  void AddWhole(const std::string& message) { Keep(message); }
  /// A ModelWarning, which refuses nothing.
  void Warn(int line, std::string element, std::string text);

  const std::string& file() const { return file_; }
  bool empty() const { return count_ == 0; }
  std::size_t count() const { return count_; }
  /// Throws a ModelError that holds every message, one a line, where there is any; as it may be
  /// shown to people (ShownText).
  void ThrowIfAny() const;

 private:
  void Keep(const std::string& message);

  std::string file_;
  ModelReport* report_;
  std::vector<std::string> messages_;
  std::size_t count_ = 0;
};

}  // namespace regrasp
