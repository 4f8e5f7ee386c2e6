#include "daemon/requests/service.h"

#include <fmt/format.h>

#include "core/common/nearest_name.h"
#include "core/files/draft.h"
#include "core/hand/kinematics.h"
#include "core/session/start.h"
#include "core/world/overlap_text.h"
#include "daemon/output/recorder.h"
#include "daemon/requests/handlers.h"
#include "daemon/wire/frame_json.h"

namespace regrasp {
std::string_view Version() { return REGRASP_VERSION; }

Service::Service(ServiceConfig config, Host* host)
    : config_(std::move(config)), host_(host), control_(config_.control) {
  const SessionConfig& session = config_.control.session;
  accepted_.parameters = session.parameters;
  accepted_.noise = session.noise;
  accepted_.seed = session.seed;
  AcceptObject(std::make_shared<const ObjectModel>(session.model.object));
  accepted_.paused = config_.control.paused;
  RemoveAbandonedDrafts(config_.output_dir);
  Drain();
}

void Service::PrepareModelText() {
  host_->Background(
      [text = model_text_, model = config_.control.session.model] { text->Of(model); }, [] {});
}

void Service::AcceptObject(std::shared_ptr<const ObjectModel> object) {
  const StartPosture start = MakeStart(hand(), config_.control.session.model.scenario,
                                       accepted_.parameters.start, accepted_.seed);
  KinematicsData data;
  ForwardKinematics(hand(), start.q_open, &data);
  const std::vector<Isometry3d> X_WL(
      data.X_WL.begin(), data.X_WL.begin() + static_cast<std::ptrdiff_t>(hand().links.size()));
  const StartOverlap overlap = DeepestOverlap(hand(), X_WL, *object, start.X_WO);
  Accepted& accepted = Accept();
  accepted.object = std::move(object);
  accepted.warnings.clear();
  const auto text = OverlapText(overlap, hand());
  if (text.front() != 0)
    accepted.warnings.push_back(text.data() + fmt::format("; grasp will refuse: {}", kFitsObject));
  SetDefaults();
}

Service::Accepted& Service::Accept() {
  ++accepted_changes_;
  return accepted_;
}

std::shared_ptr<Recorder> Service::SetRecorder(std::shared_ptr<Recorder> recorder) {
  ++recorder_changes_;
  return std::exchange(recorder_, std::move(recorder));
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

const Sample& Service::Topic(const std::string& topic) {
  if (std::exchange(topics_made_, changes()) != changes()) {
    topics_.clear();
    status_.reset();
  }
  Sample& sample = topics_[topic];
  const Frame& frame = newest_.frame;
  sample.time_s = frame.time_s;
  if (topic == "status") {
    if (!status_) status_.emplace(*this);
    sample.fields = status_->Fields(*this);
    return sample;
  }
  if (!sample.fields.empty()) return sample;
  const auto json = [&]() -> Json {
    if (topic == "contacts") return ContactsJson(frame, hand(), accepted_.parameters);
    if (topic == "joints") return JointsJson(frame, hand());
    if (topic == "quality") return QualityJson(frame, hand(), true);
    if (topic == kFrameQuality) return QualityJson(frame, hand(), false);
    return TruthJson(frame, hand());
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

void Service::SetDefaults() {
  const Parameters defaults = DefaultParameters(config_.control.session.model);
  Accept().defaults = ParametersAfterReset(defaults, accepted_.object.get());
}

Json Service::ChangedParameters() const {
  const Parameters& defaults = accepted_.defaults;
  Json changed = Json::object();
  for (const ParameterInfo& info : ParameterTable())
    if (info.get(accepted_.parameters) != info.get(defaults))
      changed[std::string(info.name)] = ParameterValueJson(info, info.get(accepted_.parameters));
  return changed;
}

std::string Service::SourceOfValue(const ParameterInfo& info) const {
  if (info.get(accepted_.parameters) == info.get(accepted_.defaults))
    return std::string(info.source);
  const auto origin = config_.parameter_origins.find(std::string(info.name));
  if (origin != config_.parameter_origins.end()) return "configuration, " + origin->second;
  return IsSetByPreset(info) && info.get(accepted_.parameters) == info.get(PresetValues())
             ? "gait.preset"
             : "set while running";
}

Parameters Service::PresetValues() const {
  Parameters values = accepted_.defaults;
  for (const ParameterInfo& info : ParameterTable())
    if (IsPreset(info)) SetByUser(info, info.get(accepted_.parameters), &values);
  return values;
}

}  // namespace regrasp
