#pragma once

/// Drawing with Braille letters: a terminal cell holds 2 x 4 dots.

#include <cstdint>
#include <vector>

namespace regrasp::cli {

class BrailleCanvas {
 public:
  /// A canvas of `columns` x `rows` cells, all empty.
  BrailleCanvas(int columns, int rows);

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  int width() const { return 2 * columns_; }  ///< [dots]
  int height() const { return 4 * rows_; }    ///< [dots]

  /// Sets the dot at (x, y), y downwards; its cell takes `ink`. Outside the canvas: nothing.
  void Set(int x, int y, int ink = 0);
  /// Sets the dots of a straight line, both ends included.
  void Line(int x0, int y0, int x1, int y1, int ink = 0);

  /// U+2800 to U+28FF; a blank for a cell without dots.
  char32_t Glyph(int column, int row) const;
  /// The ink of the last dot set in this cell.
  int Ink(int column, int row) const;

 private:
  struct Cell {
    std::uint8_t dots = 0;
    int ink = 0;
  };
  int columns_, rows_;
  std::vector<Cell> cells_;
};

}  // namespace regrasp::cli
