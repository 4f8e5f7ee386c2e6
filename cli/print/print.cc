#include "cli/print/print.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "cli/client/errors.h"
#include "core/files/json_text.h"

namespace regrasp::cli {
namespace {

std::string CsvCell(const Json& value) {
  if (value.is_null()) return "";
  const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

void FlattenInto(const std::string& name, const Json& value,
                 std::vector<std::pair<std::string, Json>>* out) {
  const auto join = [&name](const std::string& part) {
    return name.empty() ? part : name + "." + part;
  };
  if (value.is_object()) {
    for (const auto& [key, item] : value.items()) FlattenInto(join(key), item, out);
  } else if (value.is_array()) {
    for (std::size_t i = 0; i < value.size(); ++i)
      FlattenInto(join(std::to_string(i)), value[i], out);
  } else {
    out->emplace_back(name, value);
  }
}

}  // namespace

void Output::AddJson(const Json& value) { Line(JsonText(value)); }

void CsvTable::AddColumns(const Json& row) {
  auto next = columns_.begin();
  for (const auto& [name, cell] : Flatten(row)) {
    const auto known = std::find(columns_.begin(), columns_.end(), name);
    next = (known != columns_.end() ? known : columns_.insert(next, name)) + 1;
  }
}

std::string CsvTable::Header() const {
  std::string text;
  for (const std::string& name : columns_) text += (text.empty() ? "" : ",") + CsvCell(name);
  return text + '\n';
}

std::string CsvTable::Line(const Json& row) const {
  std::string text;
  const auto cells = Flatten(row);
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    if (i > 0) text += ',';
    const auto cell = std::find_if(cells.begin(), cells.end(),
                                   [&](const auto& item) { return item.first == columns_[i]; });
    if (cell != cells.end()) text += CsvCell(cell->second);
  }
  return text + '\n';
}

std::string CsvTable::Row(const Json& row) {
  if (!columns_.empty()) return Line(row);
  AddColumns(row);
  return Header() + Line(row);
}

std::string CsvTable::Rows(const std::vector<Json>& rows) {
  if (rows.empty()) return "";
  for (const Json& row : rows) AddColumns(row);
  std::string text = Header();
  for (const Json& row : rows) text += Line(row);
  return text;
}

void FailToPrint(int error) {
  throw CliError(kIo, fmt::format("cannot write to standard output: {}", std::strerror(error)),
                 error == ENOSPC ? "df -h .    (is the disk full?)"
                                 : "> FILE after the command, or -q for no answer");
}

void Output::Flush() {
  std::size_t done = 0;
  while (done < text_.size()) {
    const ssize_t n = ::write(STDOUT_FILENO, text_.data() + done, text_.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) {
      const int error = errno;
      text_.clear();
      FailToPrint(error);
    }
    done += static_cast<std::size_t>(n);
  }
  text_.clear();
}

std::string Output::Paint(std::string_view text, Style style) const {
  if (!color_ || style == Style::kPlain) return std::string(text);
  const char* code = style == Style::kBold   ? "1"
                     : style == Style::kDim  ? "2"
                     : style == Style::kGood ? "32"
                     : style == Style::kWarn ? "33"
                                             : "31";
  return fmt::format("\x1b[{}m{}\x1b[0m", code, text);
}

std::string Output::Bar(double fraction, int width) const {
  const double f = std::isfinite(fraction) ? std::clamp(fraction, 0.0, 1.0) : 0.0;
  const int full = static_cast<int>(std::lround(f * width));
  std::string bar;
  for (int i = 0; i < width; ++i) bar += i < full ? (utf8_ ? "█" : "#") : (utf8_ ? "·" : ".");
  return bar;
}

Table::Table(std::vector<std::string> titles) : titles_(std::move(titles)) {
  for (auto& title : titles_) {
    right_.push_back(!title.empty() && title[0] == '>');
    if (right_.back()) title.erase(0, 1);
  }
}

void Table::Row(std::vector<std::string> cells) {
  cells.resize(titles_.size());  // cells of columns that are not shown go
  rows_.push_back(std::move(cells));
}

std::string Table::Text(const Output& out) const {
  std::vector<int> widths;
  for (std::size_t c = 0; c < titles_.size(); ++c) {
    int width = DisplayWidth(titles_[c]);
    for (const auto& row : rows_) width = std::max(width, DisplayWidth(row[c]));
    widths.push_back(width);
  }
  std::string text;
  const auto line = [&](const std::vector<std::string>& cells, Style style) {
    std::string row;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const std::string pad(static_cast<std::size_t>(widths[c] - DisplayWidth(cells[c])), ' ');
      row += c > 0 ? "  " : "";
      row += right_[c] ? pad + out.Paint(cells[c], style) : out.Paint(cells[c], style) + pad;
    }
    row.erase(row.find_last_not_of(' ') + 1);
    text += row + '\n';
  };
  line(titles_, Style::kDim);
  for (const auto& row : rows_) line(row, Style::kPlain);
  return text;
}

int DisplayWidth(std::string_view text) {
  int width = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\x1b') {
      while (i < text.size() && text[i] != 'm') ++i;
    } else if ((static_cast<unsigned char>(text[i]) & 0xC0) != 0x80) {
      ++width;
    }
  }
  return width;
}

std::string Fixed(const Json& value, int digits, double scale) {
  if (!value.is_number()) return "-";
  std::string text = fmt::format("{:.{}f}", value.get<double>() * scale, digits);
  if (text.find_first_not_of("-0.") == std::string::npos && text[0] == '-') text.erase(0, 1);
  return text;
}

std::string Vector(const Json& value, int digits, double scale) {
  if (!value.is_array()) return "-";
  std::string text = "(";
  for (std::size_t i = 0; i < value.size(); ++i) {
    text += (i > 0 ? ", " : "") + Fixed(value[i], digits, scale);
  }
  return text + ")";
}

std::string Plain(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_null()) return "-";
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_number_float()) return fmt::format("{:.6g}", value.get<double>() + 0.0);  // no -0
  if (value.is_array() && !value.empty() && value[0].is_number()) {
    std::string text;
    for (const auto& item : value) text += (text.empty() ? "" : ", ") + Plain(item);
    return "(" + text + ")";
  }
  return value.dump();
}

std::vector<std::pair<std::string, Json>> Flatten(const Json& value) {
  std::vector<std::pair<std::string, Json>> items;
  FlattenInto("", value, &items);
  return items;
}

std::vector<std::pair<std::string, Json>> Named(const Json& value, const char* key) {
  std::vector<std::pair<std::string, Json>> items;
  if (value.is_object()) {
    for (const auto& [name, item] : value.items()) items.emplace_back(name, item);
  } else if (value.is_array()) {
    for (const auto& item : value) items.emplace_back(Plain(At(item, key)), item);
  }
  return items;
}

const Json& At(const Json& value, const char* key) {
  static const Json kNull;
  if (!value.is_object()) return kNull;
  const auto it = value.find(key);
  return it == value.end() ? kNull : *it;
}

}  // namespace regrasp::cli
