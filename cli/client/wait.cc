#include "cli/client/wait.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "cli/client/errors.h"

namespace regrasp::cli {
namespace {

std::atomic<int> g_signal = 0;  // lock-free: set by the handler, read by every thread
int g_depth = 0;
constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT};
sigset_t g_mask_before;
struct sigaction g_before[std::size(kSignals)];

void OnSignal(int number) { g_signal = number; }

}  // namespace

Clock::time_point Deadline(double seconds) {
  constexpr double kNoLimit = 365.0 * 86400;
  const double s = seconds > 0 ? std::min(seconds, kNoLimit) : kNoLimit;
  return Clock::now() +
         std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
}

Interruptible::Interruptible() {
  if (g_depth++ > 0) return;
  sigset_t block;
  sigemptyset(&block);
  for (const int signal : kSignals) sigaddset(&block, signal);
  sigprocmask(SIG_BLOCK, &block, &g_mask_before);  // delivered only inside ppoll
  struct sigaction action = {};
  action.sa_handler = OnSignal;
  for (std::size_t i = 0; i < std::size(kSignals); ++i) {
    sigaction(kSignals[i], &action, &g_before[i]);
    // As nohup has it.
    if (kSignals[i] == SIGHUP && g_before[i].sa_handler == SIG_IGN)
      sigaction(SIGHUP, &g_before[i], nullptr);
  }
}

Interruptible::~Interruptible() {
  if (--g_depth > 0) return;
  g_signal = 0;  // what ended this wait ends no later one
  for (std::size_t i = 0; i < std::size(kSignals); ++i)
    sigaction(kSignals[i], &g_before[i], nullptr);
  sigprocmask(SIG_SETMASK, &g_mask_before, nullptr);
}

int SignalReceived() { return g_signal; }

void CheckInterrupt() {
  if (g_signal != 0) throw CliError(kInterrupted, "interrupted");
}

namespace {

/// ppoll until the deadline; -1 when a signal came.
int Poll(std::span<pollfd> fds, Clock::time_point deadline) {
  CheckInterrupt();
  const auto left = std::max(deadline - Clock::now(), Clock::duration::zero());
  const auto ns = std::chrono::duration_cast<std::chrono::nanoseconds>(left).count();
  const timespec timeout{static_cast<time_t>(ns / 1'000'000'000),
                         static_cast<long>(ns % 1'000'000'000)};
  const int n = ppoll(fds.data(), fds.size(), &timeout, g_depth > 0 ? &g_mask_before : nullptr);
  if (n >= 0) return n;
  if (errno != EINTR) throw CliError(kIo, std::string("waiting failed: ") + std::strerror(errno));
  CheckInterrupt();
  return -1;
}

}  // namespace

bool WaitFor(int fd, short events, Clock::time_point deadline) {
  pollfd entry{fd, events, 0};
  int n = -1;
  while (n < 0) n = Poll({&entry, 1}, deadline);
  return n > 0;
}

void WaitForAny(std::span<pollfd> fds, Clock::time_point deadline) {
  for (pollfd& entry : fds) entry.revents = 0;
  if (Poll(fds, deadline) < 0)
    for (pollfd& entry : fds) entry.revents = 0;
}

}  // namespace regrasp::cli
