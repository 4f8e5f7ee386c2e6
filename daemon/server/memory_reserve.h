#pragma once

/// Memory kept back for the moment when there is none. Where an allocation fails, the reserve is
/// let go and the allocation tried again, so that what is under way comes to its end; until the
/// reserve is there again, nothing new is begun.

#include <cstddef>

namespace regrasp {

class MemoryReserve {
 public:
  /// Takes `bytes`, and the process's new_handler. Once per process; any thread's allocations are
  /// served. Where there is no reserve left, allocations fail as without it (std::bad_alloc).
  static void Install(std::size_t bytes);
  /// Whether the reserve is gone and cannot be taken again; always false before Install.
  static bool Spent();
  /// Whether it was let go since the last call.
  static bool WasLetGo();
};

}  // namespace regrasp
