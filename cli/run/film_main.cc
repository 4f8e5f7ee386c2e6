// regrasp-film: films and pictures of run files. A program of its own, because it links OpenCV,
// which takes a tenth of a second to start.

#include <fmt/format.h>
#include <malloc.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>

#include "cli/print/progress_line.h"
#include "cli/run/plot_run.h"
#include "cli/run/program.h"
#include "cli/run/video.h"
#include "core/common/count_text.h"
#include "core/files/output_file.h"

namespace regrasp::run {
namespace {

using Clock = std::chrono::steady_clock;

std::atomic<int> signal_seen{0};
static_assert(std::atomic<int>::is_always_lock_free);

double SecondsSince(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// How far a film is.
class Progress {
 public:
  explicit Progress(bool wanted) : line_(wanted) {}
  bool operator()(int done, int total) {
    const auto now = Clock::now();
    if (line_.on() && now - told_ > std::chrono::milliseconds(200) && done > 0) {
      line_.Show(fmt::format("{} of {} pictures, {:.0f} s left", done, total,
                             SecondsSince(begin_) * (total - done) / done));
      told_ = now;
    }
    if (signal_seen == 0) return true;
    ::alarm(0);  // noticed: the film is put away, however long that takes
    return false;
  }

 private:
  cli::ProgressLine line_;
  const Clock::time_point begin_ = Clock::now();
  Clock::time_point told_;
};

ExitCode VideoCommand(const Command& command) {
  VideoOptions options;
  options.fps = command.Number("--fps", options.fps);
  options.speed = command.Number("--speed", options.speed);
  options.stretch = command.stretch();
  options.scene_only = command.Has("--scene-only");
  const std::string& out = command.options.at("--output");
  const auto begin = Clock::now();
  CheckWritable(out, Draft::Existing::kKeep);
  RunWindow window(command.file, options.stretch, kCurveWindow_s);
  const Json differences = TellDifferences(window.file());
  if (!window.note().empty()) Note(window.note());
  VideoResult result;
  {
    Progress progress(!command.json() && !command.Has("--quiet"));
    result = WriteVideo(&window, options, out,
                        [&](int done, int total) { return progress(done, total); });
  }
  if (result.interrupted) return ExitCode::kInterrupted;
  const double made_in_s = SecondsSince(begin);
  const std::vector<McapLoss> lost = window.Losses();
  Print(command,
        {{"path", out},
         {"frames", result.frames},
         {"duration_s", result.duration_s},
         {"made_in_s", made_in_s},
         {"codec", result.codec},
         {"complete", window.file().complete},
         {"differences", differences},
         {"lost", LossesJson(lost)}},
        fmt::format("{}: {}, {:.1f} s, {}, made in {:.1f} s ({:.2g} times real time)", out,
                    CountText(result.frames, "frame"), result.duration_s, result.codec, made_in_s,
                    result.duration_s / made_in_s) +
            EndText(window.file().complete) + LossesText(lost));
  return lost.empty() ? ExitCode::kOk : ExitCode::kFailed;
}

ExitCode PlotCommand(const Command& command) {
  PlotOptions options;
  options.last_s = command.Number("--last", 0);
  options.width_mm = command.Number("--size", 0);
  options.font_pt = command.Number("--font-size", options.font_pt);
  options.dpi = command.Number("--dpi", 0);
  options.with_title = !command.Has("--no-title");
  const std::string& out = command.options.at("--output");
  const PlotResult result = PlotRuns(command.files, command.options.at("--name"), options, out);
  for (const std::string& note : result.notes) Note(note);
  Print(command, {{"path", out}, {"complete", result.complete}, {"lost", LossesJson(result.lost)}},
        out);
  return result.lost.empty() ? ExitCode::kOk : ExitCode::kFailed;
}

}  // namespace
}  // namespace regrasp::run

int main(int argc, char** argv) {
  using namespace regrasp::run;
  // Every picture takes some 50 MB anew: what one gives back, the next one gets, also in another
  // thread.
  ::mallopt(M_MMAP_THRESHOLD, 32 << 20);
  ::mallopt(M_TRIM_THRESHOLD, 1 << 30);
  ::mallopt(M_ARENA_MAX, 1);
  // A film that is begun is put away; what takes longer than that to notice ends by the alarm.
  for (const int number : {SIGINT, SIGTERM, SIGHUP})
    std::signal(number, [](int seen) {
      signal_seen = seen;
      ::alarm(3);
    });
  return RunVerb(argc, argv, {{"plot", PlotCommand}, {"video", VideoCommand}});
}
