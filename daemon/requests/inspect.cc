// Requests that only look, and those about the connection itself.

#include <fmt/format.h>

#include "core/common/nearest_name.h"
#include "core/journal/journal.h"
#include "core/journal/journal_text.h"
#include "daemon/requests/handlers.h"
#include "daemon/wire/frame_json.h"

namespace regrasp {

namespace handlers {
namespace {

Json ParamDescription(Service& service, const ParamSpec& spec) {
  Json json = {{"name", spec.name},
               {"type", Name(spec.type)},
               {"required", spec.required},
               {"description", spec.sentence}};
  if (!spec.unit.empty()) json["unit"] = spec.unit;
  if (spec.min > -1e299) json["min"] = spec.min;
  if (spec.max < 1e299) json["max"] = spec.max;
  if (!spec.values.empty()) json["values"] = spec.values;
  if (spec.names != NameSource::kNone) json["values"] = service.Names(spec.names);
  if (!spec.required) json["default"] = spec.default_text;
  return json;
}

Json MethodDescription(Service& service, const MethodSpec& method) {
  Json params = Json::array();
  for (const ParamSpec& spec : method.params) params.push_back(ParamDescription(service, spec));
  return {{"name", method.name}, {"command", method.words},     {"description", method.sentence},
          {"job", method.job},   {"params", std::move(params)}, {"result", method.result}};
}

Outcome TopicAnswer(Service& service, const char* topic) {
  return {.text = "{" + service.Topic(topic).fields + "}"};
}

}  // namespace

Outcome Status(Service& service, const Params&, Client&) { return TopicAnswer(service, "status"); }
Outcome Contacts(Service& service, const Params&, Client&) {
  return TopicAnswer(service, "contacts");
}
Outcome Joints(Service& service, const Params&, Client&) { return TopicAnswer(service, "joints"); }
Outcome Quality(Service& service, const Params& params, Client&) {
  const bool all = params.String("measures", "all") == "all";
  return TopicAnswer(service, all ? "quality" : kFrameQuality);
}
Outcome Truth(Service& service, const Params&, Client&) { return TopicAnswer(service, "truth"); }

Outcome Describe(Service& service, const Params& params, Client&) {
  Json methods = Json::array();
  const std::string only = params.String("method");
  for (const MethodSpec& method : MethodTable())
    if (only.empty() || method.name == only) methods.push_back(MethodDescription(service, method));
  if (methods.empty()) {
    std::vector<std::string> names;
    for (const MethodSpec& method : MethodTable()) names.emplace_back(method.name);
    throw RpcException(RpcError{ErrorCode::kNotFound,
                                fmt::format("no method '{}'", only.substr(0, 64)),
                                DidYouMean(only, names), "method", std::move(names)});
  }
  Json errors = Json::array();
  for (const ErrorInfo& info : ErrorTable())
    errors.push_back({{"code", static_cast<int>(info.code)},
                      {"name", info.name},
                      {"exit_code", static_cast<int>(info.exit_code)},
                      {"description", info.sentence}});
  return {.result = {{"version", Version()},
                     {"protocol", kWireVersion},
                     {"methods", std::move(methods)},
                     {"errors", std::move(errors)}}};
}

Outcome Events(Service& service, const Params& params, Client&) {
  const auto& events = service.events();
  const auto count =
      std::min(events.size(), static_cast<std::size_t>(params.Integer("count", 100)));
  std::string list;
  for (std::size_t i = events.size() - count; i < events.size(); ++i)
    list += (list.empty() ? "" : ",") + events[i];
  return {.text =
              fmt::format(R"({{"events":[{}],"dropped":{}}})", list, service.control().dropped())};
}

Outcome Hello(Service&, const Params& params, Client&) {
  const auto [lowest, highest] = params.Pair("protocol");
  if (kWireVersion < lowest || kWireVersion > highest)
    throw RpcException(RpcError{ErrorCode::kProtocolVersion,
                                fmt::format("this daemon speaks protocol {}, the client {} to {}",
                                            kWireVersion, lowest, highest),
                                "use programs of one version",
                                "protocol",
                                {std::to_string(kWireVersion)}});
  return {.result = {{"protocol", kWireVersion}, {"version", Version()}, {"server", "regraspd"}}};
}

Outcome Identity(Service& service, const Params&, Client&) {
  const SessionConfig& session = service.config().control.session;
  LoadedScenario model = session.model;
  model.object = *service.accepted().object;
  const ModelHashes hashes = HashModels(model);
  const auto named = [](const std::string& name, std::uint64_t hash) {
    return Json{{"name", name}, {"hash", HashText(hash)}};
  };
  return {.result = {{"build", BuildIdentity()},
                     {"stepper", Name(session.world.stepper)},
                     {"models",
                      {{"scenario", named(model.scenario.name, hashes.scenario)},
                       {"hand", named(model.hand.name, hashes.hand)},
                       {"object", named(model.object.name, hashes.object)}}},
                     {"parameters", service.ChangedParameters()}}};
}

Outcome VersionOf(Service&, const Params&, Client&) {
  return {.result = {{"version", Version()}, {"protocol", kWireVersion}}};
}

Outcome Shutdown(Service& service, const Params&, Client&) {
  service.host().Shutdown();
  return {.result = {{"stopping", true}, {"activated", service.host().activated()}}};
}

Outcome Subscribe(Service&, const Params& params, Client& client) {
  return {
      .result = {{"sub", client.Subscribe(params.String("topic"), params.Number("rate_hz", 10))}}};
}

Outcome Unsubscribe(Service&, const Params& params, Client& client) {
  const std::int64_t sub = params.Integer("sub", 0);
  Json last = client.Unsubscribe(sub);
  if (last.is_null())
    throw RpcException(RpcError{ErrorCode::kNotFound,
                                fmt::format("no subscription {}", sub),
                                "subscriptions belong to their connection",
                                "sub",
                                {}});
  return {.result = std::move(last)};
}

}  // namespace handlers
}  // namespace regrasp
