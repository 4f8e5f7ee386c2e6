// Interposed under a program (LD_PRELOAD): an allocation fails. The file NO_MEMORY holds a number
// of 4 bytes; every allocation, of any thread, counts it down while it is positive, and the one
// that brings it to zero finds no memory at its first try. Whoever writes the file chooses when.

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

using Countdown = std::atomic<int>;
static_assert(Countdown::is_always_lock_free && sizeof(Countdown) == 4);

Countdown* Map() {
  const char* path = std::getenv("NO_MEMORY");
  const int fd = path ? ::open(path, O_RDWR | O_CLOEXEC) : -1;
  if (fd < 0) return nullptr;
  void* page = ::mmap(nullptr, sizeof(Countdown), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  ::close(fd);
  return page == MAP_FAILED ? nullptr : static_cast<Countdown*>(page);
}

bool Fails() {
  static Countdown* const countdown = Map();
  if (!countdown || countdown->load(std::memory_order_relaxed) <= 0) return false;
  return countdown->fetch_sub(1) == 1;
}

}  // namespace

// As the standard has it: a new_handler may find memory for another try.
void* operator new(std::size_t size) {
  for (bool fails = Fails();; fails = false) {
    void* memory = fails ? nullptr : std::malloc(size > 0 ? size : 1);
    if (memory) return memory;
    const std::new_handler handler = std::get_new_handler();
    if (!handler) throw std::bad_alloc();
    handler();
  }
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
