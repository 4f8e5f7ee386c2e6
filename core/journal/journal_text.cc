#include "core/journal/journal_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>

#include "core/common/fnv1a.h"
#include "core/files/names.h"
#include "core/journal/check.h"
#include "core/journal/checked_json.h"
#include "core/journal/event_json.h"
#include "core/journal/model_fields.h"

namespace regrasp {
namespace {

using fields::Json;
using fields::Load;
using fields::Save;

constexpr const char* kRunFormat = "regrasp-run/2";
constexpr const char* kFormerRunFormat = "regrasp-run/1";  // vertices were lists in a list
constexpr const char* kCheckpointFormat = "regrasp-checkpoint/1";

struct MethodName {
  CommandType type;
  std::string_view name;
};
// As on the wire, besides the jobs; a branch is what a restored checkpoint begins with.
constexpr std::array kOtherMethods = {
    MethodName{CommandType::kStop, "stop"},
    MethodName{CommandType::kNoise, "noise.set"},
    MethodName{CommandType::kPush, "push"},
    MethodName{CommandType::kParameter, "param.set"},
    MethodName{CommandType::kCancelJob, "job.cancel"},
    MethodName{CommandType::kBranch, "branch"},
};

constexpr auto kMethods = [] {
  std::array<MethodName, kJobTable.size() + kOtherMethods.size()> methods{};
  auto end = std::ranges::transform(kJobTable, methods.begin(), [](const JobInfo& job) {
               return MethodName{job.command, job.name};
             }).out;
  std::ranges::copy(kOtherMethods, end);
  return methods;
}();

/// What each command carries. `finger` and `parameter` go by name.
template <typename A>
void CommandFields(A& a, Command& c, std::string& finger, std::string& parameter) {
  const bool about_job = c.type == CommandType::kCancelJob || c.type == CommandType::kBranch;
  if (about_job || JobMethodOf(c.type)) a("job", c.job);
  switch (c.type) {
    case CommandType::kExplore:
      a("finger", finger);
      a("criterion", c.criterion);
      a("estimator", c.estimator);
      a("seed", c.seed);
      a("max_cycles", c.max_cycles);
      break;
    case CommandType::kRotate:
      a("continuous", c.continuous);
      a("angle_rad", c.angle_rad);
      a("axis_W", c.axis_W);
      a("speed_rad_s", c.speed_rad_s);
      break;
    case CommandType::kMove:
      a("offset_m", c.offset_W);
      a("rotation_rad", c.rotation_W);
      break;
    case CommandType::kNoise:
      a("noise", c.noise);
      break;
    case CommandType::kPush:
      a("force_W_n", c.force_W);
      a("duration_s", c.duration_s);
      break;
    case CommandType::kParameter:
      a("name", parameter);
      a("value", c.value);
      break;
    case CommandType::kBranch:
      a("reseed", c.reseed);
      a("seed", c.seed);
      break;
    default:
      break;  // nothing more
  }
}

std::uint64_t TextHash(std::string_view text) {
  StateHasher hasher;
  hasher.Add(text.size());
  for (std::uint64_t word = 0; !text.empty();
       text.remove_prefix(std::min(sizeof word, text.size()))) {
    word = 0;
    std::memcpy(&word, text.data(), std::min(sizeof word, text.size()));
    hasher.Add(word);
  }
  return hasher.Digest();
}

/// The parameters that differ from their defaults: {NAME: {value, default}}.
Json ChangedParameters(const SessionConfig& config) {
  const Parameters defaults = DefaultParameters(config.model);
  Json changed = Json::object();
  for (const ParameterInfo& info : ParameterTable()) {
    const Vector3d value = info.get(config.parameters), standard = info.get(defaults);
    if (value != standard)
      changed[std::string(info.name)] = {{"value", fields::ParameterJson(info, value)},
                                         {"default", fields::ParameterJson(info, standard)}};
  }
  return changed;
}

void CheckFormat(const Json& json, const char* expected, const char* former = "") {
  std::string format;
  Load{json}("format", format);
  if (format != expected && (*former == 0 || format != former))
    throw JournalError("format is '" + Shown(format) + "', this build reads '" + expected + "'");
}

}  // namespace

std::string HashText(std::uint64_t hash) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

std::uint64_t ParseHash(const std::string& text) {
  std::uint64_t hash = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, hash, 16);
  if (error != std::errc() || rest != end || text.size() != 16)
    throw JournalError("'" + Shown(text) + "' is no state hash");
  return hash;
}

