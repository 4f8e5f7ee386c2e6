#include "daemon/requests/service.h"

#include <fmt/format.h>

#include "core/files/draft.h"
#include "core/hand/kinematics.h"
#include "core/world/overlap_text.h"
#include "daemon/output/output_file.h"
#include "daemon/output/recorder.h"
#include "daemon/requests/handlers.h"
#include "daemon/wire/frame_json.h"

namespace regrasp {
std::string_view Version() { return REGRASP_VERSION; }

Service::Service(ServiceConfig config, Host* host)
    : config_(std::move(config)), host_(host), control_(config_.control) {
  const SessionConfig& session = config_.control.session;
  accepted.parameters = session.parameters;
  accepted.noise = session.noise;
  accepted.seed = session.seed;
  AcceptObject(std::make_shared<const ObjectModel>(session.model.object));
  accepted.paused = config_.control.paused;
  RemoveAbandonedDrafts(config_.output_dir);
  Drain();
}

void Service::AcceptObject(std::shared_ptr<const ObjectModel> object) {
  const Scenario& scenario = config_.control.session.model.scenario;
  KinematicsData data;
  ForwardKinematics(hand(), scenario.q_preshape, &data);
  const std::vector<Isometry3d> X_WL(
      data.X_WL.begin(), data.X_WL.begin() + static_cast<std::ptrdiff_t>(hand().links.size()));
  const StartOverlap overlap = DeepestOverlap(hand(), X_WL, *object, scenario.X_WO);
  accepted.object = std::move(object);
  accepted.warnings.clear();
  const auto text = OverlapText(overlap, hand());
  if (text.front() != 0)
    accepted.warnings.push_back(text.data() + std::string("; grasp will refuse"));
}

Outcome Service::Call(const std::string& method, const JsonIn& params, Client* client) {
  const MethodSpec* spec = FindMethod(method);
  const Handler handler = spec ? FindHandler(method) : nullptr;
  if (!handler) {
    std::vector<std::string> names;
    for (const MethodSpec& known : MethodTable()) names.emplace_back(known.name);
    std::string hint = DidYouMean(method, names);
    if (hint.empty()) hint = "call describe for the methods";
    throw RpcException(ErrorCode::kMethodNotFound,
                       fmt::format("no method '{}'", method.substr(0, 64)), std::move(hint));
  }
  const Params checked(*spec, params, [this](NameSource source) { return Names(source); });
  return handler(*this, checked, *client);
}

Json Service::JobAnswer(const JobRecord& job) const {
  Json json = JobJson(job, hand(), dt());
  const auto incident = job_incidents_.find(job.id);
  json["incident"] = incident == job_incidents_.end() ? Json() : incident->second;
  return json;
}

std::string Service::Members(const Json& object) {
  const std::string text = ToText(object);
  return text.substr(1, text.size() - 2);
}

const Sample& Service::Topic(const std::string& topic) {
  Sample& sample = topics_[topic];
  const bool changes_between_frames = topic == "status";
  if (!sample.fields.empty() && !changes_between_frames) return sample;
  const Frame& frame = newest_.frame;
  sample.time_s = frame.time_s;
  const auto json = [&]() -> Json {
    if (topic == "contacts") return ContactsJson(frame, hand(), accepted.parameters);
    if (topic == "joints") return JointsJson(frame, hand());
    if (topic == "quality") return QualityJson(frame, hand(), accepted.parameters);
    if (topic == "truth") return TruthJson(frame, hand());
    return StatusJson(*this);
  };
  sample.fields = Members(json());
  return sample;
}

std::vector<std::string> Service::Names(NameSource source) const {
  std::vector<std::string> names;
  switch (source) {
    case NameSource::kNone:
      break;
    case NameSource::kFinger:
      for (const Finger& finger : hand().fingers) names.push_back(finger.name);
      break;
    case NameSource::kObject:
      names = ListObjects(config_.search_path);
      break;
    case NameSource::kParameter:
      for (const ParameterInfo& info : ParameterTable()) names.emplace_back(info.name);
      break;
    case NameSource::kParameterGroup:
      for (const ParameterInfo& info : ParameterTable())
        if (names.empty() || names.back() != info.group()) names.emplace_back(info.group());
      break;
    case NameSource::kParameterOrGroup:
      names = Names(NameSource::kParameterGroup);
      for (const ParameterInfo& info : ParameterTable())
        if (info.name != info.group()) names.emplace_back(info.name);
      break;
  }
  return names;
}

Parameters Service::DefaultValues() const {
  Parameters defaults = DefaultParameters(config_.control.session.model);
  return ParametersAfterReset(defaults, accepted.object.get());
}

Json Service::ChangedParameters() const {
  const Parameters defaults = DefaultValues();
  Json changed = Json::object();
  for (const ParameterInfo& info : ParameterTable())
    if (info.get(accepted.parameters) != info.get(defaults))
      changed[std::string(info.name)] = ParameterValueJson(info, info.get(accepted.parameters));
  return changed;
}

std::string Service::SourceOfValue(const ParameterInfo& info) const {
  if (info.get(accepted.parameters) == info.get(DefaultValues())) return std::string(info.source);
  const auto origin = config_.parameter_origins.find(std::string(info.name));
  if (origin != config_.parameter_origins.end()) return "configuration, " + origin->second;
  return IsSetByPreset(info) && info.get(accepted.parameters) == info.get(PresetValues())
             ? "gait.preset"
             : "set while running";
}

Parameters Service::PresetValues() const {
  Parameters values = DefaultValues();
  for (const ParameterInfo& info : ParameterTable())
    if (IsPreset(info)) SetByUser(info, info.get(accepted.parameters), &values);
  return values;
}

}  // namespace regrasp
