#include "cli/client/client.h"

#include <fmt/format.h>
#include <poll.h>
#include <pwd.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "cli/client/errors.h"

namespace regrasp::cli {
namespace {

// A daemon that sends a longer line than this is not ours.
constexpr std::size_t kMaxReplyBytes = 64u << 20;

void CheckLength(const std::string& path) {
  constexpr std::size_t kMost = sizeof sockaddr_un{}.sun_path - 1;
  if (path.empty() || path.size() > kMost)
    throw CliError(
        kUsage,
        fmt::format("socket path '{}' has {} bytes; allowed are 1 to {}", path, path.size(), kMost),
        "regrasp -s /tmp/regrasp.sock status");
}

sockaddr_un Address(const std::string& path) {
  CheckLength(path);
  sockaddr_un address = {};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  return address;
}

[[noreturn]] void RefuseConnection(const std::string& path, int error) {
  struct stat info;
  const bool exists = ::stat(path.c_str(), &info) == 0;
  if (error == EACCES || error == EPERM) {
    // Where even the directory is closed, nothing is known about the socket.
    const passwd* owner = exists ? ::getpwuid(info.st_uid) : nullptr;
    const std::string who = owner != nullptr ? owner->pw_name
                            : exists         ? "user " + std::to_string(info.st_uid)
                                             : "";
    throw CliError(kPermission,
                   fmt::format("not allowed to open {}{}", path,
                               who.empty() ? "" : fmt::format(": it belongs to {}", who)),
                   fmt::format("regrasp -s PATH up    (a daemon of your own; or run as {})",
                               who.empty() ? "the user who started this one" : who));
  }
  if (exists && !S_ISSOCK(info.st_mode)) {
    throw CliError(kNoDaemon, fmt::format("{} is not a socket", path),
                   "regrasp -s OTHER_PATH status");
  }
  if (error == ENOENT || error == ENOTDIR) {
    throw CliError(kNoDaemon, fmt::format("no daemon: {} does not exist", path), "regrasp up");
  }
  if (error == ECONNREFUSED) {
    throw CliError(kNoDaemon, fmt::format("no daemon: nobody listens on {} (stale socket)", path),
                   "regrasp up    (takes the socket over)");
  }
  throw CliError(kNoDaemon, fmt::format("cannot connect to {}: {}", path, std::strerror(error)),
                 "regrasp doctor");
}

/// An error of the wire by itself.
CliError OneRefusal(const Json& error) {
  const int code = error.value("code", 0);
  CliError refusal(ExitCodeFor(code), error.value("message", "refused without a reason"), "", code);
  if (!error.contains("data") || !error["data"].is_object()) return refusal;
  const Json& data = error["data"];
  refusal.hint = data.value("hint", "");
  refusal.rpc_param = data.value("param", "");
  return refusal;
}

/// With those that it is made of.
CliError Refusal(const Json& error) {
  CliError refusal = OneRefusal(error);
  const Json data = error.value("data", Json());
  if (!data.is_object() || !data.contains("errors")) return refusal;
  for (const Json& one : data["errors"]) refusal.rpc_errors.push_back(OneRefusal(one));
  refusal.rpc_more = data.value("more", std::size_t{0});
  refusal.is_list = !refusal.rpc_errors.empty();
  return refusal;
}

}  // namespace

Client::Client(std::string path, double timeout_s) : path_(std::move(path)), timeout_s_(timeout_s) {
  const sockaddr_un address = Address(path_);
  const auto deadline = Deadline(timeout_s);
  fd_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd_ < 0) throw CliError(kIo, fmt::format("cannot make a socket: {}", std::strerror(errno)));
  while (::connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    const int error = errno;
    try {
      // EAGAIN: the daemon's queue of new connections is full; a Unix socket must simply try again.
      if (error != EAGAIN && error != EINTR) RefuseConnection(path_, error);
      if (Clock::now() > deadline) {
        throw CliError(kTimeout, fmt::format("{} accepts no connection", path_), "regrasp doctor");
      }
      WaitFor(-1, 0, Deadline(0.005));
    } catch (...) {
      ::close(std::exchange(fd_, -1));
      throw;
    }
  }
}

Client::~Client() {
  if (fd_ >= 0) ::close(fd_);
}

void Client::Lost() const {
  throw CliError(kNoDaemon, fmt::format("the daemon on {} closed the connection", path_),
                 "regrasp up");
}

void Client::Send(const std::string& line, Clock::time_point deadline) {
  std::size_t sent = 0;
  while (sent < line.size()) {
    const ssize_t n = ::send(fd_, line.data() + sent, line.size() - sent, MSG_NOSIGNAL);
    if (n >= 0) {
      sent += static_cast<std::size_t>(n);
    } else if (errno == EAGAIN) {
      if (!WaitFor(fd_, POLLOUT, deadline)) {
        throw CliError(kTimeout, fmt::format("the daemon on {} does not read", path_),
                       "regrasp doctor");
      }
    } else if (errno == EPIPE || errno == ECONNRESET) {
      return;  // its last words, if any, are still to be read
    } else if (errno != EINTR) {
      throw CliError(kIo, fmt::format("cannot write to {}: {}", path_, std::strerror(errno)));
    }
  }
}

