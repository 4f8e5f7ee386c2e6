#pragma once

/// FNV-1a, 64 bits: of bytes, to see whether they are the same. Not cryptographic.

#include <cstdint>
#include <string_view>

namespace regrasp {

constexpr std::uint64_t Fnv1a(std::string_view bytes) {
  std::uint64_t value = 0xcbf29ce484222325ULL;
  for (const char byte : bytes)
    value = (value ^ static_cast<unsigned char>(byte)) * 0x100000001b3ULL;
  return value;
}

}  // namespace regrasp
