#pragma once

/// What every command gets: the global options, stdout, and the daemon once it is asked for.

#include <memory>
#include <string>
#include <vector>

#include "cli/client/errors.h"
#include "cli/grammar/grammar.h"
#include "cli/print/print.h"
#include "core/protocol/socket_path.h"

namespace regrasp::cli {

class Context {
 public:
  explicit Context(const GlobalOptions& options);

  const GlobalOptions& options() const { return options_; }
  Output& out() { return out_; }
  /// Seconds to wait for one answer.
  double timeout_s() const { return options_.timeout_s.value_or(10.0); }

  /// Of a helper program's command line: what of it every command has. The hints of the helper name
  /// the socket.
  void AddCommon(std::vector<std::string>* words) const {
    if (out_.format() == Format::kJson) words->push_back("--json");
    if (options_.quiet) words->push_back("--quiet");
    if (!options_.socket.empty()) words->insert(words->end(), {"--socket", options_.socket});
  }

  /// What may come next, behind a line of an answer: "    (regrasp record stop)".
  std::string Next(const std::string& command) const {
    return "    (" + AtSocket(command, options_.socket) + ")";
  }

  /// Throws CliError(kUsage) with --csv, for a command that has no table to print.
  void RefuseCsv(const Invocation& invocation) const;

  /// The connection; made at the first call. Throws CliError(kNoDaemon, kPermission, kTimeout).
  Client& client();
  /// Gives the connection up: the next call makes another.
  void Disconnect() { client_.reset(); }
  /// Calls the method of `invocation` with its parameters.
  Json Call(const Invocation& invocation) {
    return client().Call(std::string(invocation.command->method->name), invocation.params);
  }
  /// Prints `answer`: as JSON or CSV when that is asked for, else with `human`.
  template <typename Human>
  void Print(const Json& answer, Human human) {
    if (options_.quiet) return;
    if (out_.format() == Format::kJson) {
      out_.AddJson(answer);
    } else if (out_.format() == Format::kCsv) {
      out_.AddCsv(answer);
    } else {
      human();
    }
  }
  /// Prints a table: JSON gets `answer`, CSV one line for each of `rows`, people what `human`
  /// writes.
  template <typename Human>
  void PrintRows(const Json& answer, const std::vector<Json>& rows, Human human) {
    if (!options_.quiet && out_.format() == Format::kCsv) {
      out_.AddCsv(rows);
    } else {
      Print(answer, human);
    }
  }

 private:
  GlobalOptions options_;
  Output out_;
  std::unique_ptr<Client> client_;
};

/// Whether what is written to the descriptor is coloured: --color, else NO_COLOR, else a terminal
/// that can.
bool WantsColor(ColorMode mode, int fd);
/// Where a client looks for the daemon, by the rule of core/protocol/socket_path.h.
SocketPath ConnectPath(const std::string& flag);
/// The socket a client connects to, by the rule of core/protocol/socket_path.h. Throws
/// CliError(kPermission) when its directory is somebody else's.
std::string ClientSocket(const std::string& flag);

}  // namespace regrasp::cli
