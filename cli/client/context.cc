#include "cli/client/context.h"

#include <fmt/format.h>
#include <langinfo.h>
#include <unistd.h>

#include <clocale>
#include <cstdlib>
#include <cstring>
#include <sstream>

#include "cli/client/config_file.h"
#include "core/files/shell_word.h"

namespace regrasp::cli {
namespace {

bool HasUtf8() {
  std::setlocale(LC_CTYPE, "");
  return std::strcmp(::nl_langinfo(CODESET), "UTF-8") == 0;
}

Format FormatOf(const GlobalOptions& options) {
  return options.json ? Format::kJson : options.csv ? Format::kCsv : Format::kHuman;
}

/// Throws CliError(kProtocol) when the daemon speaks no protocol of ours.
void CheckProtocol(Client& client) {
  try {
    client.Call("hello", {{"protocol", {kWireVersion, kWireVersion}}});
  } catch (const CliError& error) {
    if (error.rpc_code != static_cast<int>(ErrorCode::kProtocolVersion)) throw;
    throw CliError(
        kProtocol, fmt::format("{}: {} (regrasp {})", client.path(), error.what(), REGRASP_VERSION),
        "regrasp down, then regrasp up    (with programs of one version)", error.rpc_code);
  }
}

}  // namespace

bool WantsColor(ColorMode mode, int fd) {
  if (mode != ColorMode::kAuto) return mode == ColorMode::kAlways;
  const char* no_color = std::getenv("NO_COLOR");
  const char* term = std::getenv("TERM");
  if (no_color != nullptr && *no_color != '\0') return false;
  return ::isatty(fd) == 1 && term != nullptr && std::strcmp(term, "dumb") != 0;
}

SocketPath ConnectPath(const std::string& flag) {
  const char* named = std::getenv("REGRASP_SOCKET");
  const bool decided = !flag.empty() || (named != nullptr && *named != '\0');
  return ResolveSocketPath(flag, decided ? "" : ConfiguredSocket(), SocketUse::kConnect);
}

std::string ClientSocket(const std::string& flag) {
  const SocketPath socket = ConnectPath(flag);
  // A path that was named is the user's choice; one that we found must be theirs.
  if (socket.source != "flag" && socket.source != "$REGRASP_SOCKET") {
    const std::string cause = DistrustedDirectory(socket.path);
    if (!cause.empty()) {
      throw CliError(kPermission, "will not use " + socket.path + ": " + cause,
                     "regrasp -s PATH status    (to name a socket yourself)");
    }
  }
  return socket.path;
}

Context::Context(const GlobalOptions& options)
    : options_(options),
      out_(FormatOf(options),
           FormatOf(options) == Format::kHuman && WantsColor(options.color, STDOUT_FILENO),
           HasUtf8()) {}

void Context::RefuseCsv(const Invocation& invocation) const {
  if (!options_.csv) return;
  const std::string& words = invocation.command->words;
  std::string again = "regrasp --json " + words;
  for (const Arg& arg : invocation.command->args) {
    const auto sent = invocation.params.find(arg.key);
    const bool flag = arg.kind == ArgKind::kFlag;
    if (!arg.flags.empty() && invocation.Has(arg.key))
      again += " " + arg.flags.substr(arg.flags.find("--"));
    if (invocation.Has(arg.key) && !flag) {
      std::istringstream values(invocation.Text(arg.key));  // a line for each
      for (std::string value; std::getline(values, value);) again += " " + ShellWord(value);
    } else if (arg.flags.empty() && sent != invocation.params.end()) {
      again += " " + ShellWord(Plain(*sent));
    }
  }
  throw CliError(kUsage, fmt::format("--csv: '{}' prints no table", words), again);
}

Client& Context::client() {
  if (!client_) {
    auto client = std::make_unique<Client>(ClientSocket(options_.socket), timeout_s());
    CheckProtocol(*client);
    client_ = std::move(client);
  }
  return *client_;
}

}  // namespace regrasp::cli
