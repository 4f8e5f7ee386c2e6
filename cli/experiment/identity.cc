#include "cli/experiment/identity.h"

#include <fmt/format.h>

#include "cli/client/daemon_process.h"
#include "cli/client/errors.h"
#include "cli/print/print.h"

namespace regrasp::cli {
namespace {

/// {"hand": "NAME HASH", ...}
Json ModelsIn(const Json& identity) {
  Json models = Json::object();
  for (const auto& [kind, model] : identity.at("models").items())
    models[kind] = fmt::format("{} {}", Plain(model.at("name")), Plain(model.at("hash")));
  return models;
}

/// What was written down of a case.
const Json& OfCase(const Json& written, const Plan& plan, std::size_t which) {
  return plan.cases.empty() ? written : At(written, plan.cases.at(which).name.c_str());
}

/// A model as it was asked for, else by its name: a hand's scenario may name its file.
std::string Asked(const std::string& kind, const std::string& name, std::size_t which,
                  const Plan& plan) {
  const std::string asked = kind == "object" ? plan.setting(which).object : "";
  return asked.empty() ? name : asked;
}

[[noreturn]] void Refuse(const std::string& what, const std::string& was, const std::string& is) {
  throw CliError(
      kRefused,
      fmt::format("{} changed while the experiment ran: was \"{}\", is \"{}\"", what, was, is),
      "the same command goes on with what it was, with -o OTHER_DIR begins with what it is");
}

}  // namespace

void AddIdentity(SteppedDaemon* daemon, std::size_t which, Plan* plan) {
  const Json identity = daemon->Call("identity");
  plan->built_from = Plain(identity.at("build"));
  if (plan->cases.empty()) {
    plan->models = ModelsIn(identity);
    plan->parameters = identity.at("parameters");
  } else {
    plan->models[plan->cases.at(which).name] = ModelsIn(identity);
    plan->parameters[plan->cases.at(which).name] = identity.at("parameters");
  }
}

void CheckIdentity(SteppedDaemon* daemon, std::size_t which, const Plan& plan) {
  const Json identity = daemon->Call("identity");
  const Json& written = OfCase(plan.models, plan, which);
  const Json models = ModelsIn(identity);
  for (const char* kind : {"object", "hand", "scenario"})
    if (const Json& was = At(written, kind), &is = At(models, kind); was != is)
      Refuse(
          fmt::format("{} {}", kind,
                      Asked(kind, Plain(identity.at("models").at(kind).at("name")), which, plan)),
          Plain(was), Plain(is));
  if (const std::string build = DaemonBuild(); build != plan.build)
    Refuse(FindDaemon(), plan.build, build);
  const Json& parameters = OfCase(plan.parameters, plan, which);
  if (identity.at("parameters") != parameters)
    Refuse("a parameter's value", parameters.dump(), identity.at("parameters").dump());
}

}  // namespace regrasp::cli
