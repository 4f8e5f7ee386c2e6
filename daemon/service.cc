#include "daemon/service.h"

#include <fmt/format.h>

#include "daemon/frame_json.h"
#include "daemon/handlers.h"

namespace regrasp {
namespace {

constexpr std::size_t kMaxBacklog = 64;    // commands that wait for a tick
constexpr std::size_t kEventsKept = 1000;  // for `events`

}  // namespace

std::string_view Version() { return REGRASP_VERSION; }

Service::Service(ServiceConfig config, Host* host)
    : config_(std::move(config)), host_(host), control_(config_.control) {
  const SessionConfig& session = config_.control.session;
  accepted.parameters = session.parameters;
  accepted.noise = session.noise;
  accepted.seed = session.seed;
  accepted.object = std::make_shared<const ObjectModel>(session.model.object);
  accepted.paused = config_.control.paused;
  Drain();
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

std::vector<Event> Service::Drain() {
  // The control thread pushes a frame before the events and jobs it shows, so those are taken
  // first.
  std::vector<JobRecord> ended;
  for (JobRecord job; control_.PopJob(&job);) ended.push_back(job);
  std::vector<PublishedEvent> news;
  for (PublishedEvent event; control_.PopEvent(&event);) news.push_back(event);

  bool fresh = false;
  for (Published published; control_.PopFrame(&published);) {
    if (published.run != newest_.run) history_.Clear();
    history_.Add(published.frame);
    newest_ = published;
    fresh = true;
  }
  if (fresh) {
    ++frame_number_;
    const auto now = std::chrono::steady_clock::now();
    const double elapsed = std::chrono::duration<double>(now - sample_.wall).count();
    if (elapsed > 0.25) {
      const bool known = sample_.wall.time_since_epoch().count() != 0 && sample_.run == newest_.run;
      if (known) real_time_factor_ = (newest_.frame.time_s - sample_.time_s) / elapsed;
      sample_ = {now, newest_.frame.time_s, newest_.run};
    }
    if (newest_.frame.job.id != 0) jobs_.Update(newest_.frame.job);
    if (newest_.step.id != 0) jobs_.Update(newest_.step);
  }
  for (const JobRecord& job : ended) jobs_.Update(job);

  std::vector<Event> events;
  for (const PublishedEvent& published : news) {
    if (published.run == newest_.run) history_.Add(published.event);
    events_.push_back(published.event);
    if (events_.size() > kEventsKept) events_.pop_front();
    events.push_back(published.event);
  }
  return events;
}

Json Service::Topic(const std::string& topic) {
  const Frame& frame = newest_.frame;
  if (topic == "contacts") return ContactsJson(frame, hand());
  if (topic == "joints") return JointsJson(frame, hand());
  if (topic == "quality") return QualityJson(frame, hand(), accepted.parameters);
  if (topic == "truth") return TruthJson(frame, hand());
  return StatusJson(*this);
}

double Service::real_time_factor() const { return newest_.paused ? 0.0 : real_time_factor_; }

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
  }
  return names;
}

void Service::CheckNotFaulted() const {
  if (newest_.frame.state == SessionState::kFaulted)
    throw RpcException(ErrorCode::kSimulationFault, "the simulation has stopped on a fault",
                       "regrasp reset");
}

void Service::CheckAllowed(CommandType type) const {
  if (type != CommandType::kReset) CheckNotFaulted();
  const Verdict verdict = Check(type, newest_.frame.state, jobs_.Unfinished() != nullptr);
  if (verdict.kind == Verdict::Kind::kAllowed) return;
  const bool busy = verdict.kind == Verdict::Kind::kBusy;
  std::string message = verdict.reason;
  if (const JobRecord* job = jobs_.Unfinished(); busy && job)
    message += fmt::format(" (job {}: {})", job->id, Name(job->method));
  throw RpcException(busy ? ErrorCode::kBusy : ErrorCode::kBadState, std::move(message),
                     verdict.hint);
}

std::uint64_t Service::Post(ControlRequest request) {
  const std::uint64_t number = control_.Post(std::move(request));
  if (number == 0)
    throw RpcException(ErrorCode::kBusy, "the command queue is full", "try again in a moment");
  return number;
}

std::uint64_t Service::PostCommand(Command command) {
  if (control_.backlog() >= kMaxBacklog)
    throw RpcException(ErrorCode::kBusy,
                       fmt::format("{} commands are waiting for the next tick", kMaxBacklog),
                       accepted.paused ? "regrasp step 1" : "try again in a moment");
  ControlRequest request;
  request.command = std::move(command);
  return Post(std::move(request));
}

}  // namespace regrasp
