#pragma once

/// JSON-RPC 2.0: one line of a client in, requests out; results and errors back to lines.

#include <cstdint>
#include <exception>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/protocol/errors.h"
#include "daemon/wire/json.h"

namespace regrasp {

/// Of one line of answers; what would make it longer is answered with an error.
inline constexpr std::size_t kMaxAnswerBytes = 16 * 1024 * 1024;

/// An error as it goes over the wire (docs/protocol.md: Errors).
struct RpcError {
  ErrorCode code = ErrorCode::kInternal;
  std::string message;                ///< cause, with the offending value
  std::string hint;                   ///< what to try next
  std::string param;                  ///< the parameter at fault, if one is
  std::vector<std::string> allowed;   ///< its allowed values, if they can be listed
  std::vector<RpcError> errors = {};  ///< where several are at fault, each by itself
  std::size_t more = 0;               ///< so many more are not among `errors`
};

/// Thrown anywhere below a handler; mapped to the wire in one place (Service::Call).
class RpcException : public std::exception {
 public:
  explicit RpcException(RpcError error) : error_(std::move(error)) {}
  RpcException(ErrorCode code, std::string message, std::string hint = {})
      : error_{code, std::move(message), std::move(hint), {}, {}} {}
  const RpcError& error() const { return error_; }
  const char* what() const noexcept override { return error_.message.c_str(); }

 private:
  RpcError error_;
};

using RequestId = std::variant<std::int64_t, std::string>;

/// One request of a line. When `error` is set the rest is not valid and the error is answered to
/// `id` (to null when there is none, even though a notification has no answer: the line was no
/// request).
struct RpcRequest {
  std::optional<RequestId> id;  ///< empty: a notification
  std::string method;
  JsonIn params = JsonIn::object();
  std::optional<RpcError> error;
};

struct RpcLine {
  bool batch = false;                ///< answers go into an array
  std::vector<RpcRequest> requests;  ///< empty: a blank line
};

/// Parses one line (without '\n'; a trailing '\r' is ignored). Size, depth, UTF-8, duplicate keys
/// and number ranges are checked here, the first two before any document is built. Never throws.
RpcLine ParseLine(std::string_view line);

/// What an exception that nobody foresaw is answered with.
RpcError InternalError(const std::exception& e);

/// {"jsonrpc":"2.0","id":id,"result":result} around a result that is JSON text already; `id` empty
/// writes null.
std::string ResultText(const std::optional<RequestId>& id, std::string_view result);
Json ErrorMessage(const std::optional<RequestId>& id, const RpcError& error);

/// Text that is not UTF-8 is replaced, never thrown about.
std::string ToText(const Json& message);
/// One line, '\n' included.
std::string ToLine(const Json& message);

}  // namespace regrasp
