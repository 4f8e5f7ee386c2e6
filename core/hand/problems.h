#pragma once

/// What is wrong with a file of a model, gathered so that its reader hears of everything at once;
/// and what is only worth telling.

#include <fmt/format.h>

#include <string>

#include "core/files/problem_list.h"
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
  /// What another file was refused for; its messages name their file themselves.
  void Add(const ModelError& error);
  /// A ModelWarning, which refuses nothing.
  void Warn(int line, std::string element, std::string text);

  const std::string& file() const { return file_; }
  bool empty() const { return list_.empty(); }
  std::size_t count() const { return list_.count(); }
  /// Throws a ModelError with every problem, where there is any.
  void ThrowIfAny() const;

 private:
  std::string file_;
  ModelReport* report_;
  ProblemList list_;
  bool names_no_model_ = false;  ///< all that is here is one such error
};

}  // namespace regrasp
