#include "core/journal/checked_json.h"

#include <algorithm>
#include <string>

#include "core/journal/journal.h"

namespace regrasp {
namespace {

/// Deepest nesting, strings skipped. Needs no well-formed text.
int Depth(std::string_view text) {
  int depth = 0, deepest = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '{' || c == '[') {
      deepest = std::max(deepest, ++depth);
    } else if (c == '}' || c == ']') {
      --depth;
    }
  }
  return deepest;
}

}  // namespace

nlohmann::ordered_json ParseFileJson(std::string_view text) {
  if (const auto nul = text.find('\0'); nul != std::string_view::npos)
    throw JournalError("a NUL byte at position " + std::to_string(nul));
  if (Depth(text) > kMaxFileDepth)
    throw JournalError("nested more than " + std::to_string(kMaxFileDepth) + " levels deep");
  try {
    return nlohmann::ordered_json::parse(text);
  } catch (const nlohmann::json::exception& e) {
    throw JournalError(std::string("not JSON: ") + e.what());
  }
}

}  // namespace regrasp
