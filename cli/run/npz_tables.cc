#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>

#include "cli/run/npz.h"
#include "cli/run/run_tables.h"
#include "core/journal/run_messages.h"

namespace regrasp::run {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostOfOne = 4096;  // numbers of one value; ours have some hundred

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

/// The numbers of a value, NaN for null; so many of them for a whole value that is null.
void Numbers(const Json& value, std::size_t count, std::vector<double>* out) {
  if (value.is_null()) {
    out->insert(out->end(), count, std::numeric_limits<double>::quiet_NaN());
    return;
  }
  if (!value.is_array()) return out->push_back(value.get<double>());
  for (const Json& item : value) Numbers(item, 1, out);
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

/// One field of every row, null where a row lacks it: numbers (NaN for null) and truth values as
/// such, everything else as text ("" for null). `text`: it is one, also where it is never known.
void AddField(const TableRows& values, const std::string& name, bool text, Npz* npz) {
  const auto known = std::ranges::find_if(values, [](const Json& v) { return !v.is_null(); });
  const std::vector<std::size_t> inner =
      known == values.end() ? std::vector<std::size_t>() : ShapeOf(*known);
  const std::size_t count =
      std::accumulate(inner.begin(), inner.end(), std::size_t{1}, std::multiplies<>());
  bool numbers = !text && count <= kMostOfOne, bools = !text;
  for (const Json& value : values) {
    const bool regular = inner.empty() ? !value.is_array() : Regular(value, inner);
    numbers = numbers && (value.is_null() || (regular && AllOf(value, &Json::is_number, true)));
    bools = bools && regular && AllOf(value, &Json::is_boolean, false);
  }
  std::vector<std::size_t> shape = {values.size()};
  if (numbers || bools) shape.insert(shape.end(), inner.begin(), inner.end());
  if (numbers) {
    std::vector<double> all;
    for (const Json& value : values) Numbers(value, count, &all);
    npz->Add(name, shape, all);
  } else if (bools) {
    std::string all;
    for (const Json& value : values) Bools(value, &all);
    npz->AddBools(name, shape, all);
  } else {
    std::vector<std::string> all;
    for (const Json& value : values)
      all.push_back(value.is_null()     ? ""
                    : value.is_string() ? value.get<std::string>()
                                        : value.dump());
    npz->AddText(name, all);
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
      TableRows values;  // commands differ in their fields
      for (const Json& row : rows)
        values.push_back(row.contains(field) ? AsList(run, row.at(field)) : Json());
      AddField(values, name + "." + field, IsText(name, field), &npz);
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
