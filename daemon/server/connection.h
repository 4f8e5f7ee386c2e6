#pragma once

/// One client: lines in, lines out, in order, within limits.

#include <array>
#include <asio/local/stream_protocol.hpp>
#include <asio/steady_timer.hpp>
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "daemon/requests/service.h"

namespace regrasp {

struct Limits {
  std::size_t max_clients = 64;
  std::size_t max_output_bytes = kMaxOutputBytes;
  std::chrono::milliseconds max_stall = std::chrono::seconds(kMaxOutputStallSeconds);
};

class Connection;

/// What a connection needs of the server.
class ConnectionOwner {
 public:
  virtual ~ConnectionOwner() = default;
  virtual Service& service() = 0;
  virtual const Limits& limits() const = 0;
  /// Requests to the control thread that have taken effect, as of the newest frame taken in.
  virtual std::uint64_t acknowledged() const = 0;
  /// The connection is closed. `why` is for the log.
  virtual void Closed(Connection* connection, const std::string& why) = 0;
};

class Connection : public Client, public std::enable_shared_from_this<Connection> {
 public:
  using Socket = asio::local::stream_protocol::socket;

  Connection(Socket socket, ConnectionOwner* owner) : socket_(std::move(socket)), owner_(owner) {}

  void Start();
  /// The control thread has acknowledged more: answers that waited for it may go.
  void OnAcknowledged();
  /// Sends an event to every subscription to events.
  void OnEvent(const Event& event);
  /// Closes when output has made no progress for too long, or a half-closed peer is gone.
  void CheckHealth(std::chrono::steady_clock::time_point now);
  /// Closes as soon as everything is written.
  void CloseWhenFlushed();

  std::int64_t Subscribe(const std::string& topic, double rate_hz) override;
  Json Unsubscribe(std::int64_t sub) override;

 private:
  struct Slot {
    bool answered = false;  ///< false: a notification
    std::optional<RequestId> id;
    Json message;
    std::function<Json()> later;
  };
  /// One line of requests on its way to one line of answers.
  struct Line {
    bool batch = false;
    bool building = true;
    bool released = false;           ///< no longer holds up the lines after it
    std::size_t open = 0;            ///< answers to come that hold up the lines after this one
    std::size_t open_overtaken = 0;  ///< answers to come that do not
    std::uint64_t barrier = 0;
    std::vector<Slot> slots;
  };
  struct Subscription {
    std::string topic;
    std::chrono::steady_clock::duration period{};
    asio::steady_timer timer;
    std::int64_t seq = 0, dropped = 0;
    std::uint64_t last_frame = 0;
    bool started = false;
  };

  void Read();
  void OnRead(std::size_t size);
  void OnEndOfInput();
  void ProcessInput();
  void HandleLine(std::string_view text);
  void HandleRequest(const RpcRequest& request, const std::shared_ptr<Line>& line,
                     std::size_t index);
  void Advance(const std::shared_ptr<Line>& line);
  void SendAnswers(const Line& line);
  void Send(std::string line);
  void Write();
  void Close(const std::string& why);
  void MaybeClose();
  void StartSubscriptions();
  void Tick(std::int64_t sub);
  void SendSample(std::int64_t sub, Subscription* subscription, Json fields);
  std::size_t unsent() const { return pending_.size() + writing_.size() - written_; }

  Socket socket_;
  ConnectionOwner* owner_;
  std::array<char, 16384> buffer_{};
  std::string input_;
  std::size_t scanned_ = 0;  ///< bytes of input_ known to hold no line end
  bool reading_ = false;
  bool end_of_input_ = false;
  bool processing_ = false;
  bool discarding_ = false;  ///< after an over-long line: read on, listen no more
  bool closing_ = false;     ///< close when flushed
  bool closed_ = false;
  std::shared_ptr<Line> gate_;  ///< the line that holds up the lines after it
  std::size_t waiting_ = 0;     ///< answers to come that have been overtaken
  std::string writing_, pending_;
  std::size_t written_ = 0;
  bool write_active_ = false;
  std::chrono::steady_clock::time_point progress_{};
  std::map<std::int64_t, Subscription> subscriptions_;
  std::int64_t last_sub_ = 0;
};

}  // namespace regrasp
