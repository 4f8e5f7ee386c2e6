#pragma once

/// The answer on stdout: tables, bars, colour, units, JSON, CSV. Text is collected and written by
/// Flush(), which fails loudly when stdout cannot take it.

#include <string>
#include <string_view>
#include <vector>

#include "cli/client/client.h"

namespace regrasp::cli {

enum class Format { kHuman, kJson, kCsv };
enum class Style { kPlain, kBold, kDim, kGood, kWarn, kBad };

/// CSV (RFC 4180): nested objects become columns `a.b`, arrays of numbers `a.0`.
class CsvTable {
 public:
  /// The row's line; before the first one the header line with the columns that this row has. Later
  /// rows have the same columns.
  std::string Row(const Json& row);
  /// Their lines; the header has every column that one of them has.
  std::string Rows(const std::vector<Json>& rows);

 private:
  /// Adds the columns of a row that are not there yet, each after the one it follows in the row.
  void AddColumns(const Json& row);
  std::string Header() const;
  std::string Line(const Json& row) const;

  std::vector<std::string> columns_;
};

/// Stdout.
class Output {
 public:
  Output(Format format, bool color, bool utf8) : format_(format), color_(color), utf8_(utf8) {}

  Format format() const { return format_; }
  bool human() const { return format_ == Format::kHuman; }
  bool color() const { return color_; }
  bool utf8() const { return utf8_; }

  /// Adds text, as it is.
  void Add(std::string_view text) { text_ += text; }
  void Line(std::string_view text = "") { (text_ += text) += '\n'; }
  /// Adds `value` as one line of JSON.
  void AddJson(const Json& value);
  /// Adds a row of CSV, its header before the first one.
  void AddCsv(const Json& row) { Add(csv_.Row(row)); }
  /// Adds a whole list.
  void AddCsv(const std::vector<Json>& rows) { Add(csv_.Rows(rows)); }
  /// Writes everything to stdout. Throws CliError(kIo).
  void Flush();

  /// `text` in a colour, or as it is when colour is off.
  std::string Paint(std::string_view text, Style style) const;
  /// A bar of `width` cells, `fraction` of it full.
  std::string Bar(double fraction, int width) const;
  /// φ, ρ, °, µ: the letter, or its ASCII name where the terminal has no UTF-8.
  std::string_view Phi() const { return utf8_ ? "φ" : "phi"; }
  std::string_view Rho() const { return utf8_ ? "ρ" : "rho"; }
  std::string_view Degree() const { return utf8_ ? "°" : " deg"; }
  std::string_view Dash() const { return utf8_ ? "–" : "-"; }
  std::string_view Tick() const { return utf8_ ? "✓" : "yes"; }

 private:
  Format format_;
  bool color_, utf8_;
  std::string text_;
  CsvTable csv_;
};

/// Throws CliError(kIo): standard output takes nothing, because of `error` (errno's).
[[noreturn]] void FailToPrint(int error);

/// Aligned columns, two blanks apart. Cells may hold colour codes and UTF-8.
class Table {
 public:
  /// Columns whose title begins with '>' are aligned to the right (the '>' is not printed).
  explicit Table(std::vector<std::string> titles);
  void Row(std::vector<std::string> cells);
  std::string Text(const Output& out) const;

 private:
  std::vector<std::string> titles_;
  std::vector<bool> right_;
  std::vector<std::vector<std::string>> rows_;
};

/// Cells a string takes on a terminal: code points outside colour codes.
int DisplayWidth(std::string_view text);
/// `value` with `digits` after the point; "-" for null and for anything that is not a number.
std::string Fixed(const Json& value, int digits, double scale = 1.0);
/// Three numbers in parentheses: "(16.1, -63.7, 108.1)".
std::string Vector(const Json& value, int digits, double scale = 1.0);
/// Text of a JSON value for people: strings without quotes, numbers with up to 6 digits.
std::string Plain(const Json& value);
/// {"a":{"b":1}} -> {{"a.b", 1}}.
std::vector<std::pair<std::string, Json>> Flatten(const Json& value);
/// The items of `value`, each with its name: an object's members, or an array of objects whose name
/// is in the field `key` ("finger", "name").
std::vector<std::pair<std::string, Json>> Named(const Json& value, const char* key);
/// value[key], or null where there is none.
const Json& At(const Json& value, const char* key);

}  // namespace regrasp::cli
