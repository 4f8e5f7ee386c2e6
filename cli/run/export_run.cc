#include "cli/run/export_run.h"

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "cli/run/npz.h"
#include "core/files/draft.h"
#include "core/files/names.h"
#include "core/journal/checked_json.h"
#include "core/journal/journal.h"

namespace regrasp::run {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxColumns = 4096;  // of a table; our widest has some 200

/// A topic or a field becomes the name of a file, or of an archive's member.
void CheckFileName(const std::string& path, const char* what, std::string_view name) {
  if (const std::string fault = FileNameFault(name); !fault.empty())
    throw std::runtime_error(
        fmt::format("{}: {} '{}' is no name: it {}", path, what, Shown(name), fault));
}

/// Units by the end of a field's name; longer ends first.
constexpr std::pair<std::string_view, std::string_view> kUnits[] = {
    {"_rad_s", "rad/s"}, {"_m_s", "m/s"}, {"_1_m", "1/m"}, {"_nm", "N m"},
    {"_rad", "rad"},     {"_n", "N"},     {"_m", "m"},     {"_s", "s"}};

std::string_view UnitOf(std::string_view field) {
  for (const auto& [end, unit] : kUnits)
    if (field.ends_with(end)) return unit;
  return "";
}

struct Topic {
  std::vector<Json> rows;
};

struct Run {
  std::map<std::string, Topic> topics;
  std::vector<std::string> joints, fingers;
  McapSummary summary;
};

void AddMessage(const std::string& path, const McapMessage& message, Run* run) {
  CheckFileName(path, "topic", message.topic);
  Json json = ParseFileJson(message.data);
  if (!json.is_object()) throw JournalError("a message that is no object");
  for (const auto& [field, value] : json.items()) CheckFileName(path, "field", field);
  if (message.topic == "run") {  // models: only the names of joints and fingers are needed here
    const Json& hand = json.at("model").at("hand");
    run->joints.clear();
    run->fingers.clear();
    for (const Json& joint : hand.at("joints")) run->joints.push_back(joint.at("name"));
    for (const Json& finger : hand.at("fingers")) run->fingers.push_back(finger.at("name"));
    json.erase("model");
  }
  run->topics[std::string(message.topic)].rows.push_back(std::move(json));
}

Run Read(const std::string& path, const OnRun& on_run) {
  Run run;
  std::string topic;
  try {
    run.summary = ReadMcap(path, [&](const McapMessage& message) {
      topic = message.topic;
      AddMessage(path, message, &run);
      if (topic == "run") on_run(message.data);
    });
  } catch (const nlohmann::json::exception& e) {
    throw std::runtime_error(fmt::format("{}: a message of topic '{}' is not as expected: {}", path,
                                         Shown(topic), e.what()));
  } catch (const JournalError& e) {
    throw std::runtime_error(fmt::format("{}: topic '{}': {}", path, Shown(topic), e.what()));
  }
  if (!run.topics.contains("run")) throw std::runtime_error(path + " holds no run");
  return run;
}

/// What item `i` of a list of `size` is called.
std::string ItemName(const Run& run, std::size_t i, std::size_t size) {
  if (size == run.joints.size()) return run.joints[i];
  if (size == run.fingers.size()) return run.fingers[i];
  if (size == 3) return std::string(1, "xyz"[i]);
  if (size == 4) return std::string(1, "wxyz"[i]);
  return std::to_string(i);
}

/// {"a":[1,2]} -> {"a.x", 1}, {"a.y", 2}.
void Flatten(const Run& run, const std::string& name, const Json& value,
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

void WriteCsv(const Run& run, const Topic& topic, const fs::path& path) {
  std::vector<std::vector<std::pair<std::string, Json>>> rows;
  std::vector<std::string> columns;
  std::map<std::string, std::size_t> place;
  std::vector<std::string_view> units;
  for (const Json& row : topic.rows) {
    auto& cells = rows.emplace_back();
    for (const auto& [field, value] : row.items()) {
      const std::size_t before = cells.size();
      Flatten(run, field, value, &cells);
      for (std::size_t i = before; i < cells.size(); ++i) {
        if (!place.emplace(cells[i].first, columns.size()).second) continue;
        if (columns.size() == kMaxColumns)
          throw std::runtime_error(fmt::format("a table of more than {} columns", kMaxColumns));
        columns.push_back(cells[i].first);
        const std::string& name = cells[i].first;  // of noise.position_m the last part tells
        units.push_back(UnitOf(value.is_object() ? name : field));
      }
    }
  }
  std::ofstream out(path, std::ios::binary);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    out << (i ? "," : "") << Cell(columns[i]);
    if (!units[i].empty()) out << " [" << units[i] << "]";
  }
  out << "\n";
  std::vector<std::string> line;
  for (const auto& cells : rows) {
    line.assign(columns.size(), "");
    for (const auto& [name, value] : cells) line[place.at(name)] = Cell(value);
    for (std::size_t i = 0; i < line.size(); ++i) out << (i ? "," : "") << line[i];
    out << "\n";
  }
  out.close();
  if (!out) throw std::runtime_error("cannot write " + path.string());
}

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

bool AllOf(const Json& value, bool (Json::*kind)() const noexcept) {
  if (!value.is_array()) return (value.*kind)();
  for (const Json& item : value)
    if (!AllOf(item, kind)) return false;
  return true;
}

void Numbers(const Json& value, std::vector<double>* out) {
  if (!value.is_array()) return out->push_back(value.get<double>());
  for (const Json& item : value) Numbers(item, out);
}

void Bools(const Json& value, std::string* out) {
  if (!value.is_array()) return out->push_back(value.get<bool>() ? '\1' : '\0');
  for (const Json& item : value) Bools(item, out);
}

/// One field of every row: numbers and truth values as such, everything else as text.
void AddField(const Topic& topic, const std::string& name, const std::string& field, Npz* npz) {
  const std::vector<std::size_t> inner = ShapeOf(topic.rows.front().at(field));
  bool numbers = true, bools = true;
  for (const Json& row : topic.rows) {
    const auto found = row.find(field);
    const bool same =
        found != row.end() && (inner.empty() ? !found->is_array() : Regular(*found, inner));
    numbers = numbers && same && AllOf(*found, &Json::is_number);
    bools = bools && same && AllOf(*found, &Json::is_boolean);
  }
  std::vector<std::size_t> shape = {topic.rows.size()};
  if (numbers || bools) shape.insert(shape.end(), inner.begin(), inner.end());
  if (numbers) {
    std::vector<double> values;
    for (const Json& row : topic.rows) Numbers(row.at(field), &values);
    npz->Add(name, shape, values);
  } else if (bools) {
    std::string values;
    for (const Json& row : topic.rows) Bools(row.at(field), &values);
    npz->AddBools(name, shape, values);
  } else {
    std::vector<std::string> values;
    for (const Json& row : topic.rows) {
      const auto found = row.find(field);
      values.push_back(found == row.end()   ? ""
                       : found->is_string() ? found->get<std::string>()
                                            : found->dump());
    }
    npz->AddText(name, values);
  }
}

void WriteNpz(const Run& run, const std::string& out) {
  Npz npz(out);
  std::vector<std::string> units;
  for (const auto& [name, topic] : run.topics) {
    std::vector<std::string> fields;
    for (const Json& row : topic.rows)
      for (const auto& [field, value] : row.items())
        if (std::find(fields.begin(), fields.end(), field) == fields.end()) fields.push_back(field);
    for (const std::string& field : fields) {
      Topic with;  // commands differ in their fields
      for (const Json& row : topic.rows)
        with.rows.push_back(row.contains(field) ? row : Json{{field, ""}});
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

McapSummary WriteMcap(const std::string& path, const std::string& out, const OnRun& on_run) {
  McapWriter writer(out);
  // Channels stand before the first message: two passes.
  std::map<std::string, std::string> schemas;
  std::vector<std::string> order;
  ReadMcap(path, [&](const McapMessage& message) {
    if (message.topic == "run") on_run(message.data);
    if (!schemas.emplace(message.topic, message.schema).second) return;
    CheckFileName(path, "topic", message.topic);
    order.emplace_back(message.topic);
  });
  if (!schemas.contains("run")) throw std::runtime_error(path + " holds no run");
  if (order.size() >= UINT16_MAX) throw std::runtime_error(path + " holds too many topics");
  std::map<std::string, std::uint16_t> channels;
  for (const std::string& topic : order) channels[topic] = writer.AddChannel(topic, schemas[topic]);
  McapSummary summary = ReadMcap(path, [&](const McapMessage& message) {
    writer.Write(channels.at(std::string(message.topic)), message.time, message.data);
  });
  writer.Finish();
  return summary;
}

ExportResult Result(McapSummary summary, std::uint64_t files) {
  return {summary.messages, files, summary.complete, std::move(summary.lost)};
}

}  // namespace

ExportResult ExportRun(const std::string& path, const std::string& format, const std::string& out,
                       const OnRun& on_run) {
  RemoveAbandonedDrafts(fs::path(out).parent_path());
  Draft draft(out, Draft::Existing::kKeep,
              format == "csv" ? Draft::Kind::kDirectory : Draft::Kind::kFile);
  ExportResult result;
  if (format == "mcap") {
    result = Result(WriteMcap(path, draft.path(), on_run), 1);
  } else {
    Run run = Read(path, on_run);
    if (format == "npz") WriteNpz(run, draft.path());
    if (format == "csv")
      for (const auto& [name, topic] : run.topics)
        WriteCsv(run, topic, fs::path(draft.path()) / (name + ".csv"));
    result = Result(std::move(run.summary), format == "csv" ? run.topics.size() : 1);
  }
  draft.Commit();
  return result;
}

}  // namespace regrasp::run
