#pragma once

/// Counts heap allocations of the whole process, libraries included, to test that a loop makes
/// none.

namespace regrasp {

/// Calls of malloc, calloc, realloc and aligned allocation so far, by any thread. Always 0 under a
/// sanitizer, which needs those functions for itself.
long AllocationCount();

/// False under a sanitizer.
bool CountsAllocations();

}  // namespace regrasp
