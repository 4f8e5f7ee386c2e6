#pragma once

/// A private daemon that advances only when told: what happens in a run then depends on its seed
/// and commands alone, never on how fast anything is.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "cli/client/client.h"
#include "cli/client/private_daemon.h"

namespace regrasp::cli {

class SteppedDaemon {
 public:
  /// Starts a paused daemon at full speed. `arguments` go to it as they are. Throws CliError.
  explicit SteppedDaemon(std::vector<std::string> arguments);
  /// The start that was kept goes with it.
  ~SteppedDaemon();

  Json Call(const std::string& method, const Json& params = Json::object()) {
    return client_.Call(method, params);
  }
  /// Advances by `ticks`; the topics (status, truth, quality, ...) are then those of the last of
  /// them. A simulation that has faulted stays where it is.
  void Step(std::int64_t ticks);
  /// Sends a command that starts a job and steps in chunks to the tick in which the job ends, or
  /// for `max_ticks` where it does not: what follows begins in the next tick. Returns its record. A
  /// command that is refused at once gives a record whose state is "failed" and whose error says
  /// why, as does one on a simulation that has faulted. `look` is called after each chunk, the last
  /// of which may be cut.
  Json Run(const std::string& method, const Json& params, std::int64_t chunk_ticks,
           std::int64_t max_ticks, const std::function<void()>& look = {});
  /// Begins a new run when the present one has faulted: what follows is accepted again.
  void LeaveFault();
  /// A run in which the object is in the hand. Returns the record of the grasp. Where seed,
  /// object, noise and parameters are those of the last grasp it is not made again: the run goes on
  /// from the state that it led to, which is the same to the last bit.
  Json Grasp(std::int64_t seed);

 private:
  void Step(const Json& params);

  Json start_;  ///< what the last grasp began from: seed, object, noise, parameters; null: none is
                ///< kept
  Json grasp_;  ///< its record
  std::string start_file_;  ///< the checkpoint that keeps what it led to
  PrivateDaemon daemon_;
  Client client_;
};

/// True for the record of a job that did what was asked.
bool Done(const Json& record);

/// An identity of the daemon's program: 64 bits over the bytes of `regraspd`, in hex. Throws
/// CliError.
std::string DaemonBuild();

}  // namespace regrasp::cli
