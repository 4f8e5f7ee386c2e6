#pragma once

/// Where the socket is: one rule for both programs.

#include <string>

namespace regrasp {

enum class SocketUse {
  kListen,   ///< the daemon: a place where the socket can be made
  kConnect,  ///< a client: a place where a socket is, if there is one
};

struct SocketPath {
  std::string path;
  std::string source;  ///< where the path comes from: "flag", "$REGRASP_SOCKET", "config", ...
};

/// `flag` (-s, --socket), else $REGRASP_SOCKET, else `config` (from the configuration file), else
/// $XDG_RUNTIME_DIR/regrasp/regrasp.sock, else /run/regrasp/regrasp.sock, else
/// /tmp/regrasp-$UID/regrasp.sock; empty strings count as not given. Of the last three, kListen
/// takes the first whose directory exists or can be made by this user, kConnect the first at which
/// there is a socket (the first kListen would take, when there is none).
SocketPath ResolveSocketPath(const std::string& flag, const std::string& config, SocketUse use);

/// The cause, one line, why the directory of `path` must not be trusted: it belongs to someone else
/// (root excepted), or others may write to it. Empty when all is well or the directory is missing.
std::string DistrustedDirectory(const std::string& path);

}  // namespace regrasp
