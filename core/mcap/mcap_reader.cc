#include "core/mcap/mcap_reader.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <optional>

#include "core/mcap/mcap_bytes.h"
#include "core/mcap/mcap_format.h"

namespace regrasp {
namespace {

using namespace mcap;

/// More than this in one record is taken for a damaged length. Our chunks have 1 MiB.
constexpr std::uint64_t kMaxRecord = 256u << 20;
constexpr std::uint64_t kChunkHead = 40;  // times, size, checksum, no compression, size
constexpr std::uint64_t kFooterRecord = kRecordHead + 20;
constexpr std::uint64_t kWindow = 1u << 20;  // bytes looked at together while searching

struct Chunk {
  std::uint64_t start = 0, end = 0;
  std::uint32_t crc = 0;
  std::string_view records;
};

/// The schemas and channels of a file by their numbers.
class Definitions {
 public:
  struct Schema {
    std::string name, text;
  };
  struct Channel {
    std::string topic;
    Schema schema;
  };
  /// False: damaged, or another than before. Those of the summary section come first, and are
  /// believed.
  bool Add(std::uint8_t opcode, Cursor content, bool of_summary) {
    const auto number = content.Number<std::uint16_t>();
    if (opcode == kSchema) {
      const std::string_view name = content.Text();
      content.Text();  // encoding
      const std::string_view schema = content.Text();
      if (!content.whole()) return false;
      const auto known =
          schemas_.try_emplace(number, Schema{std::string(name), std::string(schema)});
      return of_summary || known.first->second.text == schema;
    }
    const auto schema = content.Number<std::uint16_t>();
    const std::string_view topic = content.Text();
    content.Text();  // encoding
    content.Text();  // metadata
    if (!content.whole()) return false;
    const auto known =
        channels_.try_emplace(number, Channel{std::string(topic), schemas_[schema]}).first;
    return of_summary || known->second.topic == topic;
  }

  /// Null where there is none of this number.
  const Channel* FindChannel(std::uint16_t number) const {
    const auto found = channels_.find(number);
    return found == channels_.end() ? nullptr : &found->second;
  }

 private:
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, Channel> channels_;
};

/// What the end of a file says is in it.
struct Index {
  std::vector<McapChunk> chunks;  ///< in the order of the file
  std::uint64_t messages = 0;
};

McapChunk ChunkOf(Cursor content, const Definitions& definitions) {
  McapChunk chunk;
  chunk.start = content.Number<std::uint64_t>();
  chunk.end = content.Number<std::uint64_t>();
  chunk.offset = content.Number<std::uint64_t>();
  content.Number<std::uint64_t>();  // length
  Cursor channels{content.Text()};
  while (channels.ok && !channels.data.empty()) {
    const auto* known = definitions.FindChannel(channels.Number<std::uint16_t>());
    channels.Number<std::uint64_t>();  // where its index is
    if (known != nullptr) chunk.topics.insert(known->topic);
  }
  return chunk;
}

/// What the end of a whole file repeats; it goes into `definitions`, too. Empty where there is
/// none.
Index ReadIndex(const File& file, Definitions* definitions) {
  Index index;
  const std::uint64_t tail = kFooterRecord + kMagic.size();
  if (file.size() < tail + kMagic.size()) return index;
  const std::string end = file.At(file.size() - tail, tail);
  if (!end.ends_with(std::string_view(kMagic.data(), kMagic.size()))) return index;
  Cursor footer{end};
  if (footer.Number<std::uint8_t>() != kFooter || footer.Number<std::uint64_t>() != 20)
    return index;
  const auto begin = footer.Number<std::uint64_t>();
  const std::uint64_t limit = file.size() - tail;
  if (begin == 0 || begin > limit || limit - begin > kMaxRecord) return index;
  const std::string section = file.At(begin, limit - begin);
  Cursor cursor{section};
  while (!cursor.data.empty()) {
    const auto opcode = cursor.Number<std::uint8_t>();
    const std::string_view content = cursor.Take(cursor.Number<std::uint64_t>());
    if (!cursor.ok) return index;
    if (opcode == kSchema || opcode == kChannel) definitions->Add(opcode, {content}, true);
    if (opcode == kStatistics) index.messages = Cursor{content}.Number<std::uint64_t>();
    if (opcode == kChunkIndex) index.chunks.push_back(ChunkOf({content}, *definitions));
  }
  // An index that leads around in the file is none.
  if (!std::ranges::is_sorted(index.chunks, std::less_equal<>(), &McapChunk::offset))
    index.chunks.clear();
  return index;
}

/// Nothing when the record is no chunk of ours.
std::optional<Chunk> ParseChunk(std::string_view data, std::string_view* compression) {
  Cursor content{data};
  Chunk chunk;
  chunk.start = content.Number<std::uint64_t>();
  chunk.end = content.Number<std::uint64_t>();
  const auto size = content.Number<std::uint64_t>();
  chunk.crc = content.Number<std::uint32_t>();
  *compression = content.Text();
  chunk.records = content.Take(content.Number<std::uint64_t>());
  if (!content.whole() || (compression->empty() && chunk.records.size() != size)) return {};
  return chunk;
}

/// The next whole chunk with a right checksum from `offset` on.
std::optional<std::uint64_t> FindChunk(const File& file, std::uint64_t offset) {
  for (std::uint64_t base = offset; base < file.size(); base += kWindow) {
    const std::string window = file.At(base, kWindow + kRecordHead + kChunkHead);
    for (std::size_t i = 0; i < std::min<std::size_t>(kWindow, window.size()); ++i) {
      if (window[i] != kChunk) continue;
      Cursor head{std::string_view(window).substr(i + 1)};
      const auto length = head.Number<std::uint64_t>();
      head.Take(16);
      const auto size = head.Number<std::uint64_t>();
      const auto crc = head.Number<std::uint32_t>();
      const auto compression = head.Number<std::uint32_t>();
      if (!head.ok || compression != 0 || crc == 0 || size > kMaxRecord ||
          length != size + kChunkHead)
        continue;
      const std::string records = file.At(base + i + kRecordHead + kChunkHead, size);
      if (records.size() == size && Crc(records) == crc) return base + i;
    }
  }
  return {};
}

class Reader {
 public:
  Reader(const std::string& path, const std::function<void(const McapMessage&)>& message)
      : path_(path), file_(path), message_(message) {}