std::string ConfigText(const SessionConfig& config, int segment, ModelText* known) {
  Save save;
  save("format", std::string(kRunFormat));
  save("build", std::string(BuildIdentity()));
  save("segment", segment);
  save("hand_name", config.model.hand.name);
  save("object_name", config.model.object.name);
  save("seed", config.seed);
  save("noise", config.noise);
  save("parameters", config.parameters);
  save.json["changed_parameters"] = ChangedParameters(config);
  save("world", config.world);
  std::string text = save.json.dump();
  text.back() = ',';  // the model is the last field, so that a known one is found at the end
  text += "\"model\":";
  text += known ? known->Of(config.model) : ModelJson(config.model);
  return text + "}";
}

ConfigRead ParseConfig(std::string_view text, ModelText* known) {
  const std::optional<std::string> rest = known ? known->Without(text) : std::nullopt;
  const Json json = ParseFileJson(rest ? *rest : text);
  CheckFormat(json, kRunFormat, kFormerRunFormat);
  ConfigRead read;
  Load load{json};
  load("build", read.build);
  load("segment", read.segment);
  load("seed", read.config.seed);
  load("noise", read.config.noise);
  load("parameters", read.config.parameters);
  load("world", read.config.world);
  if (rest)
    read.config.model = known->model();
  else
    load("model", read.config.model);
  CheckConfig(read.config);
  if (known && !rest) known->Of(read.config.model);
  return read;
}

std::string EntryText(const JournalEntry& entry, const SessionConfig& config, int segment,
                      std::size_t seq) {
  Command command = entry.command;
  std::string finger, parameter;
  if (command.finger >= 0 && command.finger < config.model.hand.num_fingers())
    finger = config.model.hand.fingers[static_cast<std::size_t>(command.finger)].name;
  if (command.parameter >= 0)
    parameter = ParameterTable()[static_cast<std::size_t>(command.parameter)].name;
  Save save;
  save("segment", segment);
  save("seq", seq);
  save("tick", entry.tick);
  save("t_s", TickSeconds(entry.tick, config.world.dt));
  for (const MethodName& method : kMethods)
    if (method.type == command.type) save("method", std::string(method.name));
  CommandFields(save, command, finger, parameter);
  save("state_hash", HashText(entry.state_hash));
  return save.json.dump();
}

EntryRead ParseEntry(std::string_view text, const SessionConfig& config) {
  const Json json = ParseFileJson(text);
  EntryRead read;
  std::string method, finger, parameter, hash;
  Load load{json};
  load("segment", read.segment);
  load("seq", read.seq);
  load("tick", read.entry.tick);
  load("method", method);
  load("state_hash", hash);
  read.entry.state_hash = ParseHash(hash);
  Command& command = read.entry.command;
  const auto known = std::find_if(kMethods.begin(), kMethods.end(),
                                  [&](const MethodName& m) { return m.name == method; });
  if (known == kMethods.end()) throw JournalError("unknown method '" + Shown(method) + "'");
  command.type = known->type;
  CommandFields(load, command, finger, parameter);
  if (command.type == CommandType::kExplore) command.finger = config.model.hand.FindFinger(finger);
  if (command.type == CommandType::kParameter) {
    command.parameter = FindParameter(parameter);
    if (command.parameter < 0) throw JournalError("unknown parameter '" + Shown(parameter) + "'");
  }
  CheckEntry(read.entry, config);
  return read;
}

ModelHashes HashModels(const LoadedScenario& model) {
  const auto hash = [](const Json& json) { return Fnv1a(json.dump()); };
  return {hash(fields::ToJson(model.scenario)), hash(fields::ToJson(model.hand)),
          hash(fields::ToJson(model.object))};
}

