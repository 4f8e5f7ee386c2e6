// What the control loop has told: frames, events, jobs, the journal, incidents.

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "core/files/draft.h"
#include "core/files/output_file.h"
#include "core/journal/provenance.h"
#include "daemon/output/files.h"
#include "daemon/output/incident.h"
#include "daemon/output/recorder.h"
#include "daemon/requests/service.h"
#include "daemon/wire/frame_json.h"
#include "snapshots/plots.h"

namespace regrasp {
namespace {

constexpr std::size_t kEventsKept = 1000;  // for `events`
constexpr double kRetry_s = 0.2;           // while too many pictures are waiting to be drawn
constexpr double kSpeedSample_s = 0.25;    // least, for the speed of simulated time

}  // namespace

std::vector<Sample> Service::Drain() {
  // The control thread pushes events, the frame that shows them, and the jobs that have ended
  // there; journal news go before the frames that show them. Taken the other way round, nothing
  // that shows something else comes without it.
  TakeJobs();
  TakeFrames();
  TakeInNews();
  for (PublishedEvent event; control_.PopEvent(&event);) untold_events_.push_back(event);
  const std::vector<Published> frames = std::exchange(frames_, {});

  const bool fresh = !frames.empty();
  for (const Published& published : frames) {
    if (published.run != newest_.run) history_.Clear();
    if (history_.Add(published.frame))
      history_.DescribeExploration(accepted_.object->name,
                                   ChangedText(accepted_.parameters, journal_.config.model));
    if (recorder_) recorder_->Add(published);
    newest_ = published;
    ++frame_number_;
  }
  // Those whose frame is not here yet wait for it.
  const auto waiting = std::ranges::find_if(
      untold_events_, [this](const PublishedEvent& told) { return told.frame > newest_.number; });
  const std::vector<PublishedEvent> later(waiting, untold_events_.end());
  untold_events_.erase(waiting, untold_events_.end());
  for (const PublishedEvent& published : std::exchange(untold_events_, later)) {
    const Event& event = published.event;
    if (published.run == newest_.run) {
      history_.Add(event);
      // Before anybody hears of the drop, so that its record is there when they do.
      if (event.kind == EventKind::kDropped || event.kind == EventKind::kFault)
        RecordIncident(event);
    }
    if (recorder_) recorder_->Add(event, published.run);
    Json json = EventNewsJson(event, hand(), dt());
    if (json.contains("incident"))
      json["incident"] = incident_file_.empty() ? Json() : Json(incident_file_);
    Keep(std::move(json));
  }
  SaveStateIfDue();
  if (fresh) {
    MeasureSpeed();
    if (newest_.frame.job.id != 0) jobs_.Update(newest_.frame.job);
    if (newest_.step.id != 0) jobs_.Update(newest_.step);
  }
  for (const JobRecord& job : ended_) jobs_.Update(job);
  ended_.clear();
  LookAfterRecorder();
  return std::exchange(news_, {});
}

void Service::MeasureSpeed() {
  if (!newest_.advancing) {
    sample_.reset();
    real_time_factor_.reset();
    return;
  }
  const auto now = std::chrono::steady_clock::now();
  const SpeedSample newest{now, newest_.frame.time_s, newest_.run};
  if (!sample_ || sample_->run != newest.run) {
    sample_ = newest;
    return;
  }
  const double elapsed = std::chrono::duration<double>(now - sample_->wall).count();
  if (elapsed < kSpeedSample_s) return;
  real_time_factor_ = (newest.time_s - sample_->time_s) / elapsed;
  sample_ = newest;
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
  if (!recorder_) return;
  const Recorder::Numbers numbers = recorder_->numbers();
  if (numbers.failure.empty() && !numbers.full) return;
  const std::string file = recorder_->path().filename().string();
  recording_end = numbers.full ? fmt::format("{} has {} MB, as much as one run file may have", file,
                                             numbers.bytes >> 20)
                               : fmt::format("{}: {}", file, numbers.failure);
  Tell(numbers.full ? "recording_full" : "recording_failed", recording_end);
  const auto old = SetRecorder(nullptr);
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
  bool journal = false;
  for (JournalNews item; untaken_ || control_.PopNews(&item); untaken_.reset()) {
    if (!untaken_) untaken_ = std::move(item);
    TakeIn(*untaken_);
    journal = journal || untaken_->kind != JournalNews::Kind::kMark;
  }
  // Nobody hears of what a command did before the run file has it, unless the disk is slow.
  if (journal && recorder_) recorder_->AwaitJournal();
}

void Service::TakeIn(const JournalNews& news) {
  switch (news.kind) {
    case JournalNews::Kind::kBegin: {
      const Stepper before = config_.control.session.world.stepper;
      journal_ = news.start->journal;
      run_ = news.run;
      if (recorder_) recorder_->Begin(journal_, run_);
      config_.control.session.world = journal_.config.world;  // a checkpoint brings its own
      config_.control.session.model.scenario = journal_.config.model.scenario;
      SetDefaults();
      if (!news.start->restored) break;
      if (journal_.config.world.stepper != before)
        config_.stepper_reason = "that of the checkpoint's run";
      Accept().parameters = news.start->parameters;
      Accept().noise = news.start->noise;
      Accept().seed = news.start->seed;
      AcceptObject(std::make_shared<const ObjectModel>(journal_.config.model.object));
      break;
    }
    case JournalNews::Kind::kCommand:
      journal_.entries.push_back(news.entry);
      if (recorder_) recorder_->Add(news.entry, news.run);
      break;
    case JournalNews::Kind::kMark:
      // What ended before the mark is known before whoever waits for the mark hears of it.
      TakeJobs();
      TakeFrames();
      if (const auto mark = marks_.extract(news.request)) mark.mapped()(news);
      break;
  }
}

void Service::Mark(ControlRequest::Part part, std::function<void(const JournalNews&)> told) {
  CheckNotRestoring();
  marks_.emplace(Post({.kind = ControlRequest::Kind::kMark, .part = part}), std::move(told));
}

void Service::AfterTaken(std::uint64_t request, std::function<void()> then) {
  after_taken_.emplace(request, std::move(then));
}

void Service::OnAcknowledged(std::uint64_t request) {
  while (!after_taken_.empty() && after_taken_.begin()->first <= request)
    after_taken_.extract(after_taken_.begin()).mapped()();
}

void Service::SaveStateIfDue() {
  if (!recorder_ || !recorder_->TakeStateDue(newest_)) return;
  try {
    Mark(ControlRequest::Part::kState, [this](const JournalNews& mark) {
      if (recorder_ && mark.saved && !mark.saved->empty()) recorder_->Add(mark);
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
  source.parameters = accepted_.parameters;
  source.changed = ChangedParameters();
  source.changed_text = ChangedText(accepted_.parameters, journal().config.model);
  source.object = accepted_.object->name;
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
  ++incidents_;
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
      WriteOutput(picture, Draft::Existing::kReplace, [&](const std::string& draft) {
        DrawPlot("incident", PictureOf(*incident, hand), draft);
      });
      PruneIncidents(picture.parent_path(), keep);
    } catch (const std::exception& e) {
      spdlog::error("no picture of the incident: {}", e.what());
    }
  };
  if (host_->Background(draw, [] {})) return;
  host_->After(kRetry_s, [this, incident, picture] { DrawIncidentLater(incident, picture); });
}

}  // namespace regrasp
