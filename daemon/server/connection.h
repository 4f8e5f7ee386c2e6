#pragma once

/// One client: lines in, lines out, in order, within limits. Every request with an id is answered
/// exactly once: by its handler, by the error the handler threw, or, when the last copy of its Done
/// goes without a call, by an internal error. A client that asks for more than it reads is not
/// listened to until it has read.

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
  std::size_t max_output_bytes = kMaxOutputBytes;  ///< of events that are not read
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
  void OnEvent(const Sample& event);
  /// Closes when output has made no progress for too long, or a half-closed peer is gone.
  void CheckHealth(std::chrono::steady_clock::time_point now);
  /// Closes as soon as everything is written.
  void CloseWhenFlushed();
  bool closed() const { return closed_; }

  std::int64_t Subscribe(const std::string& topic, double rate_hz) override;
  Json Unsubscribe(std::int64_t sub) override;

 private:
  struct Slot {
    bool wanted = false;  ///< false: a notification
    std::optional<RequestId> id;
    std::string message;  ///< the answer, once it is there
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
    std::size_t bytes = 0;  ///< of the answers so far
    std::vector<Slot> slots;
  };
  /// An answer to come. Whoever makes it knows the connection weakly, and this by its number.
  struct Open {
    std::shared_ptr<Line> line;
    std::size_t index = 0;
    bool overtaken = false;
    std::function<void()> abandon;
  };
  class Reply;
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
  void Begin(Outcome outcome, const std::shared_ptr<Line>& line, std::size_t index);
  void Resolve(std::uint64_t number, Json result, const RpcError* error);
  void Answer(Line* line, Slot* slot, std::string message);
  void Fail(Line* line, Slot* slot, const RpcError& error);
  void ResumeInput();
  /// Runs one step; whatever it throws (no memory is left, most likely) ends this connection only.
  void Guard(const std::function<void()>& step);
  void Advance(const std::shared_ptr<Line>& line);
  void SendAnswers(const Line& line);
  void Send(std::string_view line);
  void Write();
  void OnWritten(std::error_code error, std::size_t size);
  void Close(const std::string& why);
  void MaybeClose();
  void StartSubscriptions();
  void Tick(std::int64_t sub);
  void OnTick(std::int64_t sub);
  void SendSample(std::int64_t sub, Subscription* subscription, const Sample& sample);
  /// No request is handled for the time being: an answer is due first, the output is full, or it is
  /// the others' turn.
  bool held() const { return gate_ || output_full_ || turn_over_; }
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
  bool output_full_ = false;    ///< what was asked for is to be read before more is asked for
  bool turn_over_ = false;      ///< other connections come first
  std::shared_ptr<Line> gate_;  ///< the line that holds up the lines after it
  std::map<std::uint64_t, Open> open_;
  std::uint64_t last_open_ = 0;
  std::size_t waiting_ = 0;  ///< answers to come that have been overtaken
  std::string writing_, pending_;
  std::size_t written_ = 0;
  std::size_t event_bytes_ = 0;  ///< at most so many of the unsent bytes are events
  bool write_active_ = false;
  std::chrono::steady_clock::time_point progress_{};
  std::map<std::int64_t, Subscription> subscriptions_;
  std::int64_t last_sub_ = 0;
};

}  // namespace regrasp