std::string CheckpointText(const Checkpoint& checkpoint, ModelText* known) {
  const SessionConfig& config = checkpoint.journal.config;
  Save head;
  head("format", std::string(kCheckpointFormat));
  head("name", checkpoint.name);
  head("tick", checkpoint.tick);
  head("time_s", static_cast<double>(checkpoint.tick) * config.world.dt);
  head("state_hash", HashText(checkpoint.state_hash));
  head("state", checkpoint.state);
  head("build", checkpoint.build);
  head("seed", config.seed);
  head("object", config.model.object.name);
  head("commands", checkpoint.journal.entries.size());
  head("job", checkpoint.job.id);
  head("job_method", checkpoint.job.method);
  std::string text = head.json.dump() + "\n" + ConfigText(config, 0, known) + "\n";
  for (std::size_t i = 0; i < checkpoint.journal.entries.size(); ++i)
    text += EntryText(checkpoint.journal.entries[i], config, 0, i) + "\n";
  if (checkpoint.saved_state.empty()) return text;
  Save state;
  state("belongs_to", HashText(TextHash(text)));
  state("saved_state", checkpoint.saved_state);
  return text + state.json.dump() + "\n";
}

Checkpoint ParseCheckpointHead(std::string_view line) {
  const Json json = ParseFileJson(line);
  CheckFormat(json, kCheckpointFormat);
  Checkpoint checkpoint;
  std::string hash;
  Load load{json};
  load("name", checkpoint.name);
  load("tick", checkpoint.tick);
  load("state_hash", hash);
  load("state", checkpoint.state);
  load("build", checkpoint.build);
  load("seed", checkpoint.journal.config.seed);
  load("object", checkpoint.journal.config.model.object.name);
  load("job", checkpoint.job.id);
  load("job_method", checkpoint.job.method);
  load("commands", checkpoint.commands);
  CheckRange("tick", static_cast<double>(checkpoint.tick), 0, static_cast<double>(kMaxTick));
  CheckRange("job", static_cast<double>(checkpoint.job.id), 0, 9007199254740992.0);
  CheckRange("job_method", static_cast<double>(checkpoint.job.method), 0,
             static_cast<double>(JobMethod::kRestore));
  for (const std::string* name :
       {&checkpoint.name, &checkpoint.state, &checkpoint.journal.config.model.object.name})
    if (const std::string fault = NameFault(*name); !fault.empty())
      throw JournalError("'" + Shown(*name) + "' is no name: it " + fault);
  checkpoint.state_hash = ParseHash(hash);
  return checkpoint;
}

Checkpoint ParseCheckpoint(std::string_view text, ModelText* known) {
  const std::string_view whole = text;
  const auto next_line = [&text] {
    const auto end = text.find('\n');
    if (end == std::string_view::npos) throw JournalError("the file ends too early");
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end + 1);
    return line;
  };
  Checkpoint checkpoint = ParseCheckpointHead(next_line());
  checkpoint.journal.config = ParseConfig(next_line(), known).config;
  auto& entries = checkpoint.journal.entries;
  while (entries.size() < checkpoint.commands) {
    entries.push_back(ParseEntry(next_line(), checkpoint.journal.config).entry);
    const std::int64_t tick = entries.back().tick;
    CheckRange("tick of a command", static_cast<double>(tick),
               entries.size() > 1 ? static_cast<double>(entries[entries.size() - 2].tick) : 0,
               static_cast<double>(checkpoint.tick));
  }
  if (text.empty()) return checkpoint;
  const std::uint64_t before = TextHash(whole.substr(0, whole.size() - text.size()));
  const Json json = ParseFileJson(next_line());
  std::string belongs_to;
  Load load{json};
  load("belongs_to", belongs_to);
  load("saved_state", checkpoint.saved_state);
  if (ParseHash(belongs_to) != before) checkpoint.saved_state.clear();
  return checkpoint;
}

}  // namespace regrasp
