#pragma once

/// The parameters of one request, checked against the method table before any handler sees them.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/common/frames.h"
#include "core/protocol/methods.h"
#include "core/session/parameter_value.h"
#include "daemon/wire/json.h"
#include "daemon/wire/rpc.h"

namespace regrasp {

/// The names a source stands for at this moment.
using NameLookup = std::function<std::vector<std::string>(NameSource)>;

/// Throws RpcException: unknown parameter (with the nearest name), missing, wrong type, out of
/// range, not an allowed word. After construction every accessor's type is certain.
class Params {
 public:
  Params(const MethodSpec& method, const JsonIn& values, const NameLookup& names);

  bool Has(std::string_view name) const;
  double Number(std::string_view name, double fallback) const;
  std::int64_t Integer(std::string_view name, std::int64_t fallback) const;
  bool Bool(std::string_view name, bool fallback) const;
  std::string String(std::string_view name, const std::string& fallback = {}) const;
  Vector3d Vector(std::string_view name, const Vector3d& fallback = Vector3d::Zero()) const;
  /// A required kObject.
  const JsonIn& Object(std::string_view name) const;
  /// A kParameterValue.
  GivenValue Given(std::string_view name) const;
  std::pair<int, int> Pair(std::string_view name) const;

 private:
  const JsonIn* Find(std::string_view name) const;
  const JsonIn& values_;
};

/// True, false, a number, a word, or up to 3 numbers; anything else is not a parameter's value.
std::optional<GivenValue> ToGivenValue(const JsonIn& json);

}  // namespace regrasp
