#pragma once

/// The parts of the MCAP 0 format (mcap.dev/spec) that we write and read. Internal to this folder.

#include <array>
#include <cstdint>
#include <string>

namespace regrasp::mcap {

inline constexpr std::array<char, 8> kMagic = {'\x89', 'M', 'C', 'A', 'P', '0', '\r', '\n'};
inline constexpr std::size_t kRecordHead = 9;  ///< opcode, length

enum Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0b,
  kDataEnd = 0x0f,
};

/// Appends little-endian numbers and length-prefixed strings.
struct Bytes {
  std::string data;
  template <typename T>
  void Add(T value) {
    for (std::size_t i = 0; i < sizeof(T); ++i)
      data.push_back(static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i)));
  }
  void AddText(std::string_view text) {
    Add(static_cast<std::uint32_t>(text.size()));
    data += text;
  }
  /// One record with this content.
  void AddRecord(Opcode opcode, std::string_view content) {
    Add(static_cast<std::uint8_t>(opcode));
    Add(static_cast<std::uint64_t>(content.size()));
    data += content;
  }
};

}  // namespace regrasp::mcap
