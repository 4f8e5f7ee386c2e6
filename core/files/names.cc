#include "core/files/names.h"

#include <cstdint>
#include <optional>
#include <string_view>

namespace regrasp {
namespace {

/// Takes a code point off the front; nothing when there is none.
std::optional<std::uint32_t> TakeCodePoint(std::string_view* text) {
  const auto byte = [text](std::size_t i) { return static_cast<unsigned char>((*text)[i]); };
  const unsigned char first = byte(0);
  const std::size_t size = first < 0x80             ? 1
                           : (first & 0xe0) == 0xc0 ? 2
                           : (first & 0xf0) == 0xe0 ? 3
                           : (first & 0xf8) == 0xf0 ? 4
                                                    : 0;
  if (size == 0 || size > text->size()) return {};
  std::uint32_t point = size == 1 ? first : first & (0x7fu >> size);
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return {};
    point = point << 6 | (byte(i) & 0x3fu);
  }
  constexpr std::uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
  if (point < kLeast[size] || point > 0x10ffff || (point >= 0xd800 && point <= 0xdfff)) return {};
  text->remove_prefix(size);
  return point;
}

bool Controls(std::uint32_t c) {
  return c < 0x20 || (c >= 0x7f && c <= 0x9f) || c == 0x2028 || c == 0x2029;
}

/// Marks, embeddings, overrides and isolates of the bidirectional algorithm; the byte order mark.
bool Directs(std::uint32_t c) {
  return c == 0x061c || c == 0x200e || c == 0x200f || (c >= 0x202a && c <= 0x202e) ||
         (c >= 0x2066 && c <= 0x2069) || c == 0xfeff;
}

void AppendEscaped(unsigned char byte, std::string* text) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  *text += {'\\', 'x', kDigits[byte >> 4], kDigits[byte & 15]};
}

}  // namespace

bool IsUtf8(std::string_view text) {
  while (!text.empty())
    if (!TakeCodePoint(&text)) return false;
  return true;
}

std::string Shown(std::string_view name) {
  constexpr std::size_t kMost = 64;
  if (name.size() <= kMost) return ShownText(name);
  std::size_t end = kMost;  // between two characters
  while (end > kMost - 4 && (static_cast<unsigned char>(name[end]) & 0xc0) == 0x80) --end;
  return ShownText(name.substr(0, end)) + "...";
}

std::string ShownText(std::string_view text) {
  std::string shown;
  while (!text.empty()) {
    const std::string_view before = text;
    const auto point = TakeCodePoint(&text);
    if (!point) text = before.substr(1);
    const std::string_view taken = before.substr(0, before.size() - text.size());
    if (point && !Controls(*point) && !Directs(*point))
      shown += taken;
    else
      for (const unsigned char c : taken) AppendEscaped(c, &shown);
  }
  return shown;
}

std::string ShownLines(std::string_view text) {
  std::string shown;
  for (;;) {
    const std::size_t end = text.find('\n');
    shown += ShownText(text.substr(0, end));
    if (end == std::string_view::npos) return shown;
    shown += '\n';
    text.remove_prefix(end + 1);
  }
}

std::string NameFault(std::string_view name) {
  if (name.empty()) return "is empty";
  if (name.size() > kMaxNameBytes)
    return "has " + std::to_string(name.size()) + " bytes; at most " +
           std::to_string(kMaxNameBytes);
  while (!name.empty()) {
    const auto point = TakeCodePoint(&name);
    if (!point) return "is not UTF-8";
    if (Controls(*point)) return "holds a control character";
    if (Directs(*point)) return "holds a character that changes the direction of text";
  }
  return "";
}

std::string FileNameFault(std::string_view name) {
  if (std::string fault = NameFault(name); !fault.empty()) return fault;
  if (name.find('/') != std::string_view::npos) return "holds a '/'";
  if (name.front() == '.' || name.front() == '-')
    return std::string("begins with '") + name.front() + "'";
  return "";
}

}  // namespace regrasp
