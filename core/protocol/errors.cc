#include "core/protocol/errors.h"

#include <array>

namespace regrasp {
namespace {

constexpr std::array kErrors = {
    ErrorInfo{ErrorCode::kParse, "parse error", ExitCode::kProtocol,
              "the line is not JSON, not UTF-8, or holds a number that is not finite"},
    ErrorInfo{ErrorCode::kInvalidRequest, "invalid request", ExitCode::kProtocol,
              "the line is JSON but not a request: bad id, duplicate key, nested too deeply, or a "
              "batch that is empty or too long"},
    ErrorInfo{ErrorCode::kMethodNotFound, "method not found", ExitCode::kProtocol,
              "no method of this name; the nearest is in data.hint"},
    ErrorInfo{ErrorCode::kInvalidParams, "invalid parameter", ExitCode::kUsage,
              "a parameter is unknown, missing, of the wrong type or out of its range"},
    ErrorInfo{ErrorCode::kInternal, "internal error", ExitCode::kFailed, "a defect of the daemon"},
    ErrorInfo{ErrorCode::kBusy, "busy", ExitCode::kRefused,
              "another job is running, or the command queue is full"},
    ErrorInfo{ErrorCode::kBadState, "bad state", ExitCode::kRefused,
              "the command makes no sense in the present state"},
    ErrorInfo{ErrorCode::kNotFound, "not found", ExitCode::kNotFound,
              "no job, subscription or model of this name"},
    ErrorInfo{ErrorCode::kTimeout, "timeout", ExitCode::kTimeout,
              "the job had not ended when the time given to job.wait was over"},
    ErrorInfo{ErrorCode::kPermission, "permission denied", ExitCode::kPermission,
              "the peer is neither the owner of the daemon nor root"},
    ErrorInfo{ErrorCode::kSimulationFault, "simulation fault", ExitCode::kSimulationFault,
              "the simulation has stopped on a fault; only reset helps"},
    ErrorInfo{ErrorCode::kIo, "I/O error", ExitCode::kIo, "a file could not be read or written"},
    ErrorInfo{ErrorCode::kTooManyClients, "too many clients", ExitCode::kRefused,
              "the connection is closed after this error"},
    ErrorInfo{
        ErrorCode::kTooLarge, "too large", ExitCode::kProtocol,
        "the request line is over 64 KiB: the connection is closed after this error; or the answer "
        "would be too long: it stays"},
    ErrorInfo{ErrorCode::kProtocolVersion, "protocol version", ExitCode::kProtocol,
              "client and daemon share no protocol version"},
};

constexpr std::array kExits = {
    ExitInfo{ExitCode::kOk, "ok"},
    ExitInfo{ExitCode::kFailed, "the operation failed (object dropped, no convergence)"},
    ExitInfo{ExitCode::kUsage, "usage"},
    ExitInfo{ExitCode::kNoDaemon, "no daemon"},
    ExitInfo{ExitCode::kTimeout, "timeout"},
    ExitInfo{ExitCode::kRefused, "refused in this state, or busy"},
    ExitInfo{ExitCode::kNotFound, "not found"},
    ExitInfo{ExitCode::kSimulationFault, "simulation fault"},
    ExitInfo{ExitCode::kProtocol, "protocol or version"},
    ExitInfo{ExitCode::kIo, "I/O"},
    ExitInfo{ExitCode::kPermission, "permission"},
    ExitInfo{ExitCode::kInterrupted, "interrupted; the job goes on"},
};

}  // namespace

std::span<const ErrorInfo> ErrorTable() { return kErrors; }

const ErrorInfo* FindError(int code) {
  for (const ErrorInfo& info : kErrors)
    if (static_cast<int>(info.code) == code) return &info;
  return nullptr;
}

ExitCode ExitCodeFor(int code) {
  const ErrorInfo* info = FindError(code);
  return info ? info->exit_code : ExitCode::kProtocol;
}

std::string WithHint(const std::string& message, const std::string& hint) {
  constexpr std::string_view kAllowed = "allowed: ";
  const bool said =
      hint.starts_with(kAllowed) && message.ends_with("expected " + hint.substr(kAllowed.size()));
  return hint.empty() || said ? message : message + "; " + hint;
}

std::span<const ExitInfo> ExitTable() { return kExits; }

}  // namespace regrasp
