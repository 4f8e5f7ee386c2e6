// Parameters: what may be changed while running.

#include <fmt/format.h>

#include <algorithm>

#include "core/common/nearest_name.h"
#include "core/files/problem_list.h"
#include "core/session/parameter_value.h"
#include "daemon/requests/handlers.h"
#include "daemon/wire/frame_json.h"

namespace regrasp::handlers {
namespace {

const ParameterInfo& Row(const Command& command) {
  return ParameterTable()[static_cast<std::size_t>(command.parameter)];
}

Json Entry(const Service& service, const ParameterInfo& info) {
  const Vector3d value = info.get(service.accepted().parameters);
  const Vector3d standard = info.get(service.accepted().defaults);
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
    throw RpcException(RpcError{ErrorCode::kInvalidParams, e.what(), e.hint, std::string(param),
                                AllowedValues(info)});
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
                 fmt::format("allowed: {}", AllowedText(info)), name, AllowedValues(info)});
  return SetCommand(info, *given, name);
}

/// One error of several. It blames the first, and has their code where they share one.
RpcError Together(std::vector<RpcError> errors, std::size_t more, bool one_code) {
  ProblemList problems;
  RpcError all = errors.front();
  for (RpcError& error : errors) {
    problems.Add(WithHint(error.message, error.hint));
    error.allowed.clear();  // every parameter, again and again
  }
  problems.AddUnkept(more);
  if (!one_code) all.code = ErrorCode::kInvalidParams;
  all.message = problems.Text();
  all.hint = "call param.list for names and ranges";
  all.errors = std::move(errors);
  all.more = more;
  return all;
}

/// The commands that set every member. Throws one error of all that is at fault.
std::vector<Command> ReadMembers(const Service& service, const JsonIn& members) {
  std::vector<Command> commands;
  std::vector<RpcError> errors;
  std::size_t more = 0;
  bool one_code = true;
  const auto add = [&](const RpcError& error) {
    one_code = one_code && (errors.empty() || errors.front().code == error.code);
    if (errors.size() < ProblemList::kMost)
      errors.push_back(error);
    else
      ++more;
  };
  RpcError unknown;
  unknown.code = ErrorCode::kNotFound;
  for (const auto& [name, value] : members.items()) {
    // Of thousands of unknown names the nearest would take long to find.
    if (errors.size() == ProblemList::kMost && FindParameter(name) < 0) {
      add(unknown);
      continue;
    }
    try {
      commands.push_back(ReadMember(service, name, value));
    } catch (const RpcException& refused) {
      add(refused.error());
    }
  }
  if (errors.empty()) return commands;
  throw RpcException(errors.size() == 1 ? errors.front()
                                        : Together(std::move(errors), more, one_code));
}

/// What is to be done for all to have the values that the commands give them.
std::vector<Command> Changes(const Service& service, std::vector<Command> commands) {
  std::ranges::stable_partition(commands, IsPreset, Row);
  Parameters reached = service.accepted().parameters;
  std::erase_if(commands, [&](const Command& command) {
    if (Row(command).get(reached) == command.value) return true;
    SetParameter(&reached, command);
    return false;
  });
  return commands;
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
  const std::vector<Command> commands = ReadMembers(service, params.Object("parameters"));
  const Json changed = service.ChangedParameters();
  const std::uint64_t barrier = service.SetParameters(Changes(service, commands));
  Json list = Json::array();
  for (const Command& command : commands) list.push_back(Entry(service, Row(command)));
  // Neither named nor overwritten by a preset.
  Json kept = Json::object();
  const Json now = service.ChangedParameters();
  for (const auto& [name, value] : now.items())
    if (changed.contains(name) && changed[name] == value) kept[name] = value;
  for (const Command& command : commands) kept.erase(std::string(Row(command).name));
  return {.result = {{"parameters", std::move(list)}, {"kept", std::move(kept)}},
          .barrier = barrier};
}

Outcome ParamReset(Service& service, const Params& params, Client&) {
  service.CheckAllowed(CommandType::kParameter);
  const Parameters defaults = service.accepted().defaults, before = service.accepted().parameters;
  std::vector<Command> commands;
  for (std::size_t i = 0; i < ParameterTable().size(); ++i) {
    const ParameterInfo& info = ParameterTable()[i];
    if (!Selected(info, params.String("name")) || info.get(before) == info.get(defaults)) continue;
    Command& command = commands.emplace_back();
    command.type = CommandType::kParameter;
    command.parameter = static_cast<int>(i);
    command.value = info.get(defaults);
  }
  const std::uint64_t barrier = service.SetParameters(commands);
  Json list = Json::array();
  for (const ParameterInfo& info : ParameterTable()) {  // a preset changes others, too
    if (info.get(before) == info.get(service.accepted().parameters)) continue;
    Json& entry = list.emplace_back(Entry(service, info));
    entry["before"] = ParameterValueJson(info, info.get(before));
  }
  return {.result = {{"parameters", std::move(list)}}, .barrier = barrier};
}

}  // namespace regrasp::handlers
