#pragma once

/// JSON from files that somebody else may have made.

#include <nlohmann/json.hpp>
#include <string_view>

namespace regrasp {

inline constexpr int kMaxFileDepth = 32;  ///< nested arrays and objects; our files have 8

/// Parses. Throws JournalError: not JSON, not UTF-8, a NUL byte (the library would stop there
/// silently), nested more deeply than kMaxFileDepth.
nlohmann::ordered_json ParseFileJson(std::string_view text);

}  // namespace regrasp
