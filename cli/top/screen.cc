#include "cli/top/screen.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace regrasp::cli {
namespace {

/// The next code point of `text` at `*at`, which moves on. Malformed bytes become '?'.
char32_t NextCodePoint(std::string_view text, std::size_t* at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte((*at)++);
  if (first < 0x80) return first;
  const int more = first >= 0xF0 ? 3 : first >= 0xE0 ? 2 : first >= 0xC0 ? 1 : 0;
  char32_t code = first & (0x3Fu >> more);
  for (int i = 0; i < more; ++i) {
    if (*at >= text.size() || (byte(*at) & 0xC0) != 0x80) return U'?';
    code = code << 6 | (byte((*at)++) & 0x3Fu);
  }
  return more == 0 ? U'?' : code;
}

}  // namespace

Ink CurveInk(int finger) {
  return static_cast<Ink>(static_cast<int>(Ink::kCurve) + std::max(finger, 0) % kCurveInks);
}

int Cells(std::string_view text) {
  return static_cast<int>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  }));
}

std::string Utf8(char32_t c) {
  std::string text;
  const auto add = [&text](char32_t byte) { text += static_cast<char>(byte); };
  if (c < 0x80) {
    add(c);
  } else if (c < 0x800) {
    add(0xC0 | c >> 6);
    add(0x80 | (c & 0x3F));
  } else {
    if (c < 0x10000) {
      add(0xE0 | c >> 12);
    } else {
      add(0xF0 | c >> 18);
      add(0x80 | (c >> 12 & 0x3F));
    }
    add(0x80 | (c >> 6 & 0x3F));
    add(0x80 | (c & 0x3F));
  }
  return text;
}

char32_t ToAscii(char32_t c) {
  if (c < 0x80) return c;
  if (c >= 0x2800 && c < 0x2900)
    return c & 0xC0 ? (c & 0x09 ? U':' : U'.') : c & 0x24 ? U'-' : U'\'';
  if (c >= 0x2581 && c <= 0x258F) return U'#';
  switch (c) {
    case U'─':
      return U'-';
    case U'│':
      return U'|';
    case U'┌':
    case U'┐':
    case U'└':
    case U'┘':
      return U'+';
    case U'●':
      return U'*';
    case U'○':
    case U'·':
      return U'.';
    case U'×':
      return U'x';
    case U'°':
      return U'd';
    case U'µ':
      return U'u';
    case U'→':
      return U'>';
    case U'φ':
      return U'f';
    case U'ε':
      return U'e';
    case U'∇':
      return U'd';
    case U'−':
      return U'-';
    default:
      return U'?';
  }
}

std::string FineBar(double fraction, int width) {
  const double f = std::isfinite(fraction) ? std::clamp(fraction, 0.0, 1.0) : 0.0;
  const int eighths = static_cast<int>(std::lround(f * width * 8));
  std::string bar;
  for (int i = 0; i < width; ++i) {
    const int part = std::clamp(eighths - 8 * i, 0, 8);
    bar += part == 0 ? "·" : Utf8(U'\u2590' - static_cast<char32_t>(part));
  }
  return bar;
}

Screen::Screen(int rows, int columns, bool utf8)
    : rows_(std::max(rows, 0)),
      columns_(std::max(columns, 0)),
      utf8_(utf8),
      cells_(static_cast<std::size_t>(rows_) * static_cast<std::size_t>(columns_)) {}

const Cell& Screen::at(int row, int column) const {
  return cells_[static_cast<std::size_t>(row * columns_ + column)];
}

void Screen::Put(int row, int column, char32_t glyph, Ink ink) {
  if (row < 0 || column < 0 || row >= rows_ || column >= columns_) return;
  if (glyph < 0x20 || glyph == 0x7F) glyph = U'?';
  cells_[static_cast<std::size_t>(row * columns_ + column)] = {utf8_ ? glyph : ToAscii(glyph), ink};
}

int Screen::Put(int row, int column, std::string_view text, Ink ink, int limit) {
  for (std::size_t at = 0; at < text.size() && limit > 0; --limit)
    Put(row, column++, NextCodePoint(text, &at), ink);
  return column;
}

void Screen::Rule(const Box& box, std::string_view title) {
  for (int i = 0; i < box.columns; ++i) Put(box.row, box.column + i, U'─', Ink::kDim);
  if (title.empty() || box.columns < 8) return;
  Put(box.row, box.column + 1, " " + std::string(title) + " ", Ink::kTitle, box.columns - 2);
}

void Screen::Frame(const Box& box, std::string_view title) {
  const int bottom = box.row + box.rows - 1, right = box.column + box.columns - 1;
  for (int row = box.row; row <= bottom; ++row)
    Put(row, box.column, std::string(static_cast<std::size_t>(std::max(box.columns, 0)), ' '));
  Rule(box, "");
  Rule({bottom, box.column, 1, box.columns}, "");
  for (int row = box.row; row <= bottom; ++row) {
    Put(row, box.column, row == box.row ? U'┌' : row == bottom ? U'└' : U'│', Ink::kDim);
    Put(row, right, row == box.row ? U'┐' : row == bottom ? U'┘' : U'│', Ink::kDim);
  }
  Put(box.row, box.column + 2, " " + std::string(title) + " ", Ink::kTitle, box.columns - 4);
}

std::string Screen::Text() const {
  std::string text;
  for (int row = 0; row < rows_; ++row) {
    std::string line;
    for (int column = 0; column < columns_; ++column) line += Utf8(at(row, column).glyph);
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + '\n';
  }
  return text;
}

void PutItems(Screen* screen, const Box& box, std::vector<Item> items, int gap) {
  const auto total = [&items, gap] {
    int cells = 0;
    for (const Item& item : items) cells += Cells(item.text) + gap;
    return cells - gap;
  };
  std::erase_if(items, [](const Item& item) { return item.text.empty(); });
  while (items.size() > 1 && total() > box.columns) {
    // The last one of the highest rank.
    auto worst = items.begin();
    for (auto it = items.begin(); it != items.end(); ++it)
      if (it->rank >= worst->rank) worst = it;
    items.erase(worst);
  }
  int column = box.column;
  for (const Item& item : items)
    column =
        gap + screen->Put(box.row, column, item.text, item.ink, box.column + box.columns - column);
}

}  // namespace regrasp::cli
