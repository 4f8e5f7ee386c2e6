#pragma once

/// A picture of the terminal as cells, made without a terminal: what `top` draws before ncurses
/// puts it on the screen, and what its tests look at.

#include <string>
#include <string_view>
#include <vector>

namespace regrasp::cli {

/// What a cell means; terminal.cc gives it a colour. Nothing is said by ink alone.
enum class Ink {
  kPlain,
  kBold,
  kDim,
  kTitle,
  kGood,
  kWarn,
  kBad,
  kBadge,     ///< reversed: the state
  kBadBadge,  ///< reversed, alarming
  kCurve,     ///< kCurve + i: the i-th finger, i < kCurveInks
  kCurveEnd = kCurve + 5,
};
inline constexpr int kCurveInks = 5;
Ink CurveInk(int finger);

struct Cell {
  char32_t glyph = U' ';
  Ink ink = Ink::kPlain;
};

/// A part of the screen.
struct Box {
  int row = 0, column = 0, rows = 0, columns = 0;
};

class Screen {
 public:
  Screen(int rows, int columns, bool utf8 = true);

  int rows() const { return rows_; }
  int columns() const { return columns_; }
  const Cell& at(int row, int column) const;
  /// Writes UTF-8 text from (row, column) to the right, at most `limit` cells; what lies outside
  /// the screen is cut off. Control characters become '?'. Returns the column after the text.
  int Put(int row, int column, std::string_view text, Ink ink = Ink::kPlain, int limit = 1 << 20);
  void Put(int row, int column, char32_t glyph, Ink ink = Ink::kPlain);
  /// A horizontal rule across `box`'s first row, with a title in it.
  void Rule(const Box& box, std::string_view title);
  /// Blanks the box and draws a frame along its edge.
  void Frame(const Box& box, std::string_view title);
  /// The rows as text, blanks at their ends removed.
  std::string Text() const;

 private:
  int rows_, columns_;
  bool utf8_;
  std::vector<Cell> cells_;
};

/// A piece of a line; `rank` 0 stays longest.
struct Item {
  std::string text;
  Ink ink = Ink::kPlain;
  int rank = 0;
};
/// Writes the items into one row of `box`, `gap` blanks apart; those of the highest rank are left
/// out first when they do not all fit.
void PutItems(Screen* screen, const Box& box, std::vector<Item> items, int gap = 3);

/// Cells that UTF-8 text takes.
int Cells(std::string_view text);
/// A bar of `width` cells in eighths of a cell, `fraction` of it full, the rest dotted.
std::string FineBar(double fraction, int width);
/// `glyph` as ASCII, for terminals without UTF-8.
char32_t ToAscii(char32_t glyph);
std::string Utf8(char32_t glyph);

}  // namespace regrasp::cli
