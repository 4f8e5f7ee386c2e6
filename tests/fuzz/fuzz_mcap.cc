// A run file's container: an McapError, or messages that lie inside the file and losses that do.
//   cmake --preset fuzz && ninja -C build/fuzz fuzz_mcap && build/fuzz/tests/fuzz_mcap
//   -max_len=65536 tests/fuzz/corpus/mcap

#include "core/files/names.h"
#include "core/mcap/mcap_reader.h"
#include "tests/fuzz/model_file.h"

namespace {

using namespace regrasp;

void Require(bool condition) {
  if (!condition) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static ModelFile file;
  file.Write(data, size);
  std::uint64_t bytes = 0, count = 0;
  try {
    const McapSummary summary = ReadMcap(file.path(), [&](const McapMessage& message) {
      bytes += message.data.size();
      ++count;
      const std::string fault = FileNameFault(message.topic);
      Require(fault.empty() || IsUtf8(Shown(message.topic)));
    });
    Require(summary.messages == count);
    std::uint64_t end = 0;
    for (const McapLoss& loss : summary.lost) {
      Require(loss.bytes == 0 || loss.offset >= end);
      end = loss.offset + loss.bytes;
      Require(end <= size && !LossText(loss).empty());
    }
  } catch (const McapError&) {
  }
  Require(bytes <= size);
  return 0;
}
