#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace regrasp {

/// How deep arrays and objects of a JSON text are nested, strings skipped. Needs no well-formed
/// input: it comes before a parser that recurses.
inline int NestingDepth(std::string_view text) {
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

}  // namespace regrasp
