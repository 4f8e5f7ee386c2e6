// Parameters: what may be changed while running.

#include <fmt/format.h>

#include "core/session/parameter_value.h"
#include "daemon/requests/handlers.h"
#include "daemon/wire/frame_json.h"

namespace regrasp::handlers {
namespace {

const ParameterInfo& Row(const Command& command) {
  return ParameterTable()[static_cast<std::size_t>(command.parameter)];
}

Json Entry(const Service& service, const ParameterInfo& info) {
  const Vector3d value = info.get(service.accepted.parameters);
  const Vector3d standard = info.get(service.DefaultValues());
  return {{"name", info.name},
          {"value", ParameterValueJson(info, value)},
          {"default", ParameterValueJson(info, standard)},
          {"changed", value != standard},
          {"type", Name(info.type)},
          {"unit", info.unit},
          {"min", info.min},
          {"max", info.max},
          {"words", info.words},
          {"size", info.size()},
          {"description", info.meaning},
          {"source", service.SourceOfValue(info)},
          {"default_source", info.source}};
}

/// The command that sets parameter `info` to what `given` says. Throws RpcException that blames
/// `param`.
Command SetCommand(const ParameterInfo& info, const GivenValue& given, std::string_view param) {
  Command command;
  command.type = CommandType::kParameter;
  command.parameter = FindParameter(info.name);
  try {
    command.value = ReadParameterValue(info, given);
  } catch (const ParameterError& e) {
    throw RpcException(RpcError{ErrorCode::kInvalidParams,
                                e.what(),
                                e.nearest.empty() ? fmt::format("allowed: {}", e.allowed)
                                                  : fmt::format("did you mean '{}'?", e.nearest),
                                std::string(param),
                                {}});
  }
  return command;
}

Command ReadMember(const Service& service, const std::string& name, const JsonIn& value) {
  const int index = FindParameter(name);
  if (index < 0) {
    std::vector<std::string> names = service.Names(NameSource::kParameter);
    std::string hint = DidYouMean(name, names);
    throw RpcException(RpcError{ErrorCode::kNotFound,
                                fmt::format("no parameter named '{}'", name.substr(0, 64)),
                                hint.empty() ? "call param.list for the list" : hint,
                                name.substr(0, 64), std::move(names)});
  }
  const ParameterInfo& info = ParameterTable()[static_cast<std::size_t>(index)];
  const auto given = ToGivenValue(value);
  if (!given)
    throw RpcException(
        RpcError{ErrorCode::kInvalidParams,
                 fmt::format("{}: expected {}", name, Name(ParamType::kParameterValue)),
                 fmt::format("allowed: {}", AllowedText(info)),
                 name,
                 {}});
  return SetCommand(info, *given, name);
}

bool Selected(const ParameterInfo& info, const std::string& wanted) {
  return wanted.empty() || info.name == wanted || info.group() == wanted;
}

}  // namespace

Outcome ParamGet(Service& service, const Params& params, Client& client) {
  if (params.Has("name"))
    return {.result = Entry(
                service,
                ParameterTable()[static_cast<std::size_t>(FindParameter(params.String("name")))])};
  return ParamList(service, params, client);
}

Outcome ParamList(Service& service, const Params& params, Client&) {
  Json list = Json::array();
  for (const ParameterInfo& info : ParameterTable()) {
    if (!Selected(info, params.String("group"))) continue;
    Json entry = Entry(service, info);
    if (params.Bool("changed", false) && entry["changed"] == false) continue;
    list.push_back(std::move(entry));
  }
  return {.result = {{"parameters", std::move(list)}}};
}

Outcome ParamSet(Service& service, const Params& params, Client&) {
  service.CheckAllowed(CommandType::kParameter);
  const ParameterInfo& info =
      ParameterTable()[static_cast<std::size_t>(FindParameter(params.String("name")))];
  const std::uint64_t barrier =
      service.SetParameters({SetCommand(info, params.Given("value"), "value")});
  return {.result = Entry(service, info), .barrier = barrier};
}

Outcome ParamLoad(Service& service, const Params& params, Client&) {
  service.CheckAllowed(CommandType::kParameter);
  std::vector<Command> commands;
  for (const auto& [name, value] : params.Object("parameters").items())
    commands.push_back(ReadMember(service, name, value));
  Json kept = service.ChangedParameters();
  for (const Command& command : commands) kept.erase(std::string(Row(command).name));
  std::vector<Command> changes;
  for (const Command& command : commands)
    if (Row(command).get(service.accepted.parameters) != command.value) changes.push_back(command);
  const std::uint64_t barrier = service.SetParameters(changes);
  Json list = Json::array();
  for (const Command& command : commands) list.push_back(Entry(service, Row(command)));
  return {.result = {{"parameters", std::move(list)}, {"kept", std::move(kept)}},
          .barrier = barrier};
}

Outcome ParamReset(Service& service, const Params& params, Client&) {
  service.CheckAllowed(CommandType::kParameter);
  const Parameters defaults = service.DefaultValues();
  std::vector<Command> commands;
  std::vector<Json> before;
  for (std::size_t i = 0; i < ParameterTable().size(); ++i) {
    const ParameterInfo& info = ParameterTable()[i];
    const Vector3d value = info.get(service.accepted.parameters);
    if (!Selected(info, params.String("name")) || value == info.get(defaults)) continue;
    before.push_back(ParameterValueJson(info, value));
    Command& command = commands.emplace_back();
    command.type = CommandType::kParameter;
    command.parameter = static_cast<int>(i);
    command.value = info.get(defaults);
  }
  const std::uint64_t barrier = service.SetParameters(commands);
  Json list = Json::array();
  for (std::size_t i = 0; i < commands.size(); ++i) {
    Json entry = Entry(service, Row(commands[i]));
    entry["before"] = std::move(before[i]);
    list.push_back(std::move(entry));
  }
  return {.result = {{"parameters", std::move(list)}}, .barrier = barrier};
}

}  // namespace regrasp::handlers
