#include <fmt/format.h>

#include <fstream>
#include <stdexcept>

#include "cli/run/run_tables.h"
#include "cli/run/write_failure.h"

namespace regrasp::run {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxColumns = 4096;  // our widest has some 200

/// What item `i` of a list of `size` is called.
std::string ItemName(const RunTables& run, std::size_t i, std::size_t size) {
  if (size == 3) return std::string(1, "xyz"[i]);
  if (size == 4) return std::string(1, "wxyz"[i]);
  // Former files have lists where there are names now.
  if (size == run.joints.size()) return run.joints[i];
  if (size == run.fingers.size()) return run.fingers[i];
  return std::to_string(i);
}

/// {"a":[1,2]} -> {"a.x", 1}, {"a.y", 2}.
void Flatten(const RunTables& run, const std::string& name, const Json& value,
             std::vector<std::pair<std::string, Json>>* cells) {
  if (value.is_array()) {
    for (std::size_t i = 0; i < value.size(); ++i)
      Flatten(run, name + "." + ItemName(run, i, value.size()), value[i], cells);
  } else if (value.is_object()) {
    for (const auto& [key, item] : value.items()) Flatten(run, name + "." + key, item, cells);
  } else {
    cells->emplace_back(name, value);
  }
}

std::string Cell(const Json& value) {
  if (value.is_null()) return "";
  if (!value.is_string()) return value.dump();
  const std::string& text = value.get_ref<const std::string&>();
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

void WriteCsv(const RunTables& run, const TableRows& rows, const std::string& out) {
  std::vector<std::vector<std::pair<std::string, Json>>> flat;
  std::vector<std::string> columns;
  std::map<std::string, std::size_t> place;
  std::vector<std::string_view> units;
  for (const Json& row : rows) {
    auto& cells = flat.emplace_back();
    for (const auto& [field, value] : row.items()) {
      const std::size_t before = cells.size();
      Flatten(run, field, value, &cells);
      for (std::size_t i = before; i < cells.size(); ++i) {
        if (!place.emplace(cells[i].first, columns.size()).second) continue;
        if (columns.size() == kMaxColumns)
          throw std::runtime_error(fmt::format("a table of more than {} columns", kMaxColumns));
        columns.push_back(cells[i].first);
        // Of noise.position_m the last part tells, of a parameter its name.
        units.push_back(UnitOf(UnitOf(field).empty() ? cells[i].first : field));
      }
    }
  }
  std::ofstream file(out, std::ios::binary);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    file << (i ? "," : "") << Cell(columns[i]);
    if (!units[i].empty()) file << " [" << units[i] << "]";
  }
  file << "\n";
  std::vector<std::string> line;
  for (const auto& cells : flat) {
    line.assign(columns.size(), "");
    for (const auto& [name, value] : cells) line[place.at(name)] = Cell(value);
    for (std::size_t i = 0; i < line.size(); ++i) file << (i ? "," : "") << line[i];
    file << "\n";
  }
  file.close();
  if (!file) FailToWrite(out);
}

}  // namespace regrasp::run
