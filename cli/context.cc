#include "cli/context.h"

#include <langinfo.h>
#include <unistd.h>

#include <clocale>
#include <cstdlib>
#include <cstring>

#include "core/protocol/socket_path.h"

namespace regrasp::cli {
namespace {

bool WantsColor(const GlobalOptions& options) {
  if (options.json || options.csv || options.color == ColorMode::kNever) return false;
  if (options.color == ColorMode::kAlways) return true;
  const char* no_color = std::getenv("NO_COLOR");
  const char* term = std::getenv("TERM");
  if (no_color != nullptr && *no_color != '\0') return false;
  return ::isatty(STDOUT_FILENO) == 1 && term != nullptr && std::strcmp(term, "dumb") != 0;
}

bool HasUtf8() {
  std::setlocale(LC_CTYPE, "");
  return std::strcmp(::nl_langinfo(CODESET), "UTF-8") == 0;
}

Format FormatOf(const GlobalOptions& options) {
  return options.json ? Format::kJson : options.csv ? Format::kCsv : Format::kHuman;
}

}  // namespace

std::string ClientSocket(const std::string& flag) {
  const SocketPath socket = ResolveSocketPath(flag, "", SocketUse::kConnect);
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
    : options_(options), out_(FormatOf(options), WantsColor(options), HasUtf8()) {}

Client& Context::client() {
  if (!client_) client_ = std::make_unique<Client>(ClientSocket(options_.socket), timeout_s());
  return *client_;
}

}  // namespace regrasp::cli
