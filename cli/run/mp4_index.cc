#include "cli/run/mp4_index.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "cli/run/write_failure.h"

namespace regrasp::run {
namespace {

std::uint64_t Number(std::string_view data, std::size_t at, int bytes) {
  if (at + static_cast<std::size_t>(bytes) > data.size())
    throw std::runtime_error("a box ends early");
  std::uint64_t number = 0;
  for (int i = 0; i < bytes; ++i)
    number = number << 8 | static_cast<unsigned char>(data[at + static_cast<std::size_t>(i)]);
  return number;
}

void SetNumber(std::string* data, std::size_t at, int bytes, std::uint64_t number) {
  for (int i = bytes - 1; i >= 0; --i, number >>= 8)
    (*data)[at + static_cast<std::size_t>(i)] = static_cast<char>(number & 0xff);
  if (number != 0) throw std::runtime_error("an offset beyond 4 GB");
}

struct Box {
  std::size_t begin = 0, content = 0, end = 0;
  std::string_view type;
};

Box BoxAt(std::string_view data, std::size_t at, std::size_t end) {
  std::uint64_t size = Number(data, at, 8) >> 32;  // all of the head is there
  Box box{at, at + 8, 0, data.substr(at + 4, 4)};
  if (size == 1) {
    size = Number(data, at + 8, 8);
    box.content += 8;
  }
  if (size == 0) size = end - at;  // up to the end
  if (size < box.content - at || size > end - at) throw std::runtime_error("a box of a wrong size");
  box.end = at + size;
  return box;
}

/// Adds `shift` to every chunk offset in the boxes of [begin, end).
void ShiftOffsets(std::string* data, std::size_t begin, std::size_t end, std::uint64_t shift) {
  while (begin < end) {
    const Box box = BoxAt(*data, begin, end);
    begin = box.end;
    for (const char* container : {"moov", "trak", "mdia", "minf", "stbl"})
      if (box.type == container) ShiftOffsets(data, box.content, box.end, shift);
    if (box.type != "stco" && box.type != "co64") continue;
    const int bytes = box.type == "stco" ? 4 : 8;
    const std::uint64_t count = Number(*data, box.content + 4, 4);  // after version and flags
    for (std::uint64_t i = 0; i < count; ++i) {
      const std::size_t at = box.content + 8 + i * static_cast<std::size_t>(bytes);
      SetNumber(data, at, bytes, Number(*data, at, bytes) + shift);
    }
  }
}

/// The same file with the index in front; nothing where it is there already.
std::optional<std::string> IndexFirst(const std::string& data) {
  std::optional<Box> index, media;
  for (std::size_t at = 0; at < data.size();) {
    const Box box = BoxAt(data, at, data.size());
    if (box.type == "moov") index = box;
    if (box.type == "mdat" && !media) media = box;
    at = box.end;
  }
  if (!index || !media) throw std::runtime_error("it has no index or no data");
  if (index->begin < media->begin) return std::nullopt;
  std::string moov = data.substr(index->begin, index->end - index->begin);
  ShiftOffsets(&moov, 0, moov.size(), moov.size());
  return data.substr(0, media->begin) + moov +
         data.substr(media->begin, index->begin - media->begin) + data.substr(index->end);
}

}  // namespace

void PutIndexFirst(const std::string& path) {
  try {
    std::ifstream in(path, std::ios::binary);
    const std::string data{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    if (!in || data.empty()) throw std::runtime_error("it cannot be read");
    const std::optional<std::string> mended = IndexFirst(data);
    if (!mended) return;
    std::ofstream out(path, std::ios::binary | std::ios::trunc);
    out << *mended;
    out.flush();
    if (!out) throw std::runtime_error("it cannot be written");
  } catch (const std::runtime_error& e) {
    const std::string cause = WhyNotWritten(path);
    throw std::runtime_error("the film " + path + ": " + (cause.empty() ? e.what() : cause));
  }
}

}  // namespace regrasp::run