std::optional<std::string> Client::ReadLine(Clock::time_point deadline) {
  while (true) {
    const auto end = buffer_.find('\n', scanned_);
    if (end != std::string::npos) {
      std::string line = buffer_.substr(0, end);
      buffer_.erase(0, end + 1);
      scanned_ = 0;
      if (!line.empty() && line.back() == '\r') line.pop_back();
      if (line.empty()) continue;
      return line;
    }
    scanned_ = buffer_.size();
    if (scanned_ > kMaxReplyBytes) {
      throw CliError(kProtocol, fmt::format("an answer from {} is longer than 64 MiB", path_));
    }
    char chunk[65536];
    const ssize_t n = ::recv(fd_, chunk, sizeof chunk, 0);
    if (n > 0) {
      buffer_.append(chunk, static_cast<std::size_t>(n));
    } else if (n == 0 || errno == ECONNRESET) {
      Lost();
    } else if (errno == EAGAIN) {
      if (!WaitFor(fd_, POLLIN, deadline)) return std::nullopt;
    } else if (errno != EINTR) {
      throw CliError(kIo, fmt::format("cannot read from {}: {}", path_, std::strerror(errno)));
    }
  }
}

Json Client::Call(const std::string& method, const Json& params) {
  return Call(method, params, timeout_s_);
}

std::optional<Client::Message> Client::ReadMessage(Clock::time_point deadline) {
  const auto line = ReadLine(deadline);
  if (!line) return std::nullopt;
  Json message = Json::parse(*line, nullptr, false);
  if (!message.is_object()) {
    throw CliError(kProtocol, fmt::format("{} does not speak JSON-RPC: {:.60}", path_, *line),
                   "regrasp doctor");
  }
  if (message.contains("method")) return Message{0, message.value("params", Json::object())};
  const Json id = message.value("id", Json());
  Message answer{id.is_number_integer() ? id.get<long>() : -1, message.value("result", Json())};
  if (message.contains("error")) {
    answer.error = Refusal(message["error"]);
    // Refused before its id was understood: of the last request.
    if (id.is_null()) answer.id = next_id_ - 1;
  } else if (!message.contains("result")) {
    throw CliError(kProtocol, fmt::format("{} answered with neither result nor error", path_),
                   "regrasp version");
  }
  return answer;
}

long Client::Post(const std::string& method, const Json& params) {
  const long id = next_id_++;
  Json request = {{"jsonrpc", "2.0"}, {"id", id}, {"method", method}};
  if (!params.empty()) request["params"] = params;
  Send(request.dump() + "\n", Deadline(timeout_s_));
  return id;
}

std::optional<Client::Message> Client::Receive(double timeout_s) {
  if (events_.empty()) return ReadMessage(timeout_s > 0 ? Deadline(timeout_s) : Clock::now());
  Message message{0, std::move(events_.front())};
  events_.pop_front();
  return message;
}

Json Client::Call(const std::string& method, const Json& params, double timeout_s) {
  const auto deadline = Deadline(timeout_s);
  const long id = Post(method, params);
  while (true) {
    auto message = ReadMessage(deadline);
    if (!message) {
      throw CliError(kTimeout, fmt::format("no answer to '{}' within {:g} s", method, timeout_s),
                     fmt::format("regrasp --timeout {:g} …, or regrasp doctor", 10 * timeout_s));
    }
    if (message->id == 0) events_.push_back(std::move(message->body));
    if (message->id != id) continue;
    if (message->error) throw *message->error;
    return std::move(message->body);
  }
}

std::optional<Json> Client::NextEvent(double timeout_s) {
  const auto deadline = Deadline(timeout_s);
  while (events_.empty()) {
    auto message = ReadMessage(deadline);
    if (!message) return std::nullopt;
    if (message->id == 0) events_.push_back(std::move(message->body));
  }
  Json event = std::move(events_.front());
  events_.pop_front();
  return event;
}

void CheckSocketPath(const std::string& path) {
  CheckLength(path);
  struct stat info {};
  if (::lstat(path.c_str(), &info) == 0 && !S_ISSOCK(info.st_mode))
    throw CliError(kIo, fmt::format("{} exists and is not a socket; left alone", path),
                   "regrasp -s OTHER_PATH up");
}

bool Listening(const std::string& path) {
  try {
    Client client(path, 1.0);
    return true;
  } catch (const CliError&) {
    return false;
  }
}

}  // namespace regrasp::cli
