#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "core/files/problem_list.h"

namespace regrasp {

/// Thrown by every loader of this folder. `what()` names file, element, value and what is allowed;
/// of several problems one a line, as `messages` has them.
class ModelError : public std::runtime_error {
 public:
  explicit ModelError(const std::string& message)
      : std::runtime_error(message), messages({message}) {}
  explicit ModelError(const ProblemList& list)
      : std::runtime_error(list.Text()), messages(list.Messages()) {}
  std::vector<std::string> messages;
};

}  // namespace regrasp
