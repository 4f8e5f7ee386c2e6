// Memory kept back: in a process of its own, whose address space ends soon.

#include "daemon/server/memory_reserve.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <memory>
#include <new>
#include <thread>
#include <vector>

namespace regrasp {
namespace {

constexpr std::size_t kMiB = 1 << 20;

/// No more address space than now and `more` bytes.
void LimitMemory(std::size_t more) {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  rlimit limit{};
  ::getrlimit(RLIMIT_AS, &limit);
  limit.rlim_cur = pages * static_cast<std::size_t>(::getpagesize()) + more;
  ::setrlimit(RLIMIT_AS, &limit);
}

/// Takes all that there is; 0, or which expectation failed.
int TakeAll() {
  std::vector<std::unique_ptr<char[]>> held;
  held.reserve(1000);
  bool let_go_before_failing = false;
  try {
    for (;;) {
      held.push_back(std::make_unique<char[]>(kMiB));
      let_go_before_failing = let_go_before_failing || MemoryReserve::WasLetGo();
    }
  } catch (const std::bad_alloc&) {
  }
  if (!let_go_before_failing) return 2;
  if (!MemoryReserve::Spent()) return 3;
  held.clear();
  return MemoryReserve::Spent() ? 4 : 0;
}

/// More than once, and in another thread, whose memory comes from elsewhere.
int Exhaust() {
  MemoryReserve::Install(4 * kMiB);
  if (MemoryReserve::Spent() || MemoryReserve::WasLetGo()) return 1;
  int in_thread = 0;
  std::thread other([&] {
    std::make_unique<char[]>(1);  // its arena is there
    LimitMemory(32 * kMiB);
    in_thread = TakeAll();
  });
  other.join();
  if (in_thread != 0) return in_thread;
  for (int k = 0; k < 2; ++k)
    if (const int failed = TakeAll(); failed != 0) return 10 * (k + 1) + failed;
  return 0;
}

TEST(MemoryReserve, IsLetGoBeforeAnAllocationFailsAndTakenAgainWhenThereIsMore) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer needs the whole address space";
#endif
  EXPECT_EXIT(std::_Exit(Exhaust()), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace regrasp
