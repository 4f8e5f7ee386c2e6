#include "core/journal/provenance.h"

#include "core/files/names.h"
#include "core/journal/model_fields.h"

namespace regrasp {
namespace {

template <typename Model>
std::string ModelText(Model model) {
  return fields::ToJson(model).dump();
}

void CompareModels(const LoadedScenario& recorded,
                   const std::vector<std::filesystem::path>& search_path,
                   std::vector<std::string>* differences) {
  const auto note = [&](const std::string& what, const std::string& name, const char* how) {
    differences->push_back("the model of the " + what + " '" + Shown(name) + "' " + how);
  };
  constexpr const char* kMissing = "is not installed here; the recorded one is used";
  constexpr const char* kOther = "is not the one installed here; the recorded one is used";
  try {
    const LoadedScenario here = LoadScenario(recorded.hand.name, "", search_path);
    if (ModelText(here.hand) != ModelText(recorded.hand)) note("hand", recorded.hand.name, kOther);
  } catch (const ModelError&) {
    note("hand", recorded.hand.name, kMissing);
  }
  try {
    const ObjectModel here = LoadObject(recorded.object.name, search_path);
    if (ModelText(here) != ModelText(recorded.object)) note("object", recorded.object.name, kOther);
  } catch (const ModelError&) {
    note("object", recorded.object.name, kMissing);
  }
}

}  // namespace

std::string ChangedText(const Parameters& parameters, const LoadedScenario& model) {
  const Parameters defaults = DefaultParameters(model);
  std::string text;
  for (const ParameterInfo& info : ParameterTable()) {
    const Vector3d value = info.get(parameters), usual = info.get(defaults);
    if (value == usual) continue;
    text += (text.empty() ? "" : ", ") + std::string(info.name) + " " + ParameterText(info, value) +
            " (" + ParameterText(info, usual) + ")";
  }
  return text;
}

std::vector<std::string> Differences(const SessionConfig& config, std::string_view build,
                                     const std::vector<std::filesystem::path>& search_path) {
  std::vector<std::string> differences = BuildAndParameterDifferences(config, build);
  std::vector<std::string> models;
  CompareModels(config.model, search_path, &models);
  const bool other_build = build != BuildIdentity();  // which is named first
  differences.insert(differences.begin() + (other_build ? 1 : 0), models.begin(), models.end());
  return differences;
}

std::vector<std::string> BuildAndParameterDifferences(const SessionConfig& config,
                                                      std::string_view build) {
  std::vector<std::string> differences;
  if (build != BuildIdentity())
    differences.push_back("the build: recorded by " + Shown(build) + ", this is " +
                          std::string(BuildIdentity()));
  const Parameters defaults = DefaultParameters(config.model);
  for (const ParameterInfo& info : ParameterTable()) {
    const Vector3d value = info.get(config.parameters), usual = info.get(defaults);
    if (value != usual)
      differences.push_back("parameter " + std::string(info.name) + " = " +
                            ParameterText(info, value) + " (default " + ParameterText(info, usual) +
                            ")");
  }
  return differences;
}

}  // namespace regrasp
