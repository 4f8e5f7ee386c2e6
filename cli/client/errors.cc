#include "cli/client/errors.h"

#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string_view>

#include "core/files/json_text.h"
#include "core/files/names.h"
#include "core/files/shell_word.h"

namespace regrasp::cli {

std::string JsonQuote(const std::string& text) { return JsonText(nlohmann::json(text)); }

std::string AtSocket(const std::string& hint, const std::string& socket) {
  constexpr std::string_view kProgram = "regrasp ", kEscapedQuote = "'\\''";
  if (socket.empty()) return hint;
  std::string text;
  bool quoted = false;  // a word of ShellWord's, which is taken as it is
  for (std::size_t at = 0; at < hint.size();) {
    const std::string_view rest = std::string_view(hint).substr(at);
    const bool begins = at == 0 || hint[at - 1] == ' ' || hint[at - 1] == '(';
    std::size_t taken = quoted && rest.starts_with(kEscapedQuote) ? kEscapedQuote.size() : 1;
    if (!quoted && begins && rest.starts_with(kProgram)) taken = kProgram.size();
    if (taken == 1 && rest.front() == '\'' && (quoted || begins)) quoted = !quoted;
    text += rest.substr(0, taken);
    const std::string_view next = rest.substr(taken);
    if (taken == kProgram.size() && !next.starts_with("help") && !next.starts_with("-s "))
      text += "-s " + ShellWord(socket) + " ";
    at += taken;
  }
  return text;
}

namespace {

/// The lines of a list, each by itself; none of an error that is a single one.
std::vector<std::string> Each(const CliError& error) {
  std::vector<std::string> lines;
  std::istringstream text(error.is_list ? error.what() : "");
  for (std::string line; std::getline(text, line);)
    if (line.starts_with("  ")) lines.push_back(line.substr(2));
  return lines;
}

}  // namespace

void PrintError(const CliError& error, bool json, bool color) {
  std::string text;
  if (json) {
    text =
        fmt::format(R"({{"error":{{"exit_code":{},"message":{},"hint":{}}}}})",
                    static_cast<int>(error.code), JsonQuote(error.what()), JsonQuote(error.hint));
    if (error.rpc_code != 0) {
      text.insert(text.size() - 2, fmt::format(R"(,"code":{})", error.rpc_code));
    }
    const std::vector<std::string> errors = Each(error);
    if (!errors.empty())
      text.insert(text.size() - 2, ",\"errors\":" + JsonText(nlohmann::json(errors)));
    text += '\n';
  } else {
    text = fmt::format("{}regrasp:{} {}\n", color ? "\x1b[31m" : "", color ? "\x1b[0m" : "",
                       error.is_list ? ShownLines(error.what()) : ShownText(error.what()));
    if (!error.hint.empty()) text += fmt::format("  try: {}\n", ShownText(error.hint));
  }
  std::fwrite(text.data(), 1, text.size(), stderr);
}

}  // namespace regrasp::cli
