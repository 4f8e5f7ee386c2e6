#pragma once

/// Writes JSON messages into an MCAP file: append-only, in chunks without compression, with an
/// index at the end. A file whose writer was killed holds every chunk that was flushed.

#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace regrasp {

/// A file that cannot be written or read: path and cause.
class McapError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class McapWriter {
 public:
  /// Creates the file, which must not exist. Throws McapError.
  explicit McapWriter(const std::string& path);
  /// Finishes the file if nobody has; errors are lost then.
  ~McapWriter();
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  /// A topic with the name and the text of its JSON schema. Before the first message. Returns its
  /// number.
  std::uint16_t AddChannel(const std::string& topic, const std::string& schema_name,
                           const std::string& schema);
  /// Adds a message (JSON text) to the open chunk. `time` [ns]. Throws McapError.
  void Write(std::uint16_t channel, std::uint64_t time, std::string_view json);
  /// Writes the open chunk: what was added is in the file now.
  void Flush();
  /// Writes chunk, index and footer, and closes. Throws McapError also where the file does not have
  /// its name any more.
  void Finish();

  std::uint64_t bytes() const { return offset_; }  ///< in the file
  std::uint64_t messages() const { return messages_; }

 private:
  struct Index {
    std::uint64_t time = 0, offset = 0;
  };
  struct Chunk {
    std::uint64_t start = 0, end = 0, offset = 0, length = 0, size = 0, index_length = 0;
    std::map<std::uint16_t, std::uint64_t> index_offsets;
  };
  void Put(std::string_view data);
  /// Whether the name still is that of the open file.
  bool HasItsName() const;

  std::string path_;
  int fd_ = -1;
  std::uint64_t offset_ = 0, messages_ = 0, start_ = 0, end_ = 0;
  std::string definitions_;              ///< schema and channel records, for the summary
  std::vector<std::uint32_t> sequence_;  ///< messages by channel - 1
  std::string records_;                  ///< of the open chunk
  std::uint64_t chunk_start_ = 0, chunk_end_ = 0;
  std::map<std::uint16_t, std::vector<Index>> index_;  ///< of the open chunk
  std::vector<Chunk> chunks_;
};

}  // namespace regrasp
