#include "daemon/server/server.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <asio/buffer.hpp>
#include <asio/post.hpp>
#include <csignal>
#include <system_error>
#include <thread>

#include "daemon/server/memory_reserve.h"
#include "daemon/wire/rpc.h"

namespace regrasp {
namespace {

constexpr std::size_t kMaxBackground = 256;

void RefuseClient(Connection::Socket socket, const RpcError& error) {
  const std::string line = ToLine(ErrorMessage({}, error));
  std::error_code ignored;
  socket.non_blocking(true, ignored);
  socket.write_some(asio::buffer(line), ignored);  // a fresh socket has room for one line
}

}  // namespace

Server::Server(ServiceConfig config, Limits limits, ListenSocket* listener)
    : limits_(limits), listener_(listener), service_(std::move(config), this) {
  const int output = ::dup(service_.control().output().fd());
  if (output < 0) throw std::system_error(errno, std::generic_category(), "dup");
  control_output_.assign(output);
  acceptor_.assign(asio::local::stream_protocol(), listener_->Release());
  acceptor_.non_blocking(true);
  service_.PrepareModelText();
}

Server::~Server() {
  worker_.stop();
  worker_.join();
}

void Server::Run(bool signals, std::function<void()> reload) {
  reload_ = std::move(reload);
  if (signals)
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) signals_.add(signal);
  watching_.signals = !signals;
  watching_.watchdog = !manager_.watchdog();
  watching_.input = !input_.is_open();
  manager_.Tell("READY=1\nSTATUS=" + StatusLine());
  // A handler that throws past its guard has lost what it was about; the others go on.
  while (!io_.stopped()) {
    Guard("a step of the server", [this] {
      Watch();
      io_.run();
    });
    if (io_.stopped()) break;
    // Memory is short: not again at once, and what was cut short is taken up again.
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    service_.control().output().Notify();
  }
  // Connections hold their own sockets and timers alive through handlers: let go of all before io_
  // goes.
  for (const auto& connection : Connections()) connection->CloseWhenFlushed();
  connections_.clear();
}

void Server::Watch() {
  if (!watching_.signals) WatchSignals();
  if (!watching_.input) WatchInput();
  if (!watching_.control) WatchControl();
  if (!watching_.health) WatchHealth();
  if (!watching_.clients && !stopping_) Accept();
  if (!watching_.watchdog && !stopping_) FeedWatchdog();
}

void Server::Stop() {
  asio::post(io_, [this] { Shutdown(); });
}

void Server::StopAtEndOf(int fd) {
  const int own = ::dup(fd);
  if (own < 0) throw std::system_error(errno, std::generic_category(), "dup");
  input_.assign(own);
}

void Server::WatchInput() {
  input_.async_read_some(asio::buffer(passed_over_), [this](std::error_code error, std::size_t) {
    if (!error) return WatchInput();
    if (error == asio::error::operation_aborted) return;
    spdlog::info("standard input has ended: stopping");
    Shutdown();
  });
  watching_.input = true;
}

void Server::WatchSignals() {
  const bool on_terminal = ::isatty(STDERR_FILENO) == 1;
  signals_.async_wait([this, on_terminal](std::error_code error, int signal) {
    watching_.signals = false;
    if (error) return;
    const bool hung_up = on_terminal && ::isatty(STDERR_FILENO) == 0;
    if (signal != SIGHUP || hung_up) {
      spdlog::info("signal {}: stopping", signal);
      return Shutdown();
    }
    manager_.Tell("RELOADING=1");
    if (reload_) reload_();
    manager_.Tell("READY=1");
    WatchSignals();
  });
  watching_.signals = true;
}

/// The watchdog is fed only when the control loop has moved since the last time: by a tick, or,
/// while the clock is stopped on purpose, by looking around.
void Server::FeedWatchdog() {
  ControlLoop& control = service_.control();
  if (const std::uint64_t pulse = control.pulse(); pulse != pulse_) {
    pulse_ = pulse;
    manager_.Tell("WATCHDOG=1\nSTATUS=" + StatusLine());
  } else {
    manager_.Tell("STATUS=the simulation does not advance: " + StatusLine());
  }
  control.Nudge();
  watchdog_.expires_after(*manager_.watchdog() / 4);
  watchdog_.async_wait([this](std::error_code error) {
    watching_.watchdog = false;
    if (!error && !stopping_) FeedWatchdog();
  });
  watching_.watchdog = true;
}

std::string Server::StatusLine() const {
  const Published& newest = service_.newest();
  const std::optional<double> factor = service_.real_time_factor();
  return fmt::format("{}{}, tick {}{}", Name(newest.frame.state), newest.paused ? ", paused" : "",
                     newest.frame.tick, factor ? fmt::format(", {:.2f} x real time", *factor) : "");
}

std::string Server::Request(const std::string& method, const JsonIn& params) {
  struct Nobody final : Client {
    std::int64_t Subscribe(const std::string&, double) override { return 0; }
    Json Unsubscribe(std::int64_t) override { return {}; }
  } nobody;
  try {
    service_.Call(method, params, &nobody);
    return {};
  } catch (const RpcException& e) {
    return e.what();
  }
}

