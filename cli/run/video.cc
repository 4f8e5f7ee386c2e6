#include "cli/run/video.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <future>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "cli/run/gif.h"
#include "cli/run/mp4_index.h"
#include "core/files/lower_suffix.h"
#include "core/files/output_file.h"
#include "snapshots/snapshots.h"

namespace regrasp::run {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 1280, kSceneHeight = 640, kCurveHeight = 320;

class Film {
 public:
  virtual ~Film() = default;
  virtual void Add(const cv::Mat& picture) = 0;
  /// Throws std::runtime_error when something could not be written.
  virtual void Finish() = 0;
};

class H264Film : public Film {
 public:
  H264Film(const std::string& path, double fps, cv::Size size) : path_(path) {
    writer_.open(path, cv::CAP_FFMPEG, cv::VideoWriter::fourcc('a', 'v', 'c', '1'), fps, size);
    if (!writer_.isOpened())
      throw std::runtime_error(
          "no H.264 encoder: OpenCV's FFmpeg has none; install libx264 (Debian: libavcodec59), or "
          "make a .gif");
  }
  void Add(const cv::Mat& picture) override { writer_.write(picture); }
  void Finish() override {
    writer_.release();
    // The writer tells of no failure: what it could not write is missing.
    std::error_code error;
    if (fs::file_size(path_, error) == 0 || error)
      throw std::runtime_error("cannot write " + path_);
    PutIndexFirst(path_);
  }

 private:
  std::string path_;
  cv::VideoWriter writer_;
};

class GifFilm : public Film {
 public:
  GifFilm(const std::string& path, double fps, cv::Size size)
      : size_(size / 2), gif_(path, size_.width, size_.height, 1 / fps) {}
  void Add(const cv::Mat& picture) override {
    cv::Mat small;
    cv::resize(picture, small, size_, 0, 0, cv::INTER_AREA);
    gif_.Add({small.data, small.total() * small.elemSize()});
  }
  void Finish() override { gif_.Finish(); }

 private:
  cv::Size size_;
  Gif gif_;
};

/// Draws moments, several at a time.
class Painter {
 public:
  Painter(const SessionConfig& config, bool scene_only)
      : config_(config), keep_s_(scene_only ? 0 : kCurveWindow_s) {
    scene_.width = curve_.width = kWidth;
    scene_.height = kSceneHeight;
    curve_.height = kCurveHeight;
    curve_.last_s = kCurveWindow_s;
    curve_.object_name = config.model.object.name;
  }
  cv::Size size() const { return {kWidth, kSceneHeight + (scene_only() ? 0 : kCurveHeight)}; }

  /// Keeps the moment for the curves, and to be drawn with the next Paint() when it is `shown`.
  void See(Session* session, bool shown) {
    if (waiting_.empty()) Forget();
    session->Snapshot(&history_.emplace_back(), false);
    for (const Event& event : session->TakeEvents()) events_.push_back(event);
    // A curve needs two moments.
    if (shown && (scene_only() || history_.size() > 1)) waiting_.push_back(history_.size());
  }
  bool full() const { return waiting_.size() >= kAtOnce; }

  /// The pictures of what waits, in order.
  std::vector<cv::Mat> Paint() {
    std::vector<std::future<cv::Mat>> drawn;
    for (const std::size_t seen : waiting_)
      drawn.push_back(std::async(std::launch::async, [this, seen] { return Draw(seen); }));
    std::vector<cv::Mat> pictures;
    for (auto& picture : drawn) pictures.push_back(picture.get());
    waiting_.clear();
    return pictures;
  }

 private:
  static constexpr std::size_t kAtOnce = 4;

  bool scene_only() const { return keep_s_ == 0; }

