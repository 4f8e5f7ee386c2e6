#pragma once

#include <stdexcept>

namespace regrasp {

/// Thrown by every loader of this folder. `what()` names file, element, value and what is allowed.
class ModelError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace regrasp
