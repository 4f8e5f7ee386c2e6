#pragma once

/// `status` as text. Most of it stays the same until Service::changes() grows, and is written once;
/// what changes by itself (times, counts) is put in between.

#include <array>
#include <string>

#include "daemon/wire/json.h"

namespace regrasp {

class Service;

class StatusText {
 public:
  explicit StatusText(const Service& service);
  /// The members of the object as of now.
  std::string Fields(const Service& service) const;

 private:
  std::array<std::string, 3> pieces_;
};

/// What stands between the braces of an object.
std::string Members(const Json& object);

}  // namespace regrasp
