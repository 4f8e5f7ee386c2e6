#include "daemon/server/memory_reserve.h"

#include <sys/mman.h>

#include <atomic>
#include <new>

namespace regrasp {
namespace {

std::size_t size = 0;  // 0: not installed
std::atomic<void*> block{nullptr};
std::atomic<bool> let_go{false};
std::atomic<unsigned> times{0};  // that it was let go

// Not malloc's: what it gives back may stay with one thread's arena.
void* Take() {
  void* const taken = ::mmap(nullptr, size, PROT_READ | PROT_WRITE,
                             MAP_PRIVATE | MAP_ANONYMOUS | MAP_POPULATE, -1, 0);
  return taken == MAP_FAILED ? nullptr : taken;
}

void GiveBack(void* taken) { ::munmap(taken, size); }

// Each thread tries once more for every time that the reserve was let go, by whomever.
void LetGo() {
  thread_local unsigned seen = 0;
  if (void* const kept = block.exchange(nullptr)) {
    GiveBack(kept);
    let_go = true;
    seen = ++times;
    return;
  }
  if (const unsigned now = times; now != seen) {
    seen = now;
    return;
  }
  throw std::bad_alloc();
}

}  // namespace

void MemoryReserve::Install(std::size_t bytes) {
  size = bytes;
  block = Take();
  std::set_new_handler(LetGo);
}

bool MemoryReserve::Spent() {
  if (size == 0 || block != nullptr) return false;
  void* const taken = Take();
  if (taken == nullptr) return true;
  void* none = nullptr;
  if (!block.compare_exchange_strong(none, taken)) GiveBack(taken);
  return false;
}

bool MemoryReserve::WasLetGo() { return let_go.exchange(false); }

}  // namespace regrasp
