#pragma once

/// The one place where the daemon names its JSON library.

#include <nlohmann/json.hpp>

namespace regrasp {

using Json = nlohmann::ordered_json;  ///< what we write: members in the order they were added
using JsonIn = nlohmann::json;  ///< what we read: logarithmic look-up, whatever a client sends

}  // namespace regrasp