  /// The moment that was the `seen`-th in the history, counted from 1.
  cv::Mat Draw(std::size_t seen) const {
    const std::span<const Frame> history = std::span(history_).first(seen);
    const HandModel& hand = config_.model.hand;
    cv::Mat picture(size(), CV_8UC3);
    std::ranges::copy(ScenePixels(history.back(), hand, config_.model.object, scene_),
                      picture.ptr());
    if (!scene_only())
      std::ranges::copy(QualityPixels(history, events_, hand, curve_), picture.ptr(kSceneHeight));
    return picture;
  }

  /// What no later picture shows.
  void Forget() {
    if (history_.empty()) return;
    const double since_s = history_.back().time_s - keep_s_;
    const auto first =
        std::ranges::find_if(history_, [&](const Frame& frame) { return frame.time_s >= since_s; });
    history_.erase(history_.begin(), first);
    std::erase_if(events_, [&](const Event& event) { return event.tick < history_.front().tick; });
  }

  const SessionConfig& config_;
  const double keep_s_;  ///< of history [s]
  PlotOptions scene_, curve_;
  std::vector<Frame> history_;
  std::vector<std::size_t> waiting_;
  std::vector<Event> events_;
};

/// Ends a draft that is not to be kept.
struct Interrupted {};

VideoResult Shoot(RunWindow* window, const VideoOptions& options, const std::string& suffix,
                  const std::string& draft, const OnPicture& on_picture) {
  const SessionConfig& config = window->segment().journal->config;
  const double dt = config.world.dt, step_s = options.speed / options.fps;
  const double end_s = static_cast<double>(window->end_tick()) * dt;
  const int total = static_cast<int>(std::ceil((end_s - options.stretch.from_s) / step_s - 1e-9));
  if (total <= 0) RefuseBeginning(options.stretch.from_s, end_s);

  VideoResult result;
  result.codec = suffix == ".mp4" ? "H.264" : "GIF";
  Painter painter(config, options.scene_only);
  std::unique_ptr<Film> film;
  if (suffix == ".mp4")
    film = std::make_unique<H264Film>(draft, options.fps, painter.size());
  else
    film = std::make_unique<GifFilm>(draft, options.fps, painter.size());

  // What has been drawn is written while the next pictures are drawn.
  std::future<void> writing;
  const auto written = [&writing] {
    if (writing.valid()) writing.get();
  };
  Replay& replay = window->replay();
  const double start_s = static_cast<double>(window->start_tick()) * dt;
  const int before = static_cast<int>((options.stretch.from_s - start_s) / step_s);
  for (int i = -std::max(0, before); i < total; ++i) {
    if (!replay.RunTo(std::llround((options.stretch.from_s + i * step_s) / dt)))
      throw std::runtime_error(fmt::format("the replay differs from the recording at tick {}",
                                           replay.divergence().tick));
    painter.See(&replay.session(), i >= 0);
    if (!painter.full() && i + 1 < total) continue;
    std::vector<cv::Mat> pictures = painter.Paint();
    written();
    result.frames += static_cast<int>(pictures.size());
    writing = std::async(std::launch::async, [&film, pictures = std::move(pictures)] {
      for (const cv::Mat& picture : pictures) film->Add(picture);
    });
    result.interrupted = !on_picture(result.frames, total);
    if (result.interrupted) return result;
  }
  written();
  film->Finish();
  result.duration_s = result.frames / options.fps;
  return result;
}

}  // namespace

VideoResult WriteVideo(RunWindow* window, const VideoOptions& options, const std::string& out,
                       const OnPicture& on_picture) {
  const std::string suffix = LowerSuffix(out);
  if (suffix != ".mp4" && suffix != ".gif")
    throw std::runtime_error(out + ": a film's name ends in .mp4 or .gif");
  RemoveAbandonedDrafts(fs::path(out).parent_path());
  VideoResult result;
  try {
    WriteOutput(out, Draft::Existing::kKeep, [&](const std::string& draft) {
      result = Shoot(window, options, suffix, draft, on_picture);
      if (result.interrupted) throw Interrupted();
    });
  } catch (const Interrupted&) {
  }
  return result;
}

}  // namespace regrasp::run
