#pragma once

/// `status` as text. Most of it stays the same until a new frame comes in or something is accepted,
/// and is written once; what changes by itself (times, counts) is put in between.

#include <array>
#include <string>

#include "daemon/wire/json.h"

namespace regrasp {

class Service;

class StatusText {
 public:
  /// What was written is of the past.
  void Forget() { pieces_[0].clear(); }
  bool known() const { return !pieces_[0].empty(); }
  void Write(const Service& service);
  /// The members of the object as of now; Write() has been called.
  std::string Fields(const Service& service) const;

 private:
  std::array<std::string, 3> pieces_;
};

/// What stands between the braces of an object.
std::string Members(const Json& object);

}  // namespace regrasp
