// The subscriptions of a connection.

#include <fmt/format.h>

#include "daemon/server/connection.h"

namespace regrasp {
namespace {

constexpr std::size_t kMaxSubscriptions = 32;
/// Streams drop samples while more than this is unsent; answers and events are still queued.
constexpr std::size_t kStreamHighWater = 256 * 1024;

}  // namespace

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
    if (!error) self->Guard([&] { self->OnTick(sub); });
  });
}

void Connection::OnTick(std::int64_t sub) {
  const auto found = subscriptions_.find(sub);
  if (found == subscriptions_.end()) return;
  Subscription& subscription = found->second;
  // Catches up after a stall by skipping, not by a burst.
  subscription.timer.expires_at(std::max(subscription.timer.expiry() + subscription.period,
                                         std::chrono::steady_clock::now()));
  Service& service = owner_->service();
  // Where time stands still the same frame is told again: who counts samples does not hang.
  if (service.frame_number() != subscription.last_frame || !service.newest().advancing) {
    subscription.last_frame = service.frame_number();
    if (unsent() > kStreamHighWater)
      ++subscription.dropped;
    else
      SendSample(sub, &subscription, service.Topic(subscription.topic));
  }
  Tick(sub);
}

void Connection::OnEvent(const Sample& event) {
  Guard([&] {
    for (auto& [id, subscription] : subscriptions_) {
      if (closed_) return;
      if (subscription.topic != "events" || !subscription.started) continue;
      const std::size_t size = event.fields.size();
      if (event_bytes_ + size > owner_->limits().max_output_bytes)
        return Close("evicted: it does not read its events");
      SendSample(id, &subscription, event);
      event_bytes_ += size;
    }
  });
}

void Connection::SendSample(std::int64_t sub, Subscription* subscription, const Sample& sample) {
  // By hand: the fields are text already, made once for all who asked.
  Send(fmt::format(R"({{"jsonrpc":"2.0","method":"event","params":{{"sub":{},"topic":"{}",)"
                   R"("seq":{},"dropped":{},"t_s":{}{}{}}}}})"
                   "\n",
                   sub, subscription->topic, ++subscription->seq, subscription->dropped,
                   Json(sample.time_s).dump(), sample.fields.empty() ? "" : ",", sample.fields));
}

}  // namespace regrasp
