#pragma once

/// ODE ends the process when it meets a number it cannot use. These handlers turn that into an
/// exception which World::Step() catches. Used only inside core/world.

#include <exception>

namespace regrasp {

/// What ODE was about to die of.
class OdeError : public std::exception {
 public:
  explicit OdeError(const char* text);
  const char* what() const noexcept override { return text_; }

 private:
  char text_[256];
};

/// Initialises ODE once per process and once per calling thread, and installs handlers that throw
/// OdeError. Cheap after the first call of a thread. ODE itself is never closed: worlds abandoned
/// after a fault still live in it.
void EnsureOde();

}  // namespace regrasp
