#pragma once

/// How the command line fails: every error is a CliError, printed in one place (main.cc).

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/protocol/errors.h"

namespace regrasp::cli {

using enum ExitCode;

/// An error with its exit code. `what()` is one line: cause, path or value; or, where much is wrong
/// with a file, a list (ProblemList::Text). `hint` is the next command to try, or empty.
class CliError : public std::runtime_error {
 public:
  CliError(ExitCode exit_code, const std::string& cause, std::string next = "", int rpc = 0)
      : std::runtime_error(cause), code(exit_code), hint(std::move(next)), rpc_code(rpc) {}
  /// One whose lines are shown as lines, as ProblemList::Text() makes them.
  static CliError List(ExitCode exit_code, const std::string& cause, std::string next) {
    CliError error(exit_code, cause, std::move(next));
    error.is_list = true;
    return error;
  }
  /// The same error with another cause and next command.
  CliError With(const std::string& cause, std::string next) const {
    CliError other(code, cause, std::move(next), rpc_code);
    other.is_list = is_list;
    return other;
  }
  ExitCode code;
  std::string hint;
  int rpc_code;                           ///< JSON-RPC error code when the daemon refused, else 0
  std::string rpc_param;                  ///< the parameter it blames, or ""
  std::vector<CliError> rpc_errors = {};  ///< where several are at fault, each by itself
  std::size_t rpc_more = 0;               ///< so many more were not told one by one
  bool is_list = false;  ///< the lines of what() are shown as lines, else the whole as one
};

/// Writes `error` to stderr: two lines of text (of a list more), or with `json` one object
/// {"error": {…}}, of a list with each by itself in `errors`.
void PrintError(const CliError& error, bool json, bool color);

/// `hint` for somebody who named the socket, "" where nobody has: its commands name it, too, but
/// for `help`.
std::string AtSocket(const std::string& hint, const std::string& socket);

/// `text` as a JSON string literal, quotes included. Invalid UTF-8 bytes become U+FFFD.
std::string JsonQuote(const std::string& text);

}  // namespace regrasp::cli
