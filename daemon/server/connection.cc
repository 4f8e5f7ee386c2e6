#include "daemon/server/connection.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <asio/buffer.hpp>
#include <asio/post.hpp>
#include <exception>

#include "daemon/server/memory_reserve.h"
#include "daemon/server/socket.h"

namespace regrasp {
namespace {

constexpr std::size_t kMaxWaiting = 128;
constexpr int kLinesPerTurn = 32;  // handled before the others' turn

/// What is served while memory is short.
bool EndsSomething(std::string_view method) {
  constexpr std::string_view kEnds[] = {"version",     "status",      "stop",
                                        "release",     "pause",       "job.cancel",
                                        "record.stop", "unsubscribe", "shutdown"};
  return std::ranges::find(kEnds, method) != std::end(kEnds);
}

}  // namespace

/// What a handler answers with. Answers in its destructor if nobody has called it.
class Connection::Reply {
 public:
  Reply(std::weak_ptr<Connection> connection, std::uint64_t number)
      : connection_(std::move(connection)), number_(number) {}
  ~Reply() {
    if (called_) return;
    const auto connection = connection_.lock();
    if (!connection || connection->closed_) return;
    try {  // not from here: whoever drops it may be in the middle of something
      asio::post(connection->socket_.get_executor(), [connection, number = number_] {
        const RpcError error{ErrorCode::kInternal,
                             "the request was dropped",
                             "report this as a defect of regraspd",
                             {},
                             {}};
        connection->Resolve(number, {}, &error);
      });
    } catch (const std::exception&) {
      connection->Close("no memory for an answer");
    }
  }
  Reply(const Reply&) = delete;
  Reply& operator=(const Reply&) = delete;
  void operator()(Json result, const RpcError* error) {
    if (std::exchange(called_, true)) return;
    if (const auto connection = connection_.lock())
      connection->Resolve(number_, std::move(result), error);
  }

