#pragma once

namespace regrasp {

/// All that is known of a run file without an end.
inline constexpr const char* kWhyWithoutEnd =
    "it is being written elsewhere, its writer was killed, or it was cut";

}  // namespace regrasp
