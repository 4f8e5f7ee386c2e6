#pragma once

/// Errors on the wire and what the command line makes of them. Standard JSON-RPC codes first, then
/// ours.

#include <span>
#include <string>
#include <string_view>

namespace regrasp {

/// The version of the wire protocol this build speaks.
inline constexpr int kWireVersion = 1;

enum class ErrorCode : int {
  kParse = -32700,
  kInvalidRequest = -32600,
  kMethodNotFound = -32601,
  kInvalidParams = -32602,
  kInternal = -32603,
  kBusy = -32001,
  kBadState = -32002,
  kNotFound = -32003,
  kTimeout = -32004,
  kPermission = -32005,
  kSimulationFault = -32006,
  kIo = -32007,
  kTooManyClients = -32010,
  kTooLarge = -32011,
  kProtocolVersion = -32012,
};

/// Exit codes of both programs.
enum class ExitCode : int {
  kOk = 0,
  kFailed = 1,
  kUsage = 2,
  kNoDaemon = 3,
  kTimeout = 4,
  kRefused = 5,
  kNotFound = 6,
  kSimulationFault = 7,
  kProtocol = 8,
  kIo = 74,
  kPermission = 77,
  kInterrupted = 130,
};

struct ErrorInfo {
  ErrorCode code;
  std::string_view name;      ///< "busy"
  ExitCode exit_code;         ///< what `regrasp` exits with
  std::string_view sentence;  ///< when it is answered
};

/// Every error the daemon can answer, standard codes first.
std::span<const ErrorInfo> ErrorTable();

/// The entry for a code read from the wire, or null for a code this build does not know.
const ErrorInfo* FindError(int code);

/// What `regrasp` exits with for a code read from the wire; unknown codes are a protocol problem.
ExitCode ExitCodeFor(int code);

/// "MESSAGE; HINT" for one line; the message alone where it has said what is allowed ("expected X"
/// and "allowed: X"), or without a hint.
std::string WithHint(const std::string& message, const std::string& hint);

struct ExitInfo {
  ExitCode code;
  std::string_view sentence;
};

/// Every exit code, ascending.
std::span<const ExitInfo> ExitTable();

}  // namespace regrasp
