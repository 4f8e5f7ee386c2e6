// What is asked of the control loop, and whether it may be.

#include <fmt/format.h>

#include <algorithm>

#include "core/session/few_fingers.h"
#include "daemon/requests/service.h"

namespace regrasp {
namespace {

// Commands that wait for a tick; every parameter at once fits.
constexpr std::size_t kMaxBacklog = 400;
constexpr std::size_t kReserve = 1000;  // commands that end something are taken for longer

/// The row of the parameter that a command sets.
const ParameterInfo& RowOf(const Command& command) {
  return ParameterTable()[static_cast<std::size_t>(command.parameter)];
}

}  // namespace

void Service::CheckNotFaulted() const {
  if (newest_.frame.state == SessionState::kFaulted)
    throw RpcException(ErrorCode::kSimulationFault, "the simulation has stopped on a fault",
                       "regrasp reset");
}

void Service::CheckMeasure(const Parameters& parameters, JobMethod method,
                           Criterion criterion) const {
  const Verdict verdict = regrasp::CheckMeasure(parameters, method, criterion);
  if (verdict.kind != Verdict::Kind::kAllowed)
    throw RpcException(ErrorCode::kBadState, verdict.reason, verdict.hint);
}

void Service::CheckNotRestoring() const {
  if (const JobRecord* job = jobs_.Restoring())
    throw RpcException(ErrorCode::kBusy,
                       fmt::format("a checkpoint is being restored (job {})", job->id),
                       fmt::format("regrasp job wait {}", job->id));
}

void Service::CheckAllowed(CommandType type) const {
  CheckNotFaulted();
  // A hand that has released the object is idle again, but there is nothing to grasp.
  const bool released = newest_.frame.state == SessionState::kIdle && !newest_.frame.stand_in;
  const Verdict verdict = Check(type, released ? SessionState::kDropped : newest_.frame.state,
                                jobs_.Unfinished() != nullptr);
  if (verdict.kind == Verdict::Kind::kAllowed) return;
  const bool busy = verdict.kind == Verdict::Kind::kBusy;
  std::string message = verdict.reason;
  if (const JobRecord* job = jobs_.Unfinished(); busy && job)
    message += fmt::format(" (job {}: {})", job->id, Name(job->method));
  throw RpcException(busy ? ErrorCode::kBusy : ErrorCode::kBadState, std::move(message),
                     verdict.hint);
}

void Service::OrderForJob(const JobRecord& job, std::vector<Command>* commands) const {
  Parameters reached = accepted_.parameters;
  for (auto next = commands->begin(); next != commands->end(); ++next) {
    const auto verdict = [&](const Command& command) {
      Parameters then = reached;
      SetParameter(&then, command);
      const Verdict fit = regrasp::CheckMeasure(then, job.method, job.explore.criterion);
      if (fit.kind != Verdict::Kind::kAllowed) return fit;
      return CheckFingers(hand(), reached, then, job.method);
    };
    const auto fits = std::find_if(next, commands->end(), [&](const Command& command) {
      const bool lost = IsPreset(RowOf(*next)) && IsSetByPreset(RowOf(command));
      return !lost && verdict(command).kind == Verdict::Kind::kAllowed;
    });
    if (fits == commands->end()) {
      const Verdict refusal = verdict(*next);
      throw RpcException(ErrorCode::kBadState, refusal.reason, refusal.hint);
    }
    std::rotate(next, fits, fits + 1);
    SetParameter(&reached, *next);
  }
}

std::uint64_t Service::SetParameters(std::vector<Command> commands) {
  std::ranges::stable_partition(commands, IsPreset, RowOf);
  if (const JobRecord* job = jobs_.Unfinished()) OrderForJob(*job, &commands);
  CheckMayPost(commands.size(), 0);
  const Parameters before = accepted_.parameters;
  std::uint64_t barrier = 0;
  for (const Command& command : commands) {
    barrier = PostCommand(command);
    SetParameter(&Accept().parameters, command);
    config_.parameter_origins.erase(std::string(RowOf(command).name));
  }
  for (const ParameterInfo& info : ParameterTable())
    if (info.get(before) != info.get(accepted_.parameters))
      config_.parameter_origins.erase(std::string(info.name));
  return barrier;
}

std::uint64_t Service::Post(ControlRequest request) {
  const std::uint64_t number = control_.Post(std::move(request));
  if (number == 0)
    throw RpcException(ErrorCode::kBusy, "the command queue is full", "try again in a moment");
  return number;
}

std::uint64_t Service::PostCommand(Command command) {
  const bool ends = command.type == CommandType::kStop || command.type == CommandType::kCancelJob ||
                    command.type == CommandType::kRelease;
  CheckMayPost(1, ends ? kReserve : 0);
  ControlRequest request;
  request.command = std::move(command);
  return Post(std::move(request));
}

void Service::CheckMayPost(std::size_t commands, std::size_t reserve) const {
  CheckNotRestoring();
  const std::size_t known = journal_.entries.size() + control_.backlog();
  if (known + commands > config_.budgets.commands + reserve)
    throw RpcException(
        ErrorCode::kBusy,
        fmt::format("the run has {} commands, as many as are kept of one", journal_.entries.size()),
        "regrasp reset");
  CheckRoom(commands);
}

void Service::CheckRoom(std::size_t commands) const {
  if (control_.backlog() + commands > kMaxBacklog)
    throw RpcException(ErrorCode::kBusy,
                       fmt::format("{} commands are waiting for the next tick", kMaxBacklog),
                       accepted_.paused ? "regrasp step 1" : "try again in a moment");
}

}  // namespace regrasp
