#include "cli/run/plot_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/run/run_window.h"
#include "core/files/draft.h"
#include "core/journal/provenance.h"

namespace regrasp::run {
namespace {

constexpr double kFrameRate = 50;     // [Hz] of pictures over time
constexpr int kMostFrames = 6000;     // of a picture: more is not seen
constexpr std::size_t kCompared = 2;  // explorations of one file

struct Pictured {
  std::vector<Frame> frames;
  std::vector<Event> events;
  LoadedScenario model;
  std::string changed, note;
};

/// Executes from tick `from` to `end`, or to the end of the job that begins there.
Pictured Execute(const std::string& path, double dt, std::int64_t from, std::int64_t end,
                 bool one_job) {
  RunWindow window(path, {static_cast<double>(from) * dt, static_cast<double>(end + 1) * dt});
  Replay& replay = window.replay();
  const auto run_to = [&](std::int64_t tick) {
    if (!replay.RunTo(tick))
      throw std::runtime_error(fmt::format("{}: the replay differs from the recording at tick {}",
                                           path, replay.divergence().tick));
  };
  const auto step =
      std::max<std::int64_t>(std::llround(1 / (kFrameRate * dt)), (end - from) / kMostFrames);
  Pictured result;
  run_to(from);
  replay.session().TakeEvents();
  const std::int64_t last = std::min(end, window.end_tick());
  for (std::int64_t tick = from;; tick = std::min(last, tick + std::max<std::int64_t>(1, step))) {
    run_to(tick);
    replay.session().Snapshot(&result.frames.emplace_back(), false);
    for (const Event& event : replay.session().TakeEvents()) result.events.push_back(event);
    if (tick == last || (one_job && tick > from && !replay.session().job_running())) break;
  }
  result.model = window.segment().journal->config.model;
  result.changed = ChangedText(replay.session().parameters(), result.model);
  result.note = window.note();
  return result;
}

/// The ticks at which jobs of this kind (any: all that start one) began, in the last segment.
std::vector<std::int64_t> JobStarts(const Segment& segment, bool explorations) {
  std::vector<std::int64_t> starts;
  for (const JournalEntry& entry : segment.journal->entries) {
    const CommandType type = entry.command.type;
    if (explorations ? type == CommandType::kExplore : JobMethodOf(type).has_value())
      starts.push_back(entry.tick);
  }
  return starts;
}

Pictured LastJob(const std::string& path, double last_s) {
  std::vector<McapChunk> chunks;
  const RunFile file = ReadJournals(path, &chunks);
  const Segment& segment = file.segments.back();
  const double dt = segment.journal->config.world.dt;
  const std::int64_t end = RunWindow(path, {}).end_tick();
  if (last_s > 0)
    return Execute(path, dt, std::max<std::int64_t>(0, end - std::llround(last_s / dt)), end,
                   false);
  const std::vector<std::int64_t> starts = JobStarts(segment, false);
  if (starts.empty())
    throw std::runtime_error(path + ": no job in the last segment; give --last SECONDS");
  return Execute(path, dt, starts.back(), end, true);
}

/// The last `count` explorations.
std::vector<Pictured> Explorations(const std::string& path, std::size_t count) {
  std::vector<McapChunk> chunks;
  const RunFile file = ReadJournals(path, &chunks);
  const Segment& segment = file.segments.back();
  std::vector<std::int64_t> starts = JobStarts(segment, true);
  if (starts.size() < count)
    throw std::runtime_error(fmt::format("{}: {} explorations in the last segment, {} are needed",
                                         path, starts.size(), count));
  starts.erase(starts.begin(), starts.end() - static_cast<std::ptrdiff_t>(count));
  const std::int64_t end = RunWindow(path, {}).end_tick();
  std::vector<Pictured> result;
  for (const std::int64_t start : starts)
    result.push_back(Execute(path, segment.journal->config.world.dt, start, end, true));
  return result;
}

std::vector<std::string> PlotComparison(const std::vector<std::string>& paths, PlotOptions options,
                                        const std::string& draft) {
  std::vector<Pictured> pictured;
  for (const std::string& path : paths)
    for (Pictured& one : Explorations(path, paths.size() == 1 ? kCompared : 1))
      pictured.push_back(std::move(one));
  std::vector<LabelledRun> runs;
  std::vector<std::string> notes;
  for (const Pictured& one : pictured) {
    runs.push_back({std::string(Name(one.frames.back().job.explore.criterion)), one.frames});
    if (!one.note.empty()) notes.push_back(one.note);
  }
  if (std::ranges::all_of(runs, [&](const auto& r) { return r.label == runs[0].label; }))
    for (std::size_t i = 0; i < runs.size(); ++i) runs[i].label += fmt::format(" ({})", i + 1);
  options.last_s = 0;
  options.object_name = pictured.front().model.object.name;
  options.changed = pictured.front().changed;
  PlotQualityComparison(runs, pictured.front().model.hand, options, draft);
  return notes;
}

}  // namespace

std::vector<std::string> PlotRuns(const std::vector<std::string>& paths, const std::string& name,
                                  PlotOptions options, const std::string& out) {
  const bool comparison = name == "comparison";
  if (!comparison && paths.size() > 1)
    throw std::runtime_error("only a comparison shows several runs");
  Draft draft(out, Draft::Existing::kReplace);
  std::vector<std::string> notes;
  if (comparison) {
    notes = PlotComparison(paths, options, draft.path());
  } else {
    const Pictured job = LastJob(paths.front(), options.last_s);
    options.last_s = 0;
    options.object_name = job.model.object.name;
    options.changed = job.changed;
    const HandModel& hand = job.model.hand;
    if (name == "quality")
      PlotQuality(job.frames, job.events, hand, options, draft.path());
    else if (name == "gait")
      PlotGait(job.frames, job.events, hand, options, draft.path());
    else if (name == "contacts")
      PlotContacts(job.frames, hand, job.model.object, options, draft.path());
    else if (name == "scene")
      PlotScene(job.frames.back(), hand, job.model.object, options, draft.path());
    else
      throw std::runtime_error(
          name + ": a run file has the pictures quality, contacts, gait, scene, comparison");
    if (!job.note.empty()) notes.push_back(job.note);
  }
  draft.Commit();
  return notes;
}

}  // namespace regrasp::run
