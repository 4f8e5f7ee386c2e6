#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "core/mcap/mcap_writer.h"

namespace regrasp {

struct McapMessage {
  std::string_view topic, schema, data;  ///< valid during the call
  std::uint64_t time = 0;                ///< [ns]
};

struct McapSummary {
  std::uint64_t messages = 0;
  bool complete = false;  ///< false: the file ends without an end, because its writer was killed
};

/// Calls `message` for every message in the order of the file, up to the last whole record. Throws
/// McapError: no MCAP file, a chunk whose checksum is wrong, a compression we do not know.
McapSummary ReadMcap(const std::string& path,
                     const std::function<void(const McapMessage&)>& message);

}  // namespace regrasp
