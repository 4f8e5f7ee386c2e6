#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "cli/run/npz.h"
#include "cli/run/run_tables.h"

namespace regrasp::run {
namespace {

using Json = nlohmann::ordered_json;

/// Whether every list has the length that the first of its kind has.
bool Regular(const Json& value, const std::vector<std::size_t>& shape, std::size_t level = 0) {
  if (level == shape.size()) return !value.is_array();
  if (!value.is_array() || value.size() != shape[level]) return false;
  if (value.empty()) return level + 1 == shape.size();
  for (const Json& item : value)
    if (!Regular(item, shape, level + 1)) return false;
  return true;
}

std::vector<std::size_t> ShapeOf(const Json& value) {
  std::vector<std::size_t> shape;
  for (const Json* v = &value; v->is_array(); v = &(*v)[0]) {
    shape.push_back(v->size());
    if (v->empty()) break;
  }
  return shape;
}

bool AllOf(const Json& value, bool (Json::*kind)() const noexcept, bool or_null) {
  if (!value.is_array()) return (value.*kind)() || (or_null && value.is_null());
  for (const Json& item : value)
    if (!AllOf(item, kind, or_null)) return false;
  return true;
}

void Numbers(const Json& value, std::vector<double>* out) {
  if (value.is_null()) return out->push_back(std::numeric_limits<double>::quiet_NaN());
  if (!value.is_array()) return out->push_back(value.get<double>());
  for (const Json& item : value) Numbers(item, out);
}

void Bools(const Json& value, std::string* out) {
  if (!value.is_array()) return out->push_back(value.get<bool>() ? '\1' : '\0');
  for (const Json& item : value) Bools(item, out);
}

/// {"thumb": 1, "first": 2} -> [1, 2] where the names are those of all fingers, or all joints.
Json AsList(const RunTables& run, const Json& value) {
  if (!value.is_object()) return value;
  for (const auto* names : {&run.fingers, &run.joints}) {
    if (value.size() != names->size()) continue;
    Json list = Json::array();
    for (const std::string& name : *names)
      if (const auto found = value.find(name); found != value.end()) list.push_back(*found);
    if (list.size() == names->size()) return list;
  }
  return value;
}

/// One field of every row: numbers and truth values as such, everything else as text.
void AddField(const TableRows& rows, const std::string& name, const std::string& field, Npz* npz) {
  const std::vector<std::size_t> inner = ShapeOf(rows.front().at(field));
  bool numbers = true, bools = true;
  for (const Json& row : rows) {
    const auto found = row.find(field);
    const bool same =
        found != row.end() && (inner.empty() ? !found->is_array() : Regular(*found, inner));
    numbers = numbers && same && AllOf(*found, &Json::is_number, true);
    bools = bools && same && AllOf(*found, &Json::is_boolean, false);
  }
  std::vector<std::size_t> shape = {rows.size()};
  if (numbers || bools) shape.insert(shape.end(), inner.begin(), inner.end());
  if (numbers) {
    std::vector<double> values;
    for (const Json& row : rows) Numbers(row.at(field), &values);
    npz->Add(name, shape, values);
  } else if (bools) {
    std::string values;
    for (const Json& row : rows) Bools(row.at(field), &values);
    npz->AddBools(name, shape, values);
  } else {
    std::vector<std::string> values;
    for (const Json& row : rows) {
      const auto found = row.find(field);
      values.push_back(found == row.end()   ? ""
                       : found->is_string() ? found->get<std::string>()
                                            : found->dump());
    }
    npz->AddText(name, values);
  }
}

}  // namespace

void WriteNpz(const RunTables& run, const std::string& out) {
  Npz npz(out);
  std::vector<std::string> units;
  for (const auto& [name, rows] : run.topics) {
    std::vector<std::string> fields;
    for (const Json& row : rows)
      for (const auto& [field, value] : row.items())
        if (std::find(fields.begin(), fields.end(), field) == fields.end()) fields.push_back(field);
    for (const std::string& field : fields) {
      TableRows with;  // commands differ in their fields
      for (const Json& row : rows)
        with.push_back({{field, row.contains(field) ? AsList(run, row.at(field)) : Json("")}});
      AddField(with, name + "." + field, field, &npz);
      if (const auto unit = UnitOf(field); !unit.empty())
        units.push_back(fmt::format("{}.{} [{}]", name, field, unit));
    }
  }
  npz.AddText("units", units);
  npz.AddText("joint_names", run.joints);
  npz.AddText("finger_names", run.fingers);
  npz.Finish();
}

}  // namespace regrasp::run
