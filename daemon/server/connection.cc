#include "daemon/server/connection.h"

#include <asio/buffer.hpp>
#include <exception>

#include "daemon/server/socket.h"
#include "daemon/wire/frame_json.h"

namespace regrasp {
namespace {

constexpr std::size_t kMaxSubscriptions = 32;
constexpr std::size_t kMaxWaiting = 128;
/// Streams drop samples while more than this is unsent; answers and events are still queued.
constexpr std::size_t kStreamHighWater = 256 * 1024;

}  // namespace

void Connection::Start() { Read(); }

void Connection::Read() {
  if (reading_ || closed_ || end_of_input_ || (gate_ && !discarding_)) return;
  reading_ = true;
  socket_.async_read_some(asio::buffer(buffer_),
                          [self = shared_from_this()](std::error_code error, std::size_t size) {
                            self->reading_ = false;
                            if (self->closed_) return;
                            if (error)
                              self->OnEndOfInput();
                            else
                              self->OnRead(size);
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
  while (!gate_ && !closed_ && !discarding_) {
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
    HandleLine(std::string_view(input_).substr(begin, end - begin));
    begin = std::min(end + 1, input_.size());
    scanned_ = begin;
  }
  input_.erase(0, begin);
  scanned_ -= std::min(scanned_, begin);
  processing_ = false;
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
  slot.answered = request.id.has_value();
  if (request.error) {
    if (request.error->code != ErrorCode::kInvalidParams) slot.answered = true;
    slot.message = ErrorMessage(request.id, *request.error);
    return;
  }
  try {
    Outcome outcome = owner_->service().Call(request.method, request.params, this);
    if (!outcome.begin) {
      line->barrier = std::max(line->barrier, outcome.barrier);
      slot.later = std::move(outcome.later);
      slot.message = ResultMessage(request.id, std::move(outcome.result));
      return;
    }
    const bool overtaken = outcome.overtaken;
    if (overtaken && waiting_ >= kMaxWaiting)
      throw RpcException(ErrorCode::kBusy, "too many waiting requests on this connection",
                         "open another connection");
    ++(overtaken ? line->open_overtaken : line->open);
    if (overtaken) ++waiting_;
    outcome.begin(
        [weak = weak_from_this(), line, index, overtaken](Json result, const RpcError* error) {
          Slot& done = line->slots[index];
          done.message =
              error ? ErrorMessage(done.id, *error) : ResultMessage(done.id, std::move(result));
          --(overtaken ? line->open_overtaken : line->open);
          const auto self = weak.lock();
          if (!self || self->closed_) return;
          if (overtaken) --self->waiting_;
          self->Advance(line);
          self->MaybeClose();
        });
  } catch (const RpcException& e) {
    slot.message = ErrorMessage(request.id, e.error());
  } catch (const std::exception& e) {
    slot.message = ErrorMessage(
        request.id,
        {ErrorCode::kInternal, e.what(), "report this as a defect of regraspd", {}, {}});
  }
}

void Connection::Advance(const std::shared_ptr<Line>& line) {
  if (line->building) return;
  if (!line->released) {
    if (line->open > 0 || line->barrier > owner_->acknowledged()) {
      gate_ = line;
      return;
    }
    line->released = true;
    for (Slot& slot : line->slots)
      if (slot.later) slot.message = ResultMessage(slot.id, slot.later());
  }
  const bool resume = gate_ == line;
  if (resume) gate_.reset();
  if (line->open_overtaken == 0) SendAnswers(*line);
  if (resume) {
    ProcessInput();
    Read();
    MaybeClose();
  }
}

void Connection::OnAcknowledged() {
  if (gate_) Advance(std::shared_ptr<Line>(gate_));
}

void Connection::SendAnswers(const Line& line) {
  Json answers = Json::array();
  for (const Slot& slot : line.slots) {
    if (!slot.answered) continue;
    if (line.batch)
      answers.push_back(slot.message);
    else
      Send(ToLine(slot.message));
  }
  if (!answers.empty()) Send(ToLine(answers));
  StartSubscriptions();
}

void Connection::Send(std::string line) {
  if (closed_) return;
  if (unsent() + line.size() > owner_->limits().max_output_bytes)
    return Close("evicted: it does not read its answers");
  if (unsent() == 0) progress_ = std::chrono::steady_clock::now();
  pending_ += line;
  Write();
}

void Connection::Write() {
  if (write_active_ || closed_) return;
  if (written_ == writing_.size()) {
    writing_.clear();
    written_ = 0;
    writing_.swap(pending_);
  }
  if (writing_.empty()) return MaybeClose();
  write_active_ = true;
  socket_.async_write_some(asio::buffer(writing_.data() + written_, writing_.size() - written_),
                           [self = shared_from_this()](std::error_code error, std::size_t size) {
                             self->write_active_ = false;
                             if (self->closed_) return;
                             if (error) return self->Close("disconnected");
                             self->written_ += size;
                             self->progress_ = std::chrono::steady_clock::now();
                             self->Write();
                           });
}

void Connection::CloseWhenFlushed() {
  closing_ = true;
  MaybeClose();
}

void Connection::MaybeClose() {
  if (closed_ || unsent() > 0) return;
  if (closing_ && discarding_ && !end_of_input_) {
    // The peer may still be writing its over-long line: closing now would lose the answer.
    std::error_code ignored;
    socket_.shutdown(Socket::shutdown_send, ignored);
    return;
  }
  if (closing_) return Close("closed");
  if (end_of_input_ && !gate_ && waiting_ == 0 && subscriptions_.empty()) Close("disconnected");
}

void Connection::CheckHealth(std::chrono::steady_clock::time_point now) {
  const auto idle = now - progress_;
  if (unsent() > 0 && idle > owner_->limits().max_stall) return Close("evicted: no progress");
  if (discarding_ && unsent() == 0 && idle > std::chrono::seconds(1)) return Close("closed");
  if (end_of_input_ && PeerGone(socket_.native_handle())) Close("disconnected");
}

void Connection::Close(const std::string& why) {
  if (closed_) return;
  closed_ = true;
  for (auto& [id, subscription] : subscriptions_) subscription.timer.cancel();
  std::error_code ignored;
  socket_.close(ignored);
  owner_->Closed(this, why);
}

std::int64_t Connection::Subscribe(const std::string& topic, double rate_hz) {
  if (subscriptions_.size() >= kMaxSubscriptions)
    throw RpcException(ErrorCode::kBusy, "too many subscriptions on this connection",
                       "unsubscribe from one, or open another connection");
  const auto period = std::chrono::duration_cast<std::chrono::steady_clock::duration>(
      std::chrono::duration<double>(1.0 / rate_hz));
  subscriptions_.emplace(++last_sub_,
                         Subscription{topic, period, asio::steady_timer(socket_.get_executor())});
  return last_sub_;
}

Json Connection::Unsubscribe(std::int64_t sub) {
  const auto it = subscriptions_.find(sub);
  if (it == subscriptions_.end()) return {};
  Json last = {{"sub", sub}, {"seq", it->second.seq}, {"dropped", it->second.dropped}};
  it->second.timer.cancel();
  subscriptions_.erase(it);
  return last;
}

void Connection::StartSubscriptions() {
  for (auto& [id, subscription] : subscriptions_) {
    if (subscription.started) continue;
    subscription.started = true;
    if (subscription.topic == "events") continue;
    subscription.timer.expires_at(std::chrono::steady_clock::now());
    Tick(id);
  }
}

void Connection::Tick(std::int64_t sub) {
  const auto it = subscriptions_.find(sub);
  if (it == subscriptions_.end() || closed_) return;
  it->second.timer.async_wait([self = shared_from_this(), sub](std::error_code error) {
    const auto found = self->subscriptions_.find(sub);
    if (error || self->closed_ || found == self->subscriptions_.end()) return;
    Subscription& subscription = found->second;
    // Catches up after a stall by skipping, not by a burst.
    subscription.timer.expires_at(std::max(subscription.timer.expiry() + subscription.period,
                                           std::chrono::steady_clock::now()));
    Service& service = self->owner_->service();
    // Where time stands still the same frame is told again: who counts samples does not hang.
    if (service.frame_number() != subscription.last_frame || !service.newest().advancing) {
      subscription.last_frame = service.frame_number();
      if (self->unsent() > kStreamHighWater)
        ++subscription.dropped;
      else
        self->SendSample(sub, &subscription, service.Topic(subscription.topic));
    }
    self->Tick(sub);
  });
}

void Connection::OnEvent(const Event& event) {
  for (auto& [id, subscription] : subscriptions_) {
    if (closed_) return;
    if (subscription.topic != "events" || !subscription.started) continue;
    Service& service = owner_->service();
    SendSample(id, &subscription, EventJson(event, service.hand(), service.dt()));
  }
}

void Connection::SendSample(std::int64_t sub, Subscription* subscription, Json fields) {
  const double t_s =
      fields.contains("t_s") ? fields["t_s"].get<double>() : fields.value("time_s", 0.0);
  Json params = {{"sub", sub},
                 {"topic", subscription->topic},
                 {"seq", ++subscription->seq},
                 {"dropped", subscription->dropped},
                 {"t_s", t_s}};
  params.update(fields);
  Send(ToLine(NotificationMessage("event", std::move(params))));
}

}  // namespace regrasp