void Server::Accept() {
  acceptor_.async_accept([this](std::error_code error, Connection::Socket socket) {
    watching_.clients = false;
    if (stopping_) return;
    if (!error) {
      accept_failing_ = false;
      Guard("a new client", [&] { Admit(std::move(socket)); });
      return Accept();
    }
    // Out of descriptors, most likely: try again when some may have been closed.
    if (!std::exchange(accept_failing_, true))
      spdlog::warn("cannot accept clients: {}", error.message());
    accept_retry_.expires_after(std::chrono::milliseconds(100));
    accept_retry_.async_wait([this](std::error_code cancelled) {
      watching_.clients = false;
      if (!cancelled && !stopping_) Accept();
    });
    watching_.clients = true;
  });
  watching_.clients = true;
}

void Server::Admit(Connection::Socket socket) {
  if (!PeerAllowed(socket.native_handle())) {
    spdlog::warn("a client of another user was refused");
    return RefuseClient(std::move(socket), {ErrorCode::kPermission,
                                            "this daemon belongs to another user",
                                            "start your own: regrasp up",
                                            {},
                                            {}});
  }
  if (connections_.size() >= limits_.max_clients)
    return RefuseClient(std::move(socket),
                        {ErrorCode::kTooManyClients,
                         fmt::format("{} clients are connected already", connections_.size()),
                         "close one, or start regraspd with a larger --max-clients",
                         {},
                         {}});
  const auto connection = std::make_shared<Connection>(std::move(socket), this);
  connections_.emplace(connection.get(), connection);
  connection->Start();
}

void Server::Closed(Connection*, const std::string& why) {
  if (why.starts_with("evicted")) spdlog::warn("client {}", why);
  // The caller may be iterating over, or running inside, this connection.
  asio::post(io_, [this] { DropClosed(); });
}

void Server::DropClosed() {
  std::erase_if(connections_, [](const auto& entry) { return entry.second->closed(); });
  if (stopping_ && connections_.empty()) Finish();
}

std::vector<std::shared_ptr<Connection>> Server::Connections() const {
  std::vector<std::shared_ptr<Connection>> all;
  all.reserve(connections_.size());
  for (const auto& [key, connection] : connections_) all.push_back(connection);
  return all;
}

void Server::Guard(const char* what, const std::function<void()>& step) {
  try {
    step();
  } catch (const std::exception& e) {
    spdlog::error("{}: {}", what, e.what());
  }
}

void Server::WatchControl() {
  control_output_.async_wait(asio::posix::stream_descriptor::wait_read,
                             [this](std::error_code error) {
                               watching_.control = false;
                               if (error) return;
                               TakeFromControl();
                               WatchControl();
                             });
  watching_.control = true;
}

void Server::TakeFromControl() {
  ControlLoop& control = service_.control();
  control.output().Clear();
  // In this order: what is acknowledged is shown by the frames taken in after it.
  const std::uint64_t acknowledged = control.acknowledged();
  const std::vector<Sample> events = service_.Drain();
  acknowledged_ = acknowledged;
  service_.OnAcknowledged(acknowledged);
  const auto connections = Connections();
  for (const auto& connection : connections) connection->OnAcknowledged();
  for (const Sample& event : events)
    for (const auto& connection : connections) connection->OnEvent(event);
}

void Server::WatchHealth() {
  health_.expires_after(
      std::min<std::chrono::milliseconds>(std::chrono::seconds(1), limits_.max_stall / 4));
  health_.async_wait([this](std::error_code error) {
    watching_.health = false;
    if (error) return;
    Guard("looking after the clients", [this] {
      const auto now = std::chrono::steady_clock::now();
      for (const auto& connection : Connections()) connection->CheckHealth(now);
      if (MemoryReserve::WasLetGo())
        spdlog::error("memory was short: {}", MemoryReserve::Spent()
                                                  ? "nothing new is begun until there is more"
                                                  : "the reserve was used, and is there again");
      DropClosed();  // whose end could not be told
    });
    WatchHealth();
  });
  watching_.health = true;
}

std::uint64_t Server::After(double seconds, std::function<void()> action) {
  const std::uint64_t key = ++last_timer_;
  asio::steady_timer& timer = timers_.emplace(key, asio::steady_timer(io_)).first->second;
  timer.expires_after(std::chrono::duration_cast<std::chrono::steady_clock::duration>(
      std::chrono::duration<double>(seconds)));
  timer.async_wait([this, key, action = std::move(action)](std::error_code error) {
    // Cancelled after it had expired: the handler was already queued and comes without an error.
    if (error || timers_.erase(key) == 0) return;
    Guard("a timer", action);
  });
  return key;
}

void Server::Cancel(std::uint64_t key) { timers_.erase(key); }

bool Server::Background(std::function<void()> work, std::function<void()> finish) {
  if (background_ >= kMaxBackground) return false;
  ++background_;
  asio::post(worker_, [this, work = std::move(work), finish = std::move(finish)] {
    Guard("the worker", work);
    asio::post(io_, [this, finish] {
      --background_;
      Guard("the end of the worker's task", finish);
    });
  });
  return true;
}

void Server::Shutdown() {
  if (stopping_) return;
  stopping_ = true;
  manager_.Tell("STOPPING=1");
  // After the handler that asked has sent its answer.
  asio::post(io_, [this] {
    std::error_code ignored;
    acceptor_.close(ignored);
    listener_->Remove();
    for (const auto& connection : Connections()) connection->CloseWhenFlushed();
    last_moment_.expires_after(std::chrono::seconds(1));
    last_moment_.async_wait([this](std::error_code) { Finish(); });
    if (connections_.empty()) Finish();
  });
}

void Server::Finish() { io_.stop(); }

}  // namespace regrasp
