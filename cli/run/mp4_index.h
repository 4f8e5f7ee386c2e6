#pragma once

#include <string>

namespace regrasp::run {

/// Moves the index of an MP4 file (box `moov`) from its end to the place before its data (`mdat`),
/// so that a player begins before it has the whole file. ISO/IEC 14496-12, sections 4.2 (boxes) and
/// 8.7.5 (chunk offsets, which count from the beginning of the file). A file that has it in front
/// already stays as it is. Throws std::runtime_error with path and cause: not such a file, or one
/// that cannot be written.
void PutIndexFirst(const std::string& path);

}  // namespace regrasp::run
