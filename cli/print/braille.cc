#include "cli/print/braille.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>

namespace regrasp::cli {

BrailleCanvas::BrailleCanvas(int columns, int rows)
    : columns_(std::max(columns, 0)),
      rows_(std::max(rows, 0)),
      cells_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {}

void BrailleCanvas::Set(int x, int y, int ink) {
  if (x < 0 || y < 0 || x >= width() || y >= height()) return;
  // Unicode numbers the dots of the upper six down the columns, the lowest two last.
  static constexpr std::uint8_t kBit[4][2] = {
      {0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}};
  Cell& cell = cells_[static_cast<std::size_t>(y / 4 * columns_ + x / 2)];
  cell.dots = static_cast<std::uint8_t>(cell.dots | kBit[y % 4][x % 2]);
  cell.ink = ink;
}

void BrailleCanvas::Line(int x0, int y0, int x1, int y1, int ink) {
  const int steps = std::max({std::abs(x1 - x0), std::abs(y1 - y0), 1});
  for (int i = 0; i <= steps; ++i) {
    const auto at = [&](int a, int b) {
      return a + ((b - a) * 2 * i + (b >= a ? steps : -steps)) / (2 * steps);
    };
    Set(at(x0, x1), at(y0, y1), ink);
  }
}

char32_t BrailleCanvas::Glyph(int column, int row) const {
  const Cell& cell = cells_[static_cast<std::size_t>(row * columns_ + column)];
  return cell.dots == 0 ? U' ' : U'\u2800' + cell.dots;
}

int BrailleCanvas::Ink(int column, int row) const {
  return cells_[static_cast<std::size_t>(row * columns_ + column)].ink;
}

}  // namespace regrasp::cli
