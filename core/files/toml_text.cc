#include "core/files/toml_text.h"

#include <algorithm>
#include <stdexcept>

#include "core/files/read_file.h"

namespace regrasp {
namespace {

constexpr int kMaxDepth = 32;

/// Where the string ends that begins at `at`.
std::size_t EndOfString(std::string_view text, std::size_t at) {
  const char quote = text[at];
  const std::string quotes(text.substr(at).starts_with(std::string(3, quote)) ? 3 : 1, quote);
  for (at += quotes.size(); at < text.size(); ++at) {
    if (text[at] == '\\' && quote == '"') {
      ++at;
    } else if (text.substr(at).starts_with(quotes)) {
      // Three quotes may end a string that itself ends in one or two.
      at += quotes.size();
      for (int k = 0; quotes.size() == 3 && k < 2 && at < text.size() && text[at] == quote; ++k)
        ++at;
      return at;
    } else if (text[at] == '\n' && quotes.size() == 1) {
      return at;  // the parser will say that it does not end
    }
  }
  return text.size();
}

bool TooDeep(std::string_view text) {
  int brackets = 0, dots = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    if (c == '"' || c == '\'') {
      at = EndOfString(text, at) - 1;
      continue;
    }
    if (c == '#') {
      at = std::min(text.find('\n', at), text.size());
      dots = 0;
      continue;
    }
    if (c == '[' || c == '{') ++brackets;
    if (c == ']' || c == '}') --brackets;
    if (c == '.') ++dots;
    if (c == '\n' || c == '=' || c == ',' || c == '[' || c == '{') dots = 0;
    if (brackets > kMaxDepth || dots > kMaxDepth) return true;
  }
  return false;
}

}  // namespace

std::string TomlFault(std::string_view text) {
  if (text.find('\0') != std::string_view::npos) return "the file holds a zero byte";
  return TooDeep(text) ? "nested deeper than " + std::to_string(kMaxDepth) : "";
}

std::string ReadTomlText(const std::string& path) {
  if (path == "/dev/null") return "";  // "no file", as one says it
  constexpr std::uint64_t kMaxBytes = 1 << 20;
  std::string text = ReadRegularFile(path, kMaxBytes);
  if (const std::string fault = TomlFault(text); !fault.empty())
    throw std::runtime_error(path + ": not valid TOML: " + fault);
  return text;
}

}  // namespace regrasp
