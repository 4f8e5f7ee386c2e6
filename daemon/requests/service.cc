#include "daemon/requests/service.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "core/files/draft.h"
#include "core/hand/kinematics.h"
#include "core/world/start_overlap.h"
#include "daemon/output/files.h"
#include "daemon/output/incident.h"
#include "daemon/output/output_file.h"
#include "daemon/output/recorder.h"
#include "daemon/requests/handlers.h"
#include "daemon/wire/frame_json.h"

namespace regrasp {
namespace {

constexpr std::size_t kMaxBacklog =
    200;  // commands that wait for a tick; every parameter at once fits
constexpr std::size_t kEventsKept = 1000;  // for `events`
constexpr std::size_t kReserve = 1000;     // commands that end something are taken for longer
constexpr double kRetry_s = 0.2;           // while too many pictures are waiting to be drawn

const ParameterInfo& RowOf(const Command& command) {
  return ParameterTable()[static_cast<std::size_t>(command.parameter)];
}

/// What stands between the braces of an object.
std::string Members(const Json& object) {
  const std::string text = ToText(object);
  return text.substr(1, text.size() - 2);
}

}  // namespace

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
  if (overlap.depth > kStartOverlap)
    accepted.warnings.push_back(fmt::format(
        "the object begins {:.1f} mm inside the link {}; grasp will refuse", 1e3 * overlap.depth,
        hand().links[static_cast<std::size_t>(overlap.link)].name));
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

std::vector<Sample> Service::Drain() {
  // The control thread pushes a frame before the events and jobs it shows, so those are taken
  // first.
  TakeJobs();
  std::vector<PublishedEvent> news;
  for (PublishedEvent event; control_.PopEvent(&event);) news.push_back(event);

  // Journal news go before the frames that show them.
  TakeFrames();
  TakeInNews();
  const std::vector<Published> frames = std::exchange(frames_, {});

  const bool fresh = !frames.empty();
  for (const Published& published : frames) {
    if (published.run != newest_.run) history_.Clear();
    history_.Add(published.frame);
    if (recorder) recorder->Add(published);
    newest_ = published;
  }
  for (const PublishedEvent& published : news) {
    const Event& event = published.event;
    if (published.run == newest_.run) {
      history_.Add(event);
      // Before anybody hears of the drop, so that its record is there when they do.
      if (event.kind == EventKind::kDropped || event.kind == EventKind::kFault)
        RecordIncident(event);
    }
    if (recorder) recorder->Add(event, published.run);
    Json json = EventNewsJson(event, hand(), dt());
    if (json.contains("incident"))
      json["incident"] = incident_file_.empty() ? Json() : Json(incident_file_);
    Keep(std::move(json));
  }
  SaveStateIfDue();
  if (fresh) {
    ++frame_number_;
    topics_.clear();
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
  for (const JobRecord& job : ended_) jobs_.Update(job);
  ended_.clear();
  LookAfterRecorder();
  return std::exchange(news_, {});
}

void Service::Keep(Json event) {
  events_.push_back(ToText(event));
  if (events_.size() > kEventsKept) events_.pop_front();
  const double time_s = event["t_s"];
  event.erase("t_s");
  news_.push_back({time_s, Members(event)});
}

void Service::Tell(const char* kind, const std::string& text) {
  spdlog::warn("{}", text);
  Keep({{"tick", newest_.frame.tick},
        {"t_s", newest_.frame.time_s},
        {"kind", kind},
        {"finger", nullptr},
        {"value", 0.0},
        {"text", text}});
}

void Service::LookAfterRecorder() {
  if (!recorder) return;
  const Recorder::Numbers numbers = recorder->numbers();
  if (numbers.failure.empty() && !numbers.full) return;
  const std::string file = recorder->path().filename().string();
  recording_end = numbers.full ? fmt::format("{} has {} MB, as much as one run file may have", file,
                                             numbers.bytes >> 20)
                               : fmt::format("{}: {}", file, numbers.failure);
  Tell(numbers.full ? "recording_full" : "recording_failed", recording_end);
  const auto old = std::exchange(recorder, nullptr);
  if (!host_->Background([old] { old->Finish(); }, [] {})) old->Finish();
}

void Service::TakeJobs() {
  const auto room_for_another = [this] { return ended_.reserve(ended_.size() + 1), true; };
  for (JobRecord job; room_for_another() && control_.PopJob(&job);) ended_.push_back(job);
}

void Service::TakeFrames() {
  for (Published published; control_.PopFrame(&published);) frames_.push_back(published);
}

void Service::TakeInNews() {
  for (JournalNews item; untaken_ || control_.PopNews(&item); untaken_.reset()) {
    if (!untaken_) untaken_ = std::move(item);
    TakeIn(*untaken_);
  }
}

void Service::TakeIn(const JournalNews& news) {
  switch (news.kind) {
    case JournalNews::Kind::kBegin:
      journal_ = news.start->journal;
      run_ = news.run;
      if (recorder) recorder->Begin(journal_, run_);
      config_.control.session.world = journal_.config.world;  // a checkpoint brings its own
      config_.control.session.model.scenario = journal_.config.model.scenario;
      if (!news.start->restored) break;
      accepted.parameters = news.start->parameters;
      accepted.noise = news.start->noise;
      accepted.seed = news.start->seed;
      AcceptObject(std::make_shared<const ObjectModel>(journal_.config.model.object));
      break;
    case JournalNews::Kind::kCommand:
      journal_.entries.push_back(news.entry);
      if (recorder) recorder->Add(news.entry, news.run);
      break;
    case JournalNews::Kind::kMark:
      // What ended before the mark is known before whoever waits for the mark hears of it.
      TakeJobs();
      TakeFrames();
      if (const auto mark = marks_.extract(news.request)) mark.mapped()(news);
      break;
  }
}

void Service::Mark(std::function<void(const JournalNews&)> told) {
  CheckNotRestoring();
  marks_.emplace(Post({.kind = ControlRequest::Kind::kMark}), std::move(told));
}

void Service::AfterTaken(std::uint64_t request, std::function<void()> then) {
  after_taken_.emplace(request, std::move(then));
}

void Service::OnAcknowledged(std::uint64_t request) {
  while (!after_taken_.empty() && after_taken_.begin()->first <= request)
    after_taken_.extract(after_taken_.begin()).mapped()();
}

void Service::SaveStateIfDue() {
  if (!recorder || !recorder->TakeStateDue(newest_)) return;
  try {
    Mark([this](const JournalNews& mark) {
      if (recorder && mark.saved && !mark.saved->empty()) recorder->Add(mark);
    });
  } catch (const RpcException&) {  // the queue is full: the next one will do
  }
}

void Service::RecordIncident(const Event& event) {
  IncidentSource source;
  source.event = event;
  source.frames = history_.Recent();
  source.events = history_.Events();
  source.job = newest_.frame.job;
  source.parameters = accepted.parameters;
  source.object = accepted.object->name;
  source.dt = dt();
  const auto incident = std::make_shared<const Incident>(MakeIncident(source, hand()));
  const auto record = FreeFile(config_.output_dir, IncidentName(event.tick), ".json");
  const auto picture = std::filesystem::path(record).replace_extension(".png");
  incident_file_ = record.filename().string();
  incident_ = incident;
  incident_summary_ = {{"tick", event.tick},         {"time_s", incident->time_s},
                       {"seed", newest_.frame.seed}, {"cause", incident->cause},
                       {"record", record.string()},  {"picture", picture.string()}};
  if (incident->job.id != 0) job_incidents_[incident->job.id] = incident_summary_;
  if (job_incidents_.size() > JobTable::kKept) job_incidents_.erase(job_incidents_.begin());
  spdlog::warn("{}", incident->cause);
  try {
    WriteWhole(record, IncidentText(*incident, hand()), Draft::Existing::kKeep, false);
  } catch (const std::exception& e) {
    Tell("incident_not_recorded", fmt::format("no record of the incident: {}", e.what()));
    incident_file_.clear();
  }
  DrawIncidentLater(incident, picture);
}

void Service::DrawIncidentLater(std::shared_ptr<const Incident> incident,
                                std::filesystem::path picture) {
  const auto draw = [incident, picture, hand = hand(), keep = config_.budgets.incidents] {
    try {
      WriteOutput(picture, Draft::Existing::kReplace,
                  [&](const std::string& draft) { DrawIncident(*incident, hand, 0, draft); });
      PruneIncidents(picture.parent_path(), keep);
    } catch (const std::exception& e) {
      spdlog::error("no picture of the incident: {}", e.what());
    }
  };
  if (host_->Background(draw, [] {})) return;
  host_->After(kRetry_s, [this, incident, picture] { DrawIncidentLater(incident, picture); });
}

Json Service::JobAnswer(const JobRecord& job) const {
  Json json = JobJson(job, hand(), dt());
  const auto incident = job_incidents_.find(job.id);
  json["incident"] = incident == job_incidents_.end() ? Json() : incident->second;
  return json;
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

double Service::real_time_factor() const { return newest_.advancing ? real_time_factor_ : 0.0; }

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

void Service::CheckNotFaulted() const {
  if (newest_.frame.state == SessionState::kFaulted)
    throw RpcException(ErrorCode::kSimulationFault, "the simulation has stopped on a fault",
                       "regrasp reset");
}

void Service::CheckMeasure(const Parameters& parameters, JobMethod method,
                           Criterion criterion) const {
  const Verdict verdict = regrasp::CheckMeasure(parameters, method, criterion);
  if (verdict.kind != Verdict::Kind::kAllowed)
    throw RpcException(ErrorCode::kBadState, verdict.reason, verdict.hint);
}

void Service::CheckNotRestoring() const {
  if (const JobRecord* job = jobs_.Restoring())
    throw RpcException(ErrorCode::kBusy,
                       fmt::format("a checkpoint is being restored (job {})", job->id),
                       fmt::format("regrasp job wait {}", job->id));
}

void Service::CheckAllowed(CommandType type) const {
  CheckNotFaulted();
  const Verdict verdict = Check(type, newest_.frame.state, jobs_.Unfinished() != nullptr);
  if (verdict.kind == Verdict::Kind::kAllowed) return;
  const bool busy = verdict.kind == Verdict::Kind::kBusy;
  std::string message = verdict.reason;
  if (const JobRecord* job = jobs_.Unfinished(); busy && job)
    message += fmt::format(" (job {}: {})", job->id, Name(job->method));
  throw RpcException(busy ? ErrorCode::kBusy : ErrorCode::kBadState, std::move(message),
                     verdict.hint);
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

void Service::OrderForJob(const JobRecord& job, std::vector<Command>* commands) const {
  Parameters reached = accepted.parameters;
  for (auto next = commands->begin(); next != commands->end(); ++next) {
    const auto verdict = [&](const Command& command) {
      Parameters then = reached;
      SetParameter(&then, command);
      return regrasp::CheckMeasure(then, job.method, job.explore.criterion);
    };
    const auto fits = std::find_if(next, commands->end(), [&](const Command& command) {
      const bool lost = IsPreset(RowOf(*next)) && IsSetByPreset(RowOf(command));
      return !lost && verdict(command).kind == Verdict::Kind::kAllowed;
    });
    if (fits == commands->end()) {
      const Verdict refusal = verdict(*next);
      throw RpcException(ErrorCode::kBadState, refusal.reason, refusal.hint);
    }
    std::rotate(next, fits, fits + 1);
    SetParameter(&reached, *next);
  }
}

std::uint64_t Service::SetParameters(std::vector<Command> commands) {
  std::ranges::stable_partition(commands, IsPreset, RowOf);
  if (const JobRecord* job = jobs_.Unfinished()) OrderForJob(*job, &commands);
  CheckMayPost(commands.size(), 0);
  const Parameters before = accepted.parameters;
  std::uint64_t barrier = 0;
  for (const Command& command : commands) {
    barrier = PostCommand(command);
    SetParameter(&accepted.parameters, command);
    config_.parameter_origins.erase(std::string(RowOf(command).name));
  }
  for (const ParameterInfo& info : ParameterTable())
    if (info.get(before) != info.get(accepted.parameters))
      config_.parameter_origins.erase(std::string(info.name));
  return barrier;
}

std::uint64_t Service::Post(ControlRequest request) {
  topics_.clear();  // what is accepted shows in them
  const std::uint64_t number = control_.Post(std::move(request));
  if (number == 0)
    throw RpcException(ErrorCode::kBusy, "the command queue is full", "try again in a moment");
  return number;
}

std::uint64_t Service::PostCommand(Command command) {
  const bool ends = command.type == CommandType::kStop || command.type == CommandType::kCancelJob ||
                    command.type == CommandType::kRelease;
  CheckMayPost(1, ends ? kReserve : 0);
  ControlRequest request;
  request.command = std::move(command);
  return Post(std::move(request));
}

void Service::CheckMayPost(std::size_t commands, std::size_t reserve) const {
  CheckNotRestoring();
  const std::size_t known = journal_.entries.size() + control_.backlog();
  if (known + commands > config_.budgets.commands + reserve)
    throw RpcException(
        ErrorCode::kBusy,
        fmt::format("the run has {} commands, as many as are kept of one", journal_.entries.size()),
        "regrasp reset");
  CheckRoom(commands);
}

void Service::CheckRoom(std::size_t commands) const {
  if (control_.backlog() + commands > kMaxBacklog)
    throw RpcException(ErrorCode::kBusy,
                       fmt::format("{} commands are waiting for the next tick", kMaxBacklog),
                       accepted.paused ? "regrasp step 1" : "try again in a moment");
}

}  // namespace regrasp
