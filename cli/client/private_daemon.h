#pragma once

#include <string>
#include <vector>

#include "cli/client/daemon_process.h"
#include "cli/client/private_directory.h"

namespace regrasp::cli {

/// A daemon of this program's own, its socket in a directory of its own; stopped, and
/// the directory removed, when it goes out of scope, however that happens. Its arguments alone
/// decide what it does: it sees neither the user's configuration nor $REGRASP_..., and what it
/// writes goes with it unless `--output-dir` is among them.
class PrivateDaemon {
 public:
  /// Starts `regraspd --socket … --config /dev/null arguments…`. Throws CliError as StartDaemon()
  /// does.
  explicit PrivateDaemon(const std::vector<std::string>& arguments);
  ~PrivateDaemon();
  PrivateDaemon(const PrivateDaemon&) = delete;
  PrivateDaemon& operator=(const PrivateDaemon&) = delete;

  const std::string& socket() const { return started_.socket; }

 private:
  PrivateDirectory directory_;
  StartedDaemon started_;
};

}  // namespace regrasp::cli