  McapSummary Read() {
    Open();
    std::uint64_t offset = kMagic.size();
    while (!summary_.complete) {
      const auto next = OneRecord(offset);
      if (!next) break;
      offset = *next;
    }
    if (summary_.complete) FindStatistics(offset);
    if (index_.messages != 0 && index_.messages != summary_.messages && summary_.lost.empty())
      Lose({0, 0, 0, 0,
            "the file counts " + std::to_string(index_.messages) + " messages, " +
                std::to_string(summary_.messages) + " were found"});
    return std::move(summary_);
  }

  McapSummary Read(const std::function<bool(const McapChunk&)>& wanted) {
    Open();
    if (index_.chunks.empty()) return Read();
    for (const McapChunk& chunk : index_.chunks)
      if (wanted(chunk)) OneRecord(chunk.offset);
    summary_.complete = true;
    return std::move(summary_);
  }

 private:
  void Open() {
    if (file_.At(0, kMagic.size()) != std::string_view(kMagic.data(), kMagic.size()))
      throw McapError(path_ + " is not an MCAP file");
    index_ = ReadIndex(file_, &definitions_);
  }

  /// What stands behind the data, from `offset` on, where the file's end does not lead to it: parts
  /// of the file were taken out or put in.
  void FindStatistics(std::uint64_t offset) {
    while (index_.messages == 0) {
      const std::string head = file_.At(offset, kRecordHead);
      Cursor cursor{head};
      const auto opcode = cursor.Number<std::uint8_t>();
      const auto length = cursor.Number<std::uint64_t>();
      if (!cursor.ok || opcode == kFooter || length > kMaxRecord) return;
      const std::string content = file_.At(offset + kRecordHead, length);
      if (content.size() < length) return;
      if (opcode == kStatistics) index_.messages = Cursor{content}.Number<std::uint64_t>();
      offset += kRecordHead + length;
    }
  }

  /// Reads what stands at `offset`; returns where the next record is, or nothing at the end.
  std::optional<std::uint64_t> OneRecord(std::uint64_t offset) {
    const std::string head = file_.At(offset, kRecordHead);
    if (head.size() < kRecordHead) return {};
    Cursor cursor{head};
    const auto opcode = cursor.Number<std::uint8_t>();
    const auto length = cursor.Number<std::uint64_t>();
    // A length beyond the end: the writer was killed there, or it is damaged and more follows.
    const bool fits = length <= file_.size() - offset - kRecordHead;
    if (fits && length <= kMaxRecord && opcode != 0) {
      const std::string content = file_.At(offset + kRecordHead, length);
      McapLoss loss;
      if (Record(opcode, content, &loss)) return offset + kRecordHead + length;
      if (loss.bytes != 0) {  // the frame is whole, its content is not
        loss.offset = offset;
        loss.bytes = kRecordHead + length;
        Lose(std::move(loss));
        return offset + kRecordHead + length;
      }
    }
    const auto next = FindChunk(file_, offset + 1);
    if (!next && !fits) return {};
    const std::uint64_t until = next.value_or(file_.size());
    Lose({offset, until - offset, 0, 0, "a damaged record"});
    return next;
  }

