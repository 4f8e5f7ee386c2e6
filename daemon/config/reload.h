#pragma once

/// A changed configuration meets a running daemon (SIGHUP): what can change at once, what waits for
/// a restart.

#include <string>
#include <vector>

#include "daemon/config/config.h"
#include "daemon/wire/json.h"

namespace regrasp {

/// A request of the wire that brings a changed value into force.
struct ReloadCall {
  std::string method;  ///< noise.set or param.set: they take effect at a tick, like a client's
  JsonIn params;
  std::string what;  ///< "noise = fine", for the log
};

struct ReloadPlan {
  std::vector<ReloadCall> calls;
  std::vector<std::string> at_once;  ///< keys the daemon itself changes: log_level, max_clients
  std::vector<std::string> restart;  ///< "seed = 7 ($REGRASP_SEED)": in force after a restart
};

/// What has to happen so that `wanted` is in force where `running` was. Only differences between
/// the two count: what a client has changed meanwhile stays unless the configuration changed there.
/// A parameter that is no longer set keeps its value until a restart.
ReloadPlan PlanReload(const DaemonConfig& running, const DaemonConfig& wanted);

}  // namespace regrasp
