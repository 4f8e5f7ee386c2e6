#include "cli/run/run_tables.h"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

#include "core/files/names.h"
#include "core/journal/checked_json.h"
#include "core/journal/journal.h"
#include "core/journal/run_messages.h"
#include "core/session/parameters.h"

namespace regrasp::run {
namespace {

using Json = nlohmann::ordered_json;

/// Units by the end of a field's name; longer ends first.
constexpr std::pair<std::string_view, std::string_view> kUnits[] = {
    {"_n_s_m", "N s/m"}, {"_n_m", "N/m"}, {"_hz", "Hz"},   {"_kg", "kg"},
    {"_rad_s", "rad/s"}, {"_m_s", "m/s"}, {"_1_m", "1/m"}, {"_nm", "N m"},
    {"_rad", "rad"},     {"_n", "N"},     {"_m", "m"},     {"_s", "s"}};

void AddMessage(const std::string& path, const McapMessage& message, RunTables* run) {
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
  run->topics[std::string(message.topic)].push_back(std::move(json));
}

}  // namespace

void CheckFileName(const std::string& path, const char* what, std::string_view name) {
  if (const std::string fault = FileNameFault(name); !fault.empty())
    throw std::runtime_error(
        fmt::format("{}: {} '{}' is no name: it {}", path, what, Shown(name), fault));
}

void CheckHoldsRun(const std::string& path, bool has_run, const McapSummary& summary) {
  if (has_run || (summary.messages > 0 && !summary.lost.empty())) return;
  throw std::runtime_error(path + " holds no run" +
                           (summary.lost.empty() ? "" : "; lost: " + LossText(summary.lost[0])));
}

std::string_view UnitOf(std::string_view field) {
  constexpr std::string_view kParameters = "parameters.";
  if (field.starts_with(kParameters)) {
    const std::string_view item = field.substr(kParameters.size());
    for (const std::string_view name : {item, item.substr(0, item.rfind('.'))})
      if (const int i = FindParameter(name); i >= 0)
        return ParameterTable()[static_cast<std::size_t>(i)].unit;
    return "";
  }
  for (const auto& [end, unit] : kUnits)
    if (field.ends_with(end)) return unit;
  return "";
}

RunTables ReadTables(const std::string& path, const Source& source, McapSummary* summary) {
  RunTables run;
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
  CheckHoldsRun(path, run.topics.contains("run"), *summary);
  return run;
}

}  // namespace regrasp::run
