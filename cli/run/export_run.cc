#include "cli/run/export_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "cli/run/npz.h"
#include "cli/run/resample.h"
#include "core/files/draft.h"
#include "core/files/names.h"
#include "core/journal/checked_json.h"
#include "core/journal/journal.h"
#include "core/journal/run_messages.h"

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
};

void AddMessage(const std::string& path, const McapMessage& message, Run* run) {
  if (!IsTabular(message.topic)) return;
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

/// Where messages come from: the file, or the replay of a stretch. Tells what of the file was lost.
using Source = std::function<McapSummary(const OnMessage&)>;

Run Read(const std::string& path, const Source& source, McapSummary* summary) {
  Run run;
  std::string topic;
  try {
    *summary = source([&](const McapMessage& message) {
      topic = message.topic;
      AddMessage(path, message, &run);
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

/// What belongs to the run however short the stretch.
bool IsJournal(std::string_view topic) {
  return topic == "run" || topic == "commands" || topic == "scene" || topic == "saved_states";
}

/// The messages of the file's last segment in a stretch of time; of its journal all where
/// `whole_journal`, else what describes the run.
McapSummary ReadStretch(const std::string& path, const Stretch& stretch, bool whole_journal,
                        const OnMessage& on_message) {
  std::vector<McapChunk> chunks;
  const RunFile file = ReadJournals(path, &chunks);
  if (whole_journal && file.segments.size() > 1)
    throw std::runtime_error(
        fmt::format("{} has {} segments, of which a stretch would be cut out: add --rate HZ, which "
                    "writes the last one alone",
                    path, file.segments.size()));
  const Segment& segment = file.segments.back();
  const auto time = [&](double time_s) {
    return segment.offset_ns + static_cast<std::uint64_t>(std::min(time_s, 1e9) * 1e9 + 0.5);
  };
  const std::uint64_t begin = time(stretch.from_s), end = time(stretch.to_s);
  std::uint64_t count = 0;
  McapSummary summary = ReadMcap(
      path,
      [&](const McapMessage& message) {
        const bool always = message.topic == "run" || message.topic == "scene" ||
                            (whole_journal && IsJournal(message.topic));
        const bool here =
            message.time >= (always ? segment.offset_ns : begin) && (always || message.time <= end);
        if (!here) return;
        ++count;
        on_message(message);
      },
      [&](const McapChunk& chunk) {
        if (chunk.end >= begin && chunk.start <= end) return true;
        return std::ranges::any_of(chunk.topics, IsJournal);
      });
  summary.messages = count;
  return summary;
}

/// What item `i` of a list of `size` is called.
std::string ItemName(const Run& run, std::size_t i, std::size_t size) {
  if (size == 3) return std::string(1, "xyz"[i]);
  if (size == 4) return std::string(1, "wxyz"[i]);
  // Former files have lists where there are names now.
  if (size == run.joints.size()) return run.joints[i];
  if (size == run.fingers.size()) return run.fingers[i];
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
        units.push_back(UnitOf(UnitOf(field).empty() ? name : field));
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
Json AsList(const Run& run, const Json& value) {
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
void AddField(const Topic& topic, const std::string& name, const std::string& field, Npz* npz) {
  const std::vector<std::size_t> inner = ShapeOf(topic.rows.front().at(field));
  bool numbers = true, bools = true;
  for (const Json& row : topic.rows) {
    const auto found = row.find(field);
    const bool same =
        found != row.end() && (inner.empty() ? !found->is_array() : Regular(*found, inner));
    numbers = numbers && same && AllOf(*found, &Json::is_number, true);
    bools = bools && same && AllOf(*found, &Json::is_boolean, false);
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
        with.rows.push_back({{field, row.contains(field) ? AsList(run, row.at(field)) : Json("")}});
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

McapSummary WriteMcap(const std::string& path, const Source& source, const std::string& out) {
  McapWriter writer(out);
  std::map<std::string, std::uint16_t, std::less<>> channels;
  const McapSummary summary = source([&](const McapMessage& message) {
    auto channel = channels.find(message.topic);
    if (channel == channels.end()) {
      CheckFileName(path, "topic", message.topic);
      if (channels.size() >= UINT16_MAX) throw std::runtime_error(path + " holds too many topics");
      writer.Flush();  // a channel stands before its messages
      const std::string topic(message.topic);
      channel = channels
                    .emplace(topic, writer.AddChannel(topic, std::string(message.schema_name),
                                                      std::string(message.schema)))
                    .first;
    }
    writer.Write(channel->second, message.time, message.data);
  });
  if (!channels.contains("run")) throw std::runtime_error(path + " holds no run");
  writer.Finish();
  return summary;
}

McapSummary ResampleFile(const std::string& path, const ExportOptions& options,
                         const OnMessage& on_message, std::string* note) {
  RunWindow window(path, options.stretch);
  *note = window.note();
  McapSummary summary;
  Resample(&window, options.rate_hz, [&](const McapMessage& message) {
    ++summary.messages;
    on_message(message);
  });
  summary.complete = window.file().complete;
  summary.lost = window.file().lost;
  return summary;
}

}  // namespace

ExportResult ExportRun(const std::string& path, const ExportOptions& options, const OnRun& on_run) {
  const std::string& format = options.format;
  RemoveAbandonedDrafts(fs::path(options.out).parent_path());
  Draft draft(options.out, Draft::Existing::kKeep,
              format == "csv" ? Draft::Kind::kDirectory : Draft::Kind::kFile);
  ExportResult result;
  const Source source = [&](const OnMessage& to_output) {
    const OnMessage on_message = [&](const McapMessage& message) {
      if (message.topic == "run") on_run(message.data);
      to_output(message);
    };
    if (options.whole) return ReadMcap(path, on_message);
    if (options.rate_hz > 0) return ResampleFile(path, options, on_message, &result.note);
    return ReadStretch(path, options.stretch, format == "mcap", on_message);
  };
  McapSummary summary;
  result.files = 1;
  if (format == "mcap") {
    summary = WriteMcap(path, source, draft.path());
  } else {
    const Run run = Read(path, source, &summary);
    if (format == "npz") WriteNpz(run, draft.path());
    if (format == "csv") {
      for (const auto& [name, topic] : run.topics)
        WriteCsv(run, topic, fs::path(draft.path()) / (name + ".csv"));
      result.files = run.topics.size();
    }
  }
  draft.Commit();
  result.messages = summary.messages;
  result.complete = summary.complete;
  result.lost = std::move(summary.lost);
  return result;
}

}  // namespace regrasp::run
