#include "daemon/server/wake.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <system_error>

namespace regrasp {

Wake::Wake() : fd_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (fd_ < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
}

Wake::~Wake() { ::close(fd_); }

void Wake::Notify() {
  if (notified_.exchange(true)) return;
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = ::write(fd_, &one, sizeof one);
}

void Wake::WaitUntil(std::optional<std::chrono::steady_clock::time_point> until) {
  timespec timeout{};
  if (until) {
    const auto left = std::chrono::duration_cast<std::chrono::nanoseconds>(
                          *until - std::chrono::steady_clock::now())
                          .count();
    if (left <= 0) return;
    timeout.tv_sec = left / 1'000'000'000;
    timeout.tv_nsec = left % 1'000'000'000;
  }
  pollfd descriptor{fd_, POLLIN, 0};
  ::ppoll(&descriptor, 1, until ? &timeout : nullptr, nullptr);
}

void Wake::Clear() {
  if (!notified_.load(std::memory_order_acquire)) return;
  std::uint64_t count = 0;
  [[maybe_unused]] const auto got = ::read(fd_, &count, sizeof count);
  notified_.exchange(false);
}

}  // namespace regrasp
