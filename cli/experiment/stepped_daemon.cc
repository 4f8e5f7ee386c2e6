#include "cli/experiment/stepped_daemon.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include "cli/client/errors.h"
#include "cli/print/print.h"
#include "core/common/fnv1a.h"

namespace regrasp::cli {
namespace {

constexpr double kNoLimit = 0;
constexpr const char* kStart = "private-start";  // the checkpoint of the last grasp
constexpr std::int64_t kGraspLimit = 30000;      // [ticks]

std::vector<std::string> WithSpeed(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"--paused", "--speed", "max"});
  return arguments;
}

bool Running(const Json& record) {
  const std::string state = Plain(At(record, "state"));
  return state == "queued" || state == "running";
}

}  // namespace

SteppedDaemon::SteppedDaemon(std::vector<std::string> arguments)
    : daemon_(WithSpeed(std::move(arguments))), client_(daemon_.socket(), kNoLimit) {}

SteppedDaemon::~SteppedDaemon() {
  std::error_code gone_already;
  if (!start_file_.empty()) std::filesystem::remove(start_file_, gone_already);
}

void SteppedDaemon::Step(std::int64_t ticks) { Step({{"ticks", ticks}}); }

void SteppedDaemon::Step(const Json& params) {
  try {
    const Json step = Call("step", params);
    Call("job.wait", {{"id", step.at("job")}});
  } catch (const CliError& error) {
    if (error.code != kSimulationFault) throw;
  }
}

Json SteppedDaemon::Run(const std::string& method, const Json& params, std::int64_t chunk_ticks,
                        std::int64_t max_ticks, const std::function<void()>& look) {
  Json job;
  try {
    job = Call(method, params);
  } catch (const CliError& error) {
    if (error.rpc_code == 0 || (error.code != kRefused && error.code != kSimulationFault)) throw;
    return {{"method", method}, {"state", "failed"}, {"error", error.what()}};
  }
  Json record;
  for (std::int64_t ticks = 0; ticks < max_ticks; ticks += chunk_ticks) {
    Step({{"ticks", chunk_ticks}, {"until_job_ends", true}});
    // Paused it is already: the answer comes when all that the last tick did has been told, a job
    // that ended among it.
    Call("pause");
    if (look) look();
    record = Call("job.get", {{"id", job.at("job")}});
    if (!Running(record)) break;
  }
  return record;
}

void SteppedDaemon::LeaveFault() {
  if (Plain(At(Call("status"), "state")) == "faulted") Call("reset");
}

Json SteppedDaemon::Grasp(std::int64_t seed) {
  const Json status = Call("status");
  Json start = {{"seed", seed}};
  for (const char* what : {"object", "noise", "changed_parameters"}) start[what] = status.at(what);
  if (start_ == start) {
    const Json restore = Call("checkpoint.restore", {{"name", kStart}});
    const Json record = Call("job.wait", {{"id", restore.at("job")}});
    if (!Done(record)) throw CliError(kFailed, Plain(At(record, "error")), "regrasp doctor");
    return grasp_;
  }
  start_ = nullptr;
  Call("reset", {{"seed", seed}});
  grasp_ = Run("grasp", Json::object(), kGraspLimit, kGraspLimit);
  if (Done(grasp_)) {
    start_file_ = Plain(At(Call("checkpoint.save", {{"name", kStart}}), "path"));
    start_ = std::move(start);
  }
  return grasp_;
}

bool Done(const Json& record) { return Plain(At(record, "state")) == "done"; }

std::string DaemonBuild() {
  const std::string path = FindDaemon();
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  if (bytes.empty()) throw CliError(kIo, "cannot read " + path, "ls -l " + path);
  return fmt::format("{:016x}", Fnv1a(bytes));
}

}  // namespace regrasp::cli
