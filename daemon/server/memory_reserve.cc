#include "daemon/server/memory_reserve.h"

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <new>

namespace regrasp {
namespace {

std::size_t size = 0;  // 0: not installed
std::atomic<void*> block{nullptr};
std::atomic<bool> let_go{false};

void* Take() {
  void* const taken = std::malloc(size);
  if (taken != nullptr) std::memset(taken, 1, size);  // the pages themselves, not a promise of them
  return taken;
}

void LetGo() {
  void* const kept = block.exchange(nullptr);
  if (kept == nullptr) throw std::bad_alloc();
  std::free(kept);
  let_go = true;
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
  if (!block.compare_exchange_strong(none, taken)) std::free(taken);
  return false;
}

bool MemoryReserve::WasLetGo() { return let_go.exchange(false); }

}  // namespace regrasp