 private:
  std::weak_ptr<Connection> connection_;
  std::uint64_t number_;
  bool called_ = false;
};

void Connection::Guard(const std::function<void()>& step) {
  if (closed_) return;
  try {
    step();
  } catch (const std::exception& e) {
    spdlog::error("a connection ends: {}", e.what());
    Close("an error of this daemon");
  }
}

void Connection::Start() { Read(); }

void Connection::Read() {
  if (reading_ || closed_ || end_of_input_ || (held() && !discarding_)) return;
  reading_ = true;
  socket_.async_read_some(asio::buffer(buffer_),
                          [self = shared_from_this()](std::error_code error, std::size_t size) {
                            self->reading_ = false;
                            self->Guard([&] { error ? self->OnEndOfInput() : self->OnRead(size); });
                          });
}

void Connection::OnRead(std::size_t size) {
  if (!discarding_) {
    input_.append(buffer_.data(), size);
    ProcessInput();
  }
  Read();
}

void Connection::OnEndOfInput() {
  end_of_input_ = true;
  if (PeerGone(socket_.native_handle())) return Close("disconnected");
  // The peer has only finished sending ("printf ... | nc -U -N"): its last line needs no line end.
  if (!discarding_) ProcessInput();
  MaybeClose();
}

void Connection::ProcessInput() {
  if (processing_) return;
  processing_ = true;
  std::size_t begin = 0;
  for (int lines = 0; !held() && !closed_ && !discarding_; ++lines) {
    std::size_t end = input_.find('\n', std::max(begin, scanned_));
    if (end == std::string::npos) {
      scanned_ = input_.size();
      const std::size_t left = input_.size() - begin;
      // One byte more than a request may have: a '\r' that is still waiting for its '\n'.
      if (left > kMaxRequestBytes + 1 || (end_of_input_ && left > 0))
        end = input_.size();
      else
        break;
    }
    if (lines == kLinesPerTurn) {
      turn_over_ = true;
      asio::post(socket_.get_executor(), [self = shared_from_this()] {
        self->turn_over_ = false;
        self->Guard([&] { self->ResumeInput(); });
      });
      break;
    }
    HandleLine(std::string_view(input_).substr(begin, end - begin));
    begin = std::min(end + 1, input_.size());
    scanned_ = begin;
  }
  input_.erase(0, begin);
  scanned_ -= std::min(scanned_, begin);
  processing_ = false;
}

void Connection::ResumeInput() {
  ProcessInput();
  Read();
  MaybeClose();
}

void Connection::HandleLine(std::string_view text) {
  const RpcLine parsed = ParseLine(text);
  if (parsed.requests.empty()) return;
  const auto line = std::make_shared<Line>();
  line->batch = parsed.batch;
  line->slots.resize(parsed.requests.size());
  for (std::size_t i = 0; i < parsed.requests.size(); ++i)
    HandleRequest(parsed.requests[i], line, i);
  line->building = false;
  Advance(line);
  const auto& error = parsed.requests.front().error;
  if (error && error->code == ErrorCode::kTooLarge) {
    discarding_ = true;
    CloseWhenFlushed();
  }
}

void Connection::HandleRequest(const RpcRequest& request, const std::shared_ptr<Line>& line,
                               std::size_t index) {
  Slot& slot = line->slots[index];
  slot.id = request.id;
  slot.wanted = request.id.has_value();
  if (request.error) {
    if (request.error->code != ErrorCode::kInvalidParams) slot.wanted = true;
    return Fail(line.get(), &slot, *request.error);
  }
  try {
    if (MemoryReserve::Spent() && !EndsSomething(request.method))
      throw RpcException(ErrorCode::kBusy, "memory is short: nothing new is begun",
                         "stop what is not needed, then try again");
    Outcome outcome = owner_->service().Call(request.method, request.params, this);
    if (outcome.begin) return Begin(std::move(outcome), line, index);
    line->barrier = std::max(line->barrier, outcome.barrier);
    slot.later = std::move(outcome.later);
    if (!slot.later)
      Answer(line.get(), &slot,
             outcome.text.empty() ? ResultText(slot.id, outcome.result.dump())
                                  : ResultText(slot.id, outcome.text));
  } catch (const RpcException& e) {
    Fail(line.get(), &slot, e.error());
  } catch (const std::exception& e) {
    Fail(line.get(), &slot, InternalError(e));
  }
}

/// From here on the answer is Resolve()'s alone, whatever `begin` does.
void Connection::Begin(Outcome outcome, const std::shared_ptr<Line>& line, std::size_t index) {
  if (outcome.overtaken && waiting_ >= kMaxWaiting)
    throw RpcException(ErrorCode::kBusy, "too many waiting requests on this connection",
                       "open another connection");
  const std::uint64_t number = ++last_open_;
  const auto reply = std::make_shared<Reply>(weak_from_this(), number);
  open_.emplace(number, Open{line, index, outcome.overtaken, std::move(outcome.abandon)});
  ++(outcome.overtaken ? line->open_overtaken : line->open);
  if (outcome.overtaken) ++waiting_;
  try {
    outcome.begin(
        [reply](Json result, const RpcError* error) { (*reply)(std::move(result), error); });
  } catch (const RpcException& e) {
    (*reply)({}, &e.error());
  } catch (const std::exception& e) {
    const RpcError error = InternalError(e);
    (*reply)({}, &error);
  }
}

void Connection::Resolve(std::uint64_t number, Json result, const RpcError* error) {
  Guard([&] {
    const auto found = open_.extract(number);
    if (!found) return;
    const Open& open = found.mapped();
    Slot& slot = open.line->slots[open.index];
    --(open.overtaken ? open.line->open_overtaken : open.line->open);
    if (open.overtaken) --waiting_;
    if (error)
      Fail(open.line.get(), &slot, *error);
    else
      Answer(open.line.get(), &slot, ResultText(slot.id, ToText(result)));
    Advance(open.line);
    MaybeClose();
  });
}

void Connection::Fail(Line* line, Slot* slot, const RpcError& error) {
  Answer(line, slot, ToText(ErrorMessage(slot->id, error)));
}

void Connection::Answer(Line* line, Slot* slot, std::string message) {
  if (!slot->wanted) return;
  if (line->bytes + message.size() > kMaxAnswerBytes)
    message = ToText(ErrorMessage(
        slot->id, {ErrorCode::kTooLarge,
                   fmt::format("an answer line of more than {} bytes", kMaxAnswerBytes),
                   line->batch ? "send fewer requests in a batch" : "ask for less at a time",
                   {},
                   {}}));
  line->bytes += message.size();
  slot->message = std::move(message);
}

void Connection::Advance(const std::shared_ptr<Line>& line) {
  if (line->building) return;
  if (!line->released) {
    if (line->open > 0 || line->barrier > owner_->acknowledged()) {
      gate_ = line;
      return;
    }
    line->released = true;
    for (Slot& slot : line->slots) {
      if (!slot.later) continue;
      try {
        Answer(line.get(), &slot, ResultText(slot.id, ToText(slot.later())));
      } catch (const std::exception& e) {
        Fail(line.get(), &slot, InternalError(e));
      }
    }
  }
  const bool resume = gate_ == line;
  if (resume) gate_.reset();
  if (line->open_overtaken == 0) SendAnswers(*line);
  if (resume) ResumeInput();
}

void Connection::OnAcknowledged() {
  Guard([&] {
    if (gate_) Advance(std::shared_ptr<Line>(gate_));
  });
}

void Connection::SendAnswers(const Line& line) {
  std::string text;
  for (const Slot& slot : line.slots) {
    if (!slot.wanted) continue;
    text += text.empty() ? (line.batch ? "[" : "") : ",";
    text += slot.message;
  }
  if (!text.empty()) Send(text + (line.batch ? "]\n" : "\n"));
  StartSubscriptions();
}

}  // namespace regrasp
