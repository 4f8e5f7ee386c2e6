#include "cli/run/video.h"

#include <fmt/format.h>
#include <stdlib.h>

#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "core/files/draft.h"
#include "core/journal/replay.h"
#include "snapshots/snapshots.h"

namespace regrasp::run {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 1280, kSceneHeight = 640, kCurveHeight = 320;
constexpr double kWindow_s = 10;  // of the curves

/// A directory for single pictures, removed at the end.
struct Scratch {
  Scratch() {
    std::string name = (fs::temp_directory_path() / "regrasp-video-XXXXXX").string();
    if (!::mkdtemp(name.data())) throw std::runtime_error("cannot make a directory in /tmp");
    path = name;
  }
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  fs::path path;
};

}  // namespace

VideoResult WriteVideo(const RunFile& file, const VideoOptions& options, const std::string& out) {
  if (fs::path(out).extension() != ".mp4")
    throw std::runtime_error(out + ": a film's name ends in .mp4");
  RemoveAbandonedDrafts(fs::path(out).parent_path());
  Draft draft(out, Draft::Existing::kKeep);
  const Segment& segment = file.segments.back();
  const SessionConfig& config = segment.journal->config;
  const double dt = config.world.dt;
  const double end_s = std::min(options.to_s, static_cast<double>(segment.last_tick()) * dt);
  if (end_s <= options.from_s) throw std::runtime_error("nothing happens in this stretch of time");

  const Scratch scratch;
  const std::string scene_file = scratch.path / "scene.png",
                    curve_file = scratch.path / "curve.png";
  cv::VideoWriter writer(draft.path(), cv::VideoWriter::fourcc('m', 'p', '4', 'v'), options.fps,
                         {kWidth, kSceneHeight + kCurveHeight});
  if (!writer.isOpened()) throw std::runtime_error("cannot write " + out);

  Replay replay(segment.journal);
  const ObjectModel& object = config.model.object;
  PlotOptions scene, curve;
  scene.width = curve.width = kWidth;
  scene.height = kSceneHeight;
  curve.height = kCurveHeight;
  curve.last_s = kWindow_s;
  curve.object_name = object.name;
  std::vector<Frame> history;
  std::vector<Event> events;
  const double step_s = options.speed / options.fps;
  VideoResult result;
  for (double time = 0; time < end_s; time += step_s) {
    if (!replay.RunTo(std::llround(time / dt)))
      throw std::runtime_error(fmt::format("the replay differs from the recording at tick {}",
                                           replay.divergence().tick));
    Frame& frame = history.emplace_back();
    replay.session().Snapshot(&frame, false);
    for (const Event& event : replay.session().TakeEvents()) events.push_back(event);
    if (time < options.from_s || history.size() < 2) continue;
    PlotScene(frame, config.model.hand, object, scene, scene_file);
    PlotQuality(history, events, config.model.hand, curve, curve_file);
    cv::Mat picture;
    cv::vconcat(cv::imread(scene_file), cv::imread(curve_file), picture);
    writer.write(picture);
    ++result.frames;
  }
  writer.release();
  // The writer tells of no failure: what it could not write is missing.
  std::error_code error;
  if (result.frames == 0 || fs::file_size(draft.path(), error) == 0 || error)
    throw std::runtime_error("cannot write " + out);
  draft.Commit();
  result.duration_s = result.frames / options.fps;
  return result;
}

}  // namespace regrasp::run