  /// False: damaged. With loss->bytes set, only the content is.
  bool Record(std::uint8_t opcode, std::string_view data, McapLoss* loss) {
    Cursor content{data};
    switch (opcode) {
      case kHeader:
        content.Text();
        content.Text();
        return content.whole();
      case kSchema:
      case kChannel:
        return definitions_.Add(opcode, content, false);
      case kMessage:
        if (Message(content)) return true;
        *loss = {0, 1, 0, 0, "a message of no channel"};
        return false;
      case kChunk:
        return ReadChunk(data, loss);
      case kMessageIndex:
        content.Number<std::uint16_t>();
        content.Text();
        return content.whole();
      case kDataEnd:
        summary_.complete = data.size() == 4;
        return summary_.complete;
      default:
        return opcode <= kDataEnd || opcode >= 0x80;  // others are for programs of their own
    }
  }

  bool Message(Cursor content) {
    const auto channel = content.Number<std::uint16_t>();
    content.Number<std::uint32_t>();  // sequence
    McapMessage message;
    message.time = content.Number<std::uint64_t>();
    content.Number<std::uint64_t>();  // of publication
    const auto* found = definitions_.FindChannel(channel);
    if (!content.ok || found == nullptr) return false;
    message.topic = found->topic;
    message.schema_name = found->schema.name;
    message.schema = found->schema.text;
    message.data = content.data;
    ++summary_.messages;
    message_(message);
    return true;
  }

  bool ReadChunk(std::string_view data, McapLoss* loss) {
    std::string_view compression;
    const auto chunk = ParseChunk(data, &compression);
    if (compression == "lz4" || compression == "zstd")
      throw McapError(path_ + ": compressed (" + std::string(compression) + "), which is not read");
    if (!chunk || !compression.empty()) return false;
    *loss = {0, 1, chunk->start, chunk->end, "the checksum of a chunk is wrong"};
    if (chunk->crc != 0 && chunk->crc != Crc(chunk->records)) return false;
    loss->cause = "a damaged record in a chunk";
    Cursor records{chunk->records};
    while (!records.data.empty()) {
      const auto opcode = records.Number<std::uint8_t>();
      const std::string_view content = records.Take(records.Number<std::uint64_t>());
      if (!records.ok) return false;
      const bool good = opcode == kMessage ? Message({content})
                        : opcode == kSchema || opcode == kChannel
                            ? definitions_.Add(opcode, {content}, false)
                            : opcode >= 0x80;  // chunks hold no chunks
      if (!good) return false;
    }
    return true;
  }

  void Lose(McapLoss loss) {
    if (summary_.lost.size() < McapSummary::kMaxLosses) summary_.lost.push_back(std::move(loss));
  }

  const std::string path_;
  const File file_;
  const std::function<void(const McapMessage&)>& message_;
  Definitions definitions_;
  Index index_;
  McapSummary summary_;
};

}  // namespace

std::string LossText(const McapLoss& loss) {
  std::string text;
  if (loss.bytes != 0)
    text = std::to_string(loss.bytes) + " bytes at " + std::to_string(loss.offset);
  if (loss.start != 0 || loss.end != 0) {
    char times[64];
    std::snprintf(times, sizeof times, " (%.3f s ... %.3f s)",
                  static_cast<double>(loss.start) * 1e-9, static_cast<double>(loss.end) * 1e-9);
    text += times;
  }
  return text + (text.empty() ? "" : ": ") + loss.cause;
}

McapSummary ReadMcap(const std::string& path,
                     const std::function<void(const McapMessage&)>& message) {
  return Reader(path, message).Read();
}

McapSummary ReadMcap(const std::string& path,
                     const std::function<void(const McapMessage&)>& message,
                     const std::function<bool(const McapChunk&)>& wanted) {
  return Reader(path, message).Read(wanted);
}

}  // namespace regrasp
