#pragma once

/// The I/O thread: accepts clients, owns the connections, timers and the worker, and wakes up when
/// the control loop has something to tell.

#include <array>
#include <asio/io_context.hpp>
#include <asio/local/stream_protocol.hpp>
#include <asio/posix/stream_descriptor.hpp>
#include <asio/signal_set.hpp>
#include <asio/steady_timer.hpp>
#include <asio/thread_pool.hpp>
#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "daemon/requests/service.h"
#include "daemon/server/connection.h"
#include "daemon/server/service_manager.h"
#include "daemon/server/socket.h"

namespace regrasp {

class Server final : public ConnectionOwner, public Host {
 public:
  /// Takes clients from `listener` (which stays with the caller) once Run() is called. Throws what
  /// Service throws.
  Server(ServiceConfig config, Limits limits, ListenSocket* listener);
  ~Server() override;

  /// Serves until Stop(), a shutdown request or, with `signals`, SIGINT or SIGTERM; SIGHUP calls
  /// `reload`, unless it says that the terminal this was started from has gone.
  void Run(bool signals, std::function<void()> reload = {});
  /// Any thread: closes the connections once they are flushed and ends Run().
  void Stop();
  /// Before Run(): it also ends when `fd` has no more to read. What comes from there is passed
  /// over.
  void StopAtEndOf(int fd);

  /// From `reload`: a request of our own, as a client would make it. Returns why it was refused, or
  /// "".
  std::string Request(const std::string& method, const JsonIn& params);
  void SetMaxClients(std::size_t count) { limits_.max_clients = count; }

 private:
  // ConnectionOwner
  Service& service() override { return service_; }
  const Limits& limits() const override { return limits_; }
  std::uint64_t acknowledged() const override { return acknowledged_; }
  void Closed(Connection* connection, const std::string& why) override;
  // Host
  std::uint64_t After(double seconds, std::function<void()> action) override;
  void Cancel(std::uint64_t key) override;
  bool Background(std::function<void()> work, std::function<void()> finish) override;
  std::size_t clients() const override { return connections_.size(); }
  void Shutdown() override;
  bool activated() const override { return listener_->inherited(); }

  /// Begins whatever is not being waited for: everything at first, then what an exception ended.
  void Watch();
  void Accept();
  void Admit(Connection::Socket socket);
  void DropClosed();
  void WatchControl();
  void TakeFromControl();
  void WatchHealth();
  void WatchSignals();
  void WatchInput();
  void FeedWatchdog();
  std::string StatusLine() const;
  void Finish();
  /// Runs one step of the server; what it throws (no memory is left, most likely) is logged, and
  /// the server goes on.
  void Guard(const char* what, const std::function<void()>& step);
  std::vector<std::shared_ptr<Connection>> Connections() const;

  Limits limits_;
  ListenSocket* listener_;
  asio::io_context io_{1};
  asio::local::stream_protocol::acceptor acceptor_{io_};
  asio::posix::stream_descriptor control_output_{io_}, input_{io_};
  std::array<char, 256> passed_over_{};
  asio::steady_timer accept_retry_{io_}, health_{io_}, last_moment_{io_}, watchdog_{io_};
  asio::signal_set signals_{io_};
  std::function<void()> reload_;
  /// What is being waited for; each is begun again by its handler, or by Watch().
  struct {
    bool clients = false, control = false, health = false, signals = false, watchdog = false,
         input = false;
  } watching_;
  std::map<Connection*, std::shared_ptr<Connection>> connections_;
  std::map<std::uint64_t, asio::steady_timer> timers_;
  std::uint64_t last_timer_ = 0;
  std::size_t background_ = 0;
  bool stopping_ = false, accept_failing_ = false;
  std::uint64_t acknowledged_ = 0;
  std::uint64_t pulse_ = 0;  ///< of the control loop, when the watchdog was last fed
  ServiceManager manager_;
  Service service_;
  asio::thread_pool worker_{1};
};

}  // namespace regrasp
