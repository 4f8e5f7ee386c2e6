#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include "core/files/problem_list.h"

namespace regrasp {

/// Thrown by every loader of this folder. `what()` names file, element, value and what is allowed;
/// of several problems one a line (ProblemList::Text).
class ModelError : public std::runtime_error {
 public:
  explicit ModelError(const std::string& message) : ModelError(ProblemList(message)) {}
  explicit ModelError(ProblemList list)
      : std::runtime_error(list.Text()), problems(std::move(list)) {}
  /// All that is wrong is that a model's own file, or its directory, is not there.
  static ModelError NoModel(const std::string& message) {
    ModelError error(message);
    error.names_no_model = true;
    return error;
  }
  ProblemList problems;
  bool names_no_model = false;
};

}  // namespace regrasp
