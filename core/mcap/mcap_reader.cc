#include "core/mcap/mcap_reader.h"

#include <zlib.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>

#include "core/mcap/mcap_format.h"

namespace regrasp {
namespace {

using namespace mcap;

/// Reads numbers and strings off the front; `ok` turns false at the end of the data.
struct Cursor {
  std::string_view data;
  bool ok = true;
  std::string_view Take(std::uint64_t size) {
    if (size > data.size()) {
      ok = false;
      return {};
    }
    const std::string_view taken = data.substr(0, size);
    data.remove_prefix(size);
    return taken;
  }
  template <typename T>
  T Number() {
    const std::string_view bytes = Take(sizeof(T));
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i)
      value |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[i])) << (8 * i);
    return static_cast<T>(value);
  }
  std::string_view Text() { return Take(Number<std::uint32_t>()); }
};

class Reader {
 public:
  Reader(const std::string& path, const std::function<void(const McapMessage&)>& message)
      : path_(path), message_(message) {}

  /// Every whole record in `data`.
  void Records(std::string_view data) {
    Cursor cursor{data};
    while (!summary.complete) {
      const auto opcode = cursor.Number<std::uint8_t>();
      const auto length = cursor.Number<std::uint64_t>();
      const std::string_view content = cursor.Take(length);
      if (!cursor.ok) return;
      Record(opcode, {content});
    }
  }
  McapSummary summary;

 private:
  void Record(std::uint8_t opcode, Cursor content) {
    switch (opcode) {
      case kSchema: {
        const auto number = content.Number<std::uint16_t>();
        content.Text();  // name
        content.Text();  // encoding
        schemas_[number] = content.Text();
        break;
      }
      case kChannel: {
        const auto number = content.Number<std::uint16_t>();
        const auto schema = content.Number<std::uint16_t>();
        channels_[number] = {std::string(content.Text()), schemas_[schema]};
        break;
      }
      case kMessage: {
        const auto channel = content.Number<std::uint16_t>();
        content.Number<std::uint32_t>();
        McapMessage message;
        message.time = content.Number<std::uint64_t>();
        content.Number<std::uint64_t>();
        const auto found = channels_.find(channel);
        if (!content.ok || found == channels_.end()) throw McapError(path_ + ": a damaged message");
        message.topic = found->second.topic;
        message.schema = found->second.schema;
        message.data = content.data;
        ++summary.messages;
        message_(message);
        break;
      }
      case kChunk: {
        content.Take(24);  // times, size
        const auto crc = content.Number<std::uint32_t>();
        if (!content.Text().empty()) throw McapError(path_ + ": compressed, which is not read");
        const std::string_view records = content.Take(content.Number<std::uint64_t>());
        if (!content.ok) throw McapError(path_ + ": a damaged chunk");
        const auto found = ::crc32(0, reinterpret_cast<const Bytef*>(records.data()),
                                   static_cast<uInt>(records.size()));
        if (crc != 0 && crc != found) throw McapError(path_ + ": a chunk's checksum is wrong");
        Records(records);
        break;
      }
      case kDataEnd:
        summary.complete = true;
        break;
      default:
        break;
    }
  }

  const std::string& path_;
  const std::function<void(const McapMessage&)>& message_;
  struct Channel {
    std::string topic, schema;
  };
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, Channel> channels_;
};

}  // namespace

McapSummary ReadMcap(const std::string& path,
                     const std::function<void(const McapMessage&)>& message) {
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  const std::string data{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (!in)
    throw McapError("cannot read " + path + ": " +
                    (errno ? std::strerror(errno) : "unknown cause"));
  if (!data.starts_with(std::string_view(kMagic.data(), kMagic.size())))
    throw McapError(path + " is not an MCAP file");
  Reader reader(path, message);
  reader.Records(std::string_view(data).substr(kMagic.size()));
  return reader.summary;
}

}  // namespace regrasp
