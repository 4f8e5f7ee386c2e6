#include "core/mcap/mcap_writer.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "core/mcap/mcap_format.h"

namespace regrasp {
namespace {

using namespace mcap;

constexpr std::size_t kChunkSize = 1 << 20;  // [bytes] a chunk is closed when it is this large

std::uint32_t Crc(std::string_view data) {
  return static_cast<std::uint32_t>(
      ::crc32(0, reinterpret_cast<const Bytef*>(data.data()), static_cast<uInt>(data.size())));
}

}  // namespace

McapWriter::McapWriter(const std::string& path) : path_(path) {
  fd_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (fd_ < 0) throw McapError("cannot create " + path + ": " + std::strerror(errno));
  Bytes header, file;
  header.AddText("");  // no profile
  header.AddText("regrasp");
  file.data.assign(kMagic.begin(), kMagic.end());
  file.AddRecord(kHeader, header.data);
  Put(file.data);
}

McapWriter::~McapWriter() {
  try {
    Finish();
  } catch (const McapError&) {
  }
}

std::uint16_t McapWriter::AddChannel(const std::string& topic, const std::string& schema_name,
                                     const std::string& schema) {
  sequence_.push_back(0);
  const auto number = static_cast<std::uint16_t>(sequence_.size());
  Bytes schema_record, channel_record, both;
  schema_record.Add(number);
  schema_record.AddText(schema_name);
  schema_record.AddText("jsonschema");
  schema_record.AddText(schema);
  channel_record.Add(number);
  channel_record.Add(number);  // its schema
  channel_record.AddText(topic);
  channel_record.AddText("json");
  channel_record.AddText("");  // no metadata
  both.AddRecord(kSchema, schema_record.data);
  both.AddRecord(kChannel, channel_record.data);
  definitions_ += both.data;
  Put(both.data);
  return number;
}

void McapWriter::Write(std::uint16_t channel, std::uint64_t time, std::string_view json) {
  if (records_.empty()) chunk_start_ = chunk_end_ = time;
  chunk_start_ = std::min(chunk_start_, time);
  chunk_end_ = std::max(chunk_end_, time);
  index_[channel].push_back({time, records_.size()});
  Bytes message, record;
  message.Add(channel);
  message.Add(sequence_[channel - 1u]++);
  message.Add(time);
  message.Add(time);
  message.data += json;
  record.AddRecord(kMessage, message.data);
  records_ += record.data;
  if (messages_++ == 0) start_ = time;
  start_ = std::min(start_, time);
  end_ = std::max(end_, time);
  if (records_.size() >= kChunkSize) Flush();
}

void McapWriter::Flush() {
  if (records_.empty()) return;
  Chunk chunk;
  chunk.start = chunk_start_;
  chunk.end = chunk_end_;
  chunk.offset = offset_;
  chunk.size = records_.size();
  Bytes content, file;
  content.Add(chunk.start);
  content.Add(chunk.end);
  content.Add(chunk.size);
  content.Add(Crc(records_));
  content.AddText("");  // no compression
  content.Add(chunk.size);
  content.data += records_;
  file.AddRecord(kChunk, content.data);
  chunk.length = file.data.size();
  for (const auto& [channel, entries] : index_) {
    chunk.index_offsets[channel] = offset_ + file.data.size();
    Bytes index;
    index.Add(channel);
    index.Add(static_cast<std::uint32_t>(entries.size() * 16));
    for (const Index& entry : entries) {
      index.Add(entry.time);
      index.Add(entry.offset);
    }
    file.AddRecord(kMessageIndex, index.data);
  }
  chunk.index_length = file.data.size() - chunk.length;
  records_.clear();
  index_.clear();
  Put(file.data);
  chunks_.push_back(std::move(chunk));
}

void McapWriter::Finish() {
  if (fd_ < 0) return;
  Flush();
  Bytes file;
  Bytes end;
  end.Add(std::uint32_t{0});  // no checksum of the data section
  file.AddRecord(kDataEnd, end.data);
  const std::uint64_t summary = offset_ + file.data.size();
  file.data += definitions_;
  for (const Chunk& chunk : chunks_) {
    Bytes index;
    index.Add(chunk.start);
    index.Add(chunk.end);
    index.Add(chunk.offset);
    index.Add(chunk.length);
    index.Add(static_cast<std::uint32_t>(chunk.index_offsets.size() * 10));
    for (const auto& [channel, offset] : chunk.index_offsets) {
      index.Add(channel);
      index.Add(offset);
    }
    index.Add(chunk.index_length);
    index.AddText("");
    index.Add(chunk.size);
    index.Add(chunk.size);
    file.AddRecord(kChunkIndex, index.data);
  }
  Bytes statistics;
  statistics.Add(messages_);
  statistics.Add(static_cast<std::uint16_t>(sequence_.size()));
  statistics.Add(static_cast<std::uint32_t>(sequence_.size()));
  statistics.Add(std::uint32_t{0});  // attachments
  statistics.Add(std::uint32_t{0});  // metadata
  statistics.Add(static_cast<std::uint32_t>(chunks_.size()));
  statistics.Add(start_);
  statistics.Add(end_);
  statistics.Add(static_cast<std::uint32_t>(sequence_.size() * 10));
  for (std::size_t i = 0; i < sequence_.size(); ++i) {
    statistics.Add(static_cast<std::uint16_t>(i + 1));
    statistics.Add(std::uint64_t{sequence_[i]});
  }
  file.AddRecord(kStatistics, statistics.data);
  Bytes footer;
  footer.Add(summary);
  footer.Add(std::uint64_t{0});  // no summary offsets
  footer.Add(std::uint32_t{0});  // no checksum of the summary
  file.AddRecord(kFooter, footer.data);
  file.data.append(kMagic.begin(), kMagic.end());
  Put(file.data);
  const bool there = HasItsName();
  const int fd = fd_;
  fd_ = -1;
  ::fsync(fd);  // some file systems cannot
  if (::close(fd) != 0) throw McapError("cannot write " + path_ + ": " + std::strerror(errno));
  if (!there)
    throw McapError("cannot write " + path_ +
                    ": the file was removed, renamed or replaced meanwhile");
}

bool McapWriter::HasItsName() const {
  struct stat open {
  }, named{};
  return ::fstat(fd_, &open) == 0 && ::stat(path_.c_str(), &named) == 0 &&
         open.st_dev == named.st_dev && open.st_ino == named.st_ino;
}

void McapWriter::Put(std::string_view data) {
  while (!data.empty()) {
    const ssize_t written = ::write(fd_, data.data(), data.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      const std::string cause = std::strerror(errno);
      ::close(fd_);
      fd_ = -1;
      throw McapError("cannot write " + path_ + ": " + cause);
    }
    data.remove_prefix(static_cast<std::size_t>(written));
    offset_ += static_cast<std::uint64_t>(written);
  }
}

}  // namespace regrasp
