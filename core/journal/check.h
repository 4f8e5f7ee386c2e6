#pragma once

/// What a run file or a checkpoint says is held to be false until it is checked: every number has a
/// range, every index is one, every name is a name.

#include "core/journal/journal.h"

namespace regrasp {

/// Longest run that is read [ticks]: 115 days of 1 ms.
inline constexpr std::int64_t kMaxTick = 10'000'000'000;

/// Throws JournalError that names field, value and what is allowed.
void CheckConfig(const SessionConfig& config);
/// The same for a command of a run with this configuration (which has been checked).
void CheckEntry(const JournalEntry& entry, const SessionConfig& config);
/// For a number of a file: throws JournalError unless min <= value <= max.
void CheckRange(const char* what, double value, double min, double max);

}  // namespace regrasp
