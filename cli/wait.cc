#include "cli/wait.h"

#include <poll.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "cli/errors.h"

namespace regrasp::cli {
namespace {

std::atomic<bool> g_interrupted = false;  // lock-free: set by the handler, read by every thread
int g_depth = 0;
sigset_t g_mask_before;
struct sigaction g_int_before, g_term_before;

void OnSignal(int) { g_interrupted = true; }

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
  sigaddset(&block, SIGINT);
  sigaddset(&block, SIGTERM);
  sigprocmask(SIG_BLOCK, &block, &g_mask_before);  // delivered only inside ppoll
  struct sigaction action = {};
  action.sa_handler = OnSignal;
  sigaction(SIGINT, &action, &g_int_before);
  sigaction(SIGTERM, &action, &g_term_before);
}

Interruptible::~Interruptible() {
  if (--g_depth > 0) return;
  sigaction(SIGINT, &g_int_before, nullptr);
  sigaction(SIGTERM, &g_term_before, nullptr);
  sigprocmask(SIG_SETMASK, &g_mask_before, nullptr);
}

void CheckInterrupt() {
  if (g_interrupted) throw CliError(kInterrupted, "interrupted");
}

bool WaitFor(int fd, short events, Clock::time_point deadline) {
  while (true) {
    CheckInterrupt();
    const auto left = std::max(deadline - Clock::now(), Clock::duration::zero());
    const auto ns = std::chrono::duration_cast<std::chrono::nanoseconds>(left).count();
    const timespec timeout{static_cast<time_t>(ns / 1'000'000'000),
                           static_cast<long>(ns % 1'000'000'000)};
    pollfd entry{fd, events, 0};
    const int n = ppoll(&entry, 1, &timeout, g_depth > 0 ? &g_mask_before : nullptr);
    if (n > 0) return true;
    if (n == 0) return false;
    if (errno != EINTR) throw CliError(kIo, std::string("waiting failed: ") + std::strerror(errno));
  }
}

}  // namespace regrasp::cli
