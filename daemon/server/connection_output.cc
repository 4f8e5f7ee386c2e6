// What a connection sends, and how it ends.

#include <algorithm>
#include <asio/buffer.hpp>

#include "daemon/server/connection.h"
#include "daemon/server/socket.h"

namespace regrasp {
namespace {

/// Nothing more is asked of the daemon while so much is unsent, until half of it is written.
constexpr std::size_t kOutputFull = 256 * 1024;

}  // namespace

void Connection::Send(std::string_view line) {
  if (closed_) return;
  if (unsent() == 0) {
    progress_ = std::chrono::steady_clock::now();
    event_bytes_ = 0;
  }
  pending_ += line;
  output_full_ = output_full_ || unsent() > kOutputFull;
  Write();
}

void Connection::Write() {
  if (write_active_ || closed_) return;
  if (written_ == writing_.size()) {
    writing_.clear();
    written_ = 0;
    writing_.swap(pending_);
    if (writing_.capacity() > 2 * kOutputFull && writing_.empty()) writing_.shrink_to_fit();
  }
  if (writing_.empty()) return MaybeClose();
  write_active_ = true;
  socket_.async_write_some(asio::buffer(writing_.data() + written_, writing_.size() - written_),
                           [self = shared_from_this()](std::error_code error, std::size_t size) {
                             self->write_active_ = false;
                             self->Guard([&] { self->OnWritten(error, size); });
                           });
}

void Connection::OnWritten(std::error_code error, std::size_t size) {
  if (error) return Close("disconnected");
  written_ += size;
  progress_ = std::chrono::steady_clock::now();
  event_bytes_ = std::min(event_bytes_, unsent());
  Write();
  if (!output_full_ || unsent() > kOutputFull / 2) return;
  output_full_ = false;
  ResumeInput();
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
  if (end_of_input_ && !held() && waiting_ == 0 && subscriptions_.empty()) Close("disconnected");
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
  gate_.reset();
  for (auto& [number, open] : std::exchange(open_, {}))
    if (open.abandon) open.abandon();
  owner_->Closed(this, why);
}

}  // namespace regrasp
