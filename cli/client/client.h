#pragma once

/// JSON-RPC 2.0 over a Unix stream socket, one object per line: the client's side.

#include <deque>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "cli/client/errors.h"
#include "cli/client/wait.h"

namespace regrasp::cli {

using Json = nlohmann::ordered_json;

/// A connection to a daemon. Every function throws CliError: kNoDaemon when nobody listens or the
/// daemon goes away, kTimeout, kProtocol when the answer is not JSON-RPC, and what ExitCodeFor()
/// says when the daemon answers with an error.
class Client {
 public:
  /// Connects to the socket at `path`; `timeout_s` [s] bounds the connection and is the default of
  /// Call(); 0 or less: no limit.
  Client(std::string path, double timeout_s);
  ~Client();
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  /// Sends a request and returns the result.
  Json Call(const std::string& method, const Json& params);
  Json Call(const std::string& method, const Json& params, double timeout_s);

  /// The parameters of the next notification, or nothing when none came within `timeout_s`.
  std::optional<Json> NextEvent(double timeout_s);

  /// For callers that must not wait: sends a request and returns its id; its answer comes out of
  /// Receive().
  long Post(const std::string& method, const Json& params);
  struct Message {
    long id = 0;                         ///< of the request that this answers; 0: a notification
    Json body;                           ///< the result, or the notification's parameters
    std::optional<CliError> error = {};  ///< the daemon refused
  };
  /// The next message that is there already, or comes within `timeout_s`.
  std::optional<Message> Receive(double timeout_s);
  /// To wait for it together with something else.
  int fd() const { return fd_; }

  const std::string& path() const { return path_; }

 private:
  std::optional<std::string> ReadLine(Clock::time_point deadline);
  std::optional<Message> ReadMessage(Clock::time_point deadline);
  void Send(const std::string& line, Clock::time_point deadline);
  [[noreturn]] void Lost() const;

  std::string path_;
  double timeout_s_;
  int fd_ = -1;
  long next_id_ = 1;
  std::string buffer_;
  std::size_t scanned_ = 0;  ///< bytes of buffer_ known to hold no newline
  std::deque<Json> events_;  ///< notifications that came before a reply
};

/// True if something accepts connections at `path`.
bool Listening(const std::string& path);
/// Throws CliError where no daemon could listen: the path is too long, or something else is there.
void CheckSocketPath(const std::string& path);

}  // namespace regrasp::cli
