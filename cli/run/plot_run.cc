#include "cli/run/plot_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "cli/client/errors.h"
#include "cli/run/run_window.h"
#include "core/files/output_file.h"
#include "core/files/shell_word.h"
#include "core/journal/provenance.h"
#include "core/mcap/without_end.h"
#include "snapshots/plots.h"
#include "snapshots/refused.h"

namespace regrasp::run {
namespace {

namespace fs = std::filesystem;

constexpr double kFrameRate = 50;     // [Hz] of pictures over time
constexpr int kMostFrames = 6000;     // of a picture: more is not seen
constexpr std::size_t kCompared = 2;  // explorations of one file

using cli::CliError;

/// As the user called the file, or nearly. What is to be typed has the whole path: a name alone is
/// found only in this directory, or by a daemon.
std::string Name(const std::string& path) { return fs::path(path).filename().string(); }

std::string PlotCommand(std::string_view plot, const std::string& path) {
  return fmt::format("regrasp plot {} {}", plot, ShellWord(path));
}

/// Of what has been asked for, not of the picture's file.
CliError Refusal(const PictureRefused& refused, const std::string& plot, const std::string& path,
                 const PlotOptions& options, double last_s) {
  const std::string command = PlotCommand(plot, path);
  if (const auto* size = dynamic_cast<const PictureSizeRefused*>(&refused))
    return {ExitCode::kUsage, size->cause(),
            size->nearest_dpi > 0 ? fmt::format("{} --size {:g} --dpi {:g}", command,
                                                options.width_mm, size->nearest_dpi)
                                  : "regrasp help plot"};
  return {ExitCode::kRefused, fmt::format("{}: {}", Name(path), refused.cause()),
          last_s > 0 ? fmt::format("{}    (without --last)", command)
                     : fmt::format("{} --last 10    (the last 10 s)", command)};
}

struct Pictured {
  PlotInput input;
  std::vector<std::string> notes;
  std::vector<McapLoss> lost;
  bool complete = true;
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
    replay.session().Snapshot(&result.input.frames.emplace_back(), false);
    for (const Event& event : replay.session().TakeEvents()) result.input.events.push_back(event);
    if (tick == last || (one_job && tick > from && !replay.session().job_running())) break;
  }
  const LoadedScenario& model = window.segment().journal->config.model;
  result.input.felt = std::make_shared<const FeltSurface>(replay.session().felt_surface());
  result.input.hand = model.hand;
  result.input.object = model.object;
  result.input.options.object_name = model.object.name;
  result.input.options.changed = ChangedText(replay.session().parameters(), model);
  if (!window.note().empty()) result.notes.push_back(window.note());
  result.complete = window.file().complete;
  // The last frame is that after the job's end, up to a step later.
  const JobRecord& job = result.input.frames.back().job;
  result.lost =
      window.Losses(one_job && job.end_tick > from ? job.end_tick : replay.session().tick());
  if (!result.complete) result.notes.push_back(WithoutEndText(Name(path)));
  for (const McapLoss& loss : result.lost)
    result.notes.push_back(fmt::format("{} lost {}", Name(path), LossText(loss)));
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

Pictured LastJob(const PlotRow& plot, const std::string& path, double last_s) {
  std::vector<McapChunk> chunks;
  const RunFile file = ReadJournals(path, &chunks);
  const Segment& segment = file.segments.back();
  const double dt = segment.journal->config.world.dt;
  const std::int64_t end = RunWindow(path, {}).end_tick();
  if (last_s > 0)
    return Execute(path, dt, std::max<std::int64_t>(0, end - std::llround(last_s / dt)), end,
                   false);
  const std::vector<std::int64_t> starts = JobStarts(segment, false);
  if (starts.empty()) {
    const bool needs_touch = plot.of != PlotOf::kHistory && plot.of != PlotOf::kNewestFrame;
    throw CliError(
        ExitCode::kRefused, Name(path) + ": no job in the last segment",
        PlotCommand(needs_touch ? "quality" : plot.name, path) + " --last 10    (the last 10 s)");
  }
  return Execute(path, dt, starts.back(), end, true);
}

/// The last `count` jobs in which a finger explored: others were refused.
std::vector<Pictured> Explorations(const std::string& path, std::size_t count) {
  std::vector<McapChunk> chunks;
  const RunFile file = ReadJournals(path, &chunks);
  const Segment& segment = file.segments.back();
  std::vector<std::int64_t> starts = JobStarts(segment, true);
  const std::int64_t end = RunWindow(path, {}).end_tick();
  std::vector<Pictured> result;
  for (; !starts.empty() && result.size() < count; starts.pop_back()) {
    Pictured one = Execute(path, segment.journal->config.world.dt, starts.back(), end, true);
    const auto explores = [](const Frame& frame) { return frame.exploration.active; };
    if (std::ranges::any_of(one.input.frames, explores))
      result.insert(result.begin(), std::move(one));
  }
  if (result.size() < count)
    throw CliError(ExitCode::kRefused,
                   fmt::format("{}: {} explorations in the last segment, {} are needed", Name(path),
                               result.size(), count),
                   PlotCommand("quality", path));
  return result;
}

/// The last explorations of all files, their frames moved into the first one's input.
std::vector<Pictured> Compared(const std::vector<std::string>& paths) {
  std::vector<Pictured> all;
  for (const std::string& path : paths)
    for (Pictured& one : Explorations(path, paths.size() == 1 ? kCompared : 1))
      all.push_back(std::move(one));
  for (Pictured& one : all)
    all.front().input.explorations.push_back(
        {std::move(one.input.frames), one.input.options.object_name, one.input.options.changed});
  return all;
}

std::string PicturesOfRuns() {
  std::string names;
  for (const PlotRow& plot : kPlotTable)
    if (plot.of != PlotOf::kIncident) names += (names.empty() ? "" : ", ") + std::string(plot.name);
  return names;
}

}  // namespace

PlotResult PlotRuns(const std::vector<std::string>& paths, const std::string& name,
                    PlotOptions options, const std::string& out) {
  const PlotRow* plot = FindPlot(name);
  if (plot == nullptr || plot->of == PlotOf::kIncident)
    throw CliError(ExitCode::kUsage, name + ": a run file has the pictures " + PicturesOfRuns(),
                   PlotCommand("quality", paths.front()));
  const bool comparison = plot->of == PlotOf::kExplorations;
  if (!comparison && paths.size() > 1)
    throw CliError(ExitCode::kUsage,
                   fmt::format("{} shows one run, {} are given; only comparison shows several",
                               name, paths.size()),
                   PlotCommand(name, paths.front()));
  CheckWritable(out, Draft::Existing::kReplace);
  std::vector<Pictured> runs;
  if (comparison)
    runs = Compared(paths);
  else
    runs.push_back(LastJob(*plot, paths.front(), options.last_s));
  PlotInput input = std::move(runs.front().input);
  const double last_s = std::exchange(options.last_s, 0);
  options.object_name = input.options.object_name;
  options.changed = input.options.changed;
  input.options = options;
  WriteOutput(out, Draft::Existing::kReplace, [&](const std::string& draft) {
    try {
      DrawPlot(name, input, draft);
    } catch (const PictureRefused& refused) {
      throw Refusal(refused, name, paths.front(), options, last_s);
    }
  });
  PlotResult result;
  for (const Pictured& run : runs) {
    for (const std::string& note : run.notes)
      if (std::ranges::find(result.notes, note) == result.notes.end()) result.notes.push_back(note);
    result.lost.insert(result.lost.end(), run.lost.begin(), run.lost.end());
    result.complete = result.complete && run.complete;
  }
  return result;
}

}  // namespace regrasp::run
