#pragma once

/// Reads MCAP files that may be damaged, or made by an enemy: what is whole is read, what is not is
/// named.

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/mcap/mcap_writer.h"

namespace regrasp {

struct McapMessage {
  std::string_view topic, schema_name, schema, data;  ///< valid during the call
  std::uint64_t time = 0;                             ///< [ns]
};

/// A stretch of the file that could not be read.
struct McapLoss {
  std::uint64_t offset = 0, bytes = 0;  ///< in the file
  std::uint64_t start = 0, end = 0;     ///< [ns] as the stretch itself says; both 0: unknown
  std::string cause;
};
/// "1048 bytes at 71234 (0.4 s ... 0.6 s): the checksum of a chunk is wrong".
std::string LossText(const McapLoss& loss);

struct McapSummary {
  std::uint64_t messages = 0;
  bool complete = false;  ///< false: the file ends without an end, because its writer was killed
  std::vector<McapLoss> lost;  ///< at most kMaxLosses, in the order of the file
  static constexpr std::size_t kMaxLosses = 1000;
};

/// A chunk as the index at the end of a whole file tells of it; nothing of it has been checked.
struct McapChunk {
  std::uint64_t offset = 0;          ///< in the file
  std::uint64_t start = 0, end = 0;  ///< [ns] of its messages
  std::set<std::string, std::less<>> topics;
};

/// Calls `message` for every message in the order of the file, up to the last whole record. A
/// damaged record is skipped, and the next whole chunk looked for. Throws McapError: no MCAP file,
/// no regular file, a compression we do not know.
McapSummary ReadMcap(const std::string& path,
                     const std::function<void(const McapMessage&)>& message);

/// The same, but only the chunks that are `wanted`; those that are not are neither read nor
/// checked. A file without an index (its writer was killed) is read whole.
McapSummary ReadMcap(const std::string& path,
                     const std::function<void(const McapMessage&)>& message,
                     const std::function<bool(const McapChunk&)>& wanted);

}  // namespace regrasp
