// Requests that produce files.

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <optional>

#include "core/files/output_file.h"
#include "core/journal/provenance.h"
#include "daemon/output/files.h"
#include "daemon/output/incident.h"
#include "daemon/requests/handlers.h"
#include "snapshots/plots.h"
#include "snapshots/refused.h"

namespace regrasp::handlers {
namespace {

const std::vector<std::string_view> kSuffixes(kPlotSuffixes.begin(), kPlotSuffixes.end());

/// Everything the worker needs, so that it shares nothing with the I/O thread.
struct Job {
  std::string name, file;  ///< file: empty, a free one is chosen
  std::filesystem::path directory;
  std::vector<std::shared_ptr<const Frame>> frames;
  std::vector<Event> events;
  std::vector<History::Exploration> explorations;
  std::shared_ptr<const Incident> incident;  ///< null: the picture is of something else
  std::shared_ptr<const FeltSurface> felt;   ///< may be null
  HandModel hand;
  std::shared_ptr<const ObjectModel> object;
  PlotOptions options;
  std::size_t most = 0;  ///< pictures in the directory
  bool overwrite = false;
  std::uintmax_t bytes = 0;
  std::optional<RpcError> error;
};

std::vector<Frame> Copy(const std::vector<std::shared_ptr<const Frame>>& frames) {
  std::vector<Frame> copy;
  copy.reserve(frames.size());
  for (const auto& frame : frames) copy.push_back(*frame);
  return copy;
}

/// Of what has been asked for, not of the file: without the names of ours.
RpcError Refusal(const Job& job, const PictureRefused& refused) {
  RpcError error{ErrorCode::kBadState, refused.cause(), "regrasp grasp --wait", {}, {}};
  if (job.options.last_s > 0)
    error.hint = fmt::format("regrasp plot {}    (without --last)", job.name);
  if (const auto* size = dynamic_cast<const PictureSizeRefused*>(&refused)) {
    error.code = ErrorCode::kInvalidParams;
    error.param = size->nearest_dpi > 0 ? "dpi" : "size_m";
    error.hint = size->nearest_dpi > 0
                     ? fmt::format("regrasp plot {} --size {:g} --dpi {:g}", job.name,
                                   job.options.width_mm, size->nearest_dpi)
                     : "regrasp help plot";
  }
  return error;
}

/// Throws RpcException where there is no such picture, whatever its file.
void DrawInto(const Job& job, const std::string& path) {
  PlotInput input;
  if (job.incident) {
    input = PictureOf(*job.incident, job.hand);
  } else {
    input.frames = Copy(job.frames);
    input.events = job.events;
    input.felt = job.felt;
    for (const History::Exploration& exploration : job.explorations)
      input.explorations.push_back(
          {Copy(exploration.frames), exploration.object, exploration.changed});
    input.hand = job.hand;
  }
  input.object = *job.object;
  input.options = job.options;
  try {
    DrawPlot(job.name, input, path);
  } catch (const PictureRefused& refused) {
    throw RpcException(Refusal(job, refused));
  }
}

/// Leaves room for one more: the oldest of those that nobody gave a name to go.
void MakeRoom(const Job& job) {
  std::vector<std::filesystem::path> pictures = FilesIn(job.directory, kSuffixes), ours;
  std::erase_if(pictures,
                [](const auto& file) { return file.filename().string().starts_with("incident-"); });
  if (pictures.size() < job.most) return;
  std::ranges::copy_if(pictures, std::back_inserter(ours), [](const auto& file) {
    const std::string stem = file.stem().string();
    const auto number = stem.find_last_of('-');
    return number != std::string::npos &&
           std::ranges::all_of(stem.substr(number + 1),
                               [](unsigned char c) { return std::isdigit(c); });
  });
  const std::size_t excess = pictures.size() + 1 - job.most;
  if (ours.size() < excess)
    throw std::runtime_error(fmt::format("{} pictures are in {}, as many as max_pictures allows",
                                         pictures.size(), job.directory.string()));
  RemoveOldest(ours, ours.size() - excess);
}

void Draw(Job* job) {
  try {
    MakeRoom(*job);
    // Chosen here, by the only thread that draws.
    if (job->file.empty())
      job->file = FreeFile(job->directory, job->name, ".png").filename().string();
    WriteOutput(job->directory / job->file,
                job->overwrite ? Draft::Existing::kReplace : Draft::Existing::kKeep,
                [job](const std::string& draft) {
                  DrawInto(*job, draft);
                  job->bytes = std::filesystem::file_size(draft);
                });
  } catch (const RpcException& e) {
    job->error = e.error();
  } catch (const std::exception& e) {
    const bool writable = ::access(job->directory.c_str(), W_OK | X_OK) == 0;
    const char* hint = writable ? "regrasp status    (output_dir)" : "regrasp up --output-dir DIR";
    job->error = {ErrorCode::kIo, e.what(), hint, {}, {}};
  }
}

void CheckPrinted(const Params& params) {
  for (const PrintedOnly& printed : kPrintedOnly)
    if (params.Has(printed.name) && !params.Has("size_m"))
      throw RpcException(RpcError{
          ErrorCode::kInvalidParams,
          fmt::format("{} says how a picture is printed, and size_m is missing", printed.name),
          "give the printed width, too: size_m",
          std::string(printed.name),
          {}});
}

}  // namespace

Outcome Plot(Service& service, const Params& params, Client&) {
  CheckPrinted(params);
  const auto job = std::make_shared<Job>();
  job->name = params.String("name");
  const PlotOf of = FindPlot(job->name)->of;
  job->directory = service.config().output_dir;
  job->most = service.config().budgets.pictures;
  job->overwrite = params.Bool("overwrite", false);
  if (params.Has("file"))
    job->file = CheckedFileName(params.String("file"), "file", kSuffixes, "quality.png");
  else if (job->overwrite)
    job->file = job->name + ".png";
  std::error_code ignored;
  if (!job->overwrite && !job->file.empty() &&
      std::filesystem::exists(job->directory / job->file, ignored))
    throw RpcException(RpcError{ErrorCode::kBadState,
                                fmt::format("{} exists", job->file),
                                "another name, or overwrite",
                                "file",
                                {}});
  job->options.last_s = params.Number("last_s", 0);
  job->options.width_mm = 1e3 * params.Number("size_m", 0);
  job->options.with_title = params.Bool("title", true);
  job->options.font_pt = params.Number("font_size_pt", job->options.font_pt);
  job->options.dpi = params.Number("dpi", 0);
  job->options.changed = ChangedText(service.accepted().parameters, service.journal().config.model);
  job->options.object_name = service.accepted().object->name;
  job->frames = service.history().Frames(job->options.last_s);
  if (of == PlotOf::kFeltSurface) service.CheckNotFaulted();
  if (of == PlotOf::kNewestFrame || of == PlotOf::kFeltSurface) {
    job->frames = {std::make_shared<const Frame>(service.newest().frame)};
    job->options.last_s = 0;
  }
  if (of == PlotOf::kIncident) {
    job->incident = service.incident();
    if (!job->incident)
      throw RpcException(ErrorCode::kNotFound,
                         "no incident: nothing was dropped since this daemon started",
                         "regrasp plot quality");
    job->frames = job->incident->frames;
    job->options.object_name = job->incident->object;
    job->options.changed = job->incident->changed_text;
  }
  if (job->frames.empty())
    throw RpcException(ErrorCode::kBadState, "nothing has happened yet", "regrasp grasp");
  if (of == PlotOf::kExplorations) {
    job->explorations = service.history().Explorations();
    if (job->explorations.size() < History::kExplorations)
      throw RpcException(ErrorCode::kBadState,
                         fmt::format("a {} shows the last {} explorations, there are {}", job->name,
                                     History::kExplorations, job->explorations.size()),
                         "regrasp explore ring --wait, then another with --criterion combined");
    job->frames = job->explorations.back().frames;
  }
  job->events = service.history().Events();
  job->hand = service.hand();
  job->object = service.accepted().object;
  const std::int64_t tick = job->incident ? job->incident->event.tick : job->frames.back()->tick;

  const auto draw = [&service, job, tick](Done done) {
    const auto finish = [job, tick, done] {
      if (job->error) return done({}, &*job->error);
      done({{"file", job->file},
            {"path", (job->directory / job->file).string()},
            {"bytes", job->bytes},
            {"tick", tick}},
           nullptr);
    };
    if (!service.host().Background([job] { Draw(job.get()); }, finish)) {
      const RpcError error{
          ErrorCode::kBusy, "too many pictures are being drawn", "try again later", {}, {}};
      done({}, &error);
    }
  };
  Outcome outcome;
  outcome.begin = draw;
  // What was felt is the control thread's; a session that has faulted is not asked any more.
  const bool faulted = service.newest().frame.state == SessionState::kFaulted;
  if (of == PlotOf::kFeltSurface || (of == PlotOf::kHistoryAndFelt && !faulted))
    outcome.begin = [&service, job, draw, of](Done done) {
      service.Mark(ControlRequest::Part::kFelt, [job, draw, of, done](const JournalNews& mark) {
        job->felt = mark.felt;
        if (of == PlotOf::kFeltSurface && mark.felt->touched_cells() == 0) {
          const RpcError error{
              ErrorCode::kBadState, "no finger has felt the object yet", "regrasp grasp", {}, {}};
          return done({}, &error);
        }
        draw(done);
      });
    };
  return outcome;
}

}  // namespace regrasp::handlers
