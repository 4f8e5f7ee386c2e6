#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "cli/grammar/ranges.h"
#include "cli/hand/fewer_fingers.h"
#include "cli/hand/hand_command.h"
#include "cli/hand/held_ball.h"
#include "cli/hand/lay_object.h"
#include "cli/hand/progress.h"
#include "cli/hand/scenario_file.h"
#include "cli/hand/sheet.h"
#include "core/files/shell_word.h"
#include "core/posture/grasp_search.h"
#include "core/posture/hand_guess.h"
#include "core/posture/scenario_text.h"
#include "core/posture/way_in.h"
#include "core/protocol/methods.h"
#include "core/session/few_fingers.h"
#include "core/world/stepper_choice.h"

namespace regrasp::hand {
namespace {

namespace fs = std::filesystem;

constexpr double kArmature = 2e-4;            // [kg m²]: what public models of small hands use
constexpr int kSearches = 3;                  // for a hand of which no finger can be left out
constexpr std::size_t kTried = 6;             // grasps of a search: by holding, then by using them
constexpr std::size_t kBest = 2;              // of them, that are used more
constexpr unsigned kUses = 3, kMoreUses = 6;  // seeds with which they are used
constexpr std::size_t kWays = 8;              // to lay an object into a grasp, that are tried
constexpr double kLeastBall = 30;             // that stands for it [mm]

class Maker {
 public:
  explicit Maker(const Options& options)
      : options_(options),
        out_(options.Text("--output")),
        object_(options.Text("--object")),
        size_mm_(options.Number("--object-size", 50, kLeastBall_mm, kMostBall_mm)),
        tilt_(options.Number("--tilt", 65, -kMostTilt_deg, kMostTilt_deg) * M_PI / 180),
        progress_(options.Has("--quiet")) {
    search_.seed = static_cast<std::uint64_t>(options.Number("--seed", 1, 0, kMaxSafeInteger));
    gravity_W_ = 9.81 * Vector3d(0, std::cos(tilt_), std::sin(tilt_));
    search_.task.weight = kBallMass * gravity_W_;
    search_.progress = [this](double done, double) {
      progress_.Show("searching a grasp" + without_, done);
    };
  }

  Answer Make() {
    out_.Check();
    Read();
    if (object_.empty())
      ball_ = BallOf(size_mm_, out_.BallName());
    else
      ReadObject();
    if (!ball_.urdf.empty()) out_.CheckBall();
    SearchAll();
    hand_ = best_.any() ? best_.model.hand : all_;
    for (const HandLayout::Finger& finger : whole_.fingers)
      if (std::ranges::none_of(guess_.layout.fingers,
                               [&](const auto& kept) { return kept.name == finger.name; }))
        left_out_.push_back(finger.name);
    if (!best_.any() && touched_)
      throw Failure(
          ExitCode::kFailed,
          fmt::format("{}: however it is turned, {} begins inside a link of the open hand",
                      options_.file, object_),
          "regrasp object show FILE tells its size; a smaller object");
    if (!best_.any()) FailToTouch();
    const Sheet sheet = MakeSheet();
    Write(sheet);
    return sheet.Tell();
  }

 private:
  void Read() {
    if (fs::path(options_.file).extension() == ".toml")
      throw Failure(
          ExitCode::kUsage,
          fmt::format("{} is a scenario; `hand new` makes one from a .urdf file", options_.file),
          "regrasp hand check " + options_.file);
    urdf_ = FindHandFiles(options_.file, ModelSearchPath()).urdf;
    named_urdf_ = out_.NameOfUrdf(urdf_);
    named_object_ = out_.NameOfObject(object_);
    guess_ = GuessHand(urdf_);
    guess_.layout.armature = kArmature;
    hand_ = LoadHand(urdf_, guess_.layout, options_.load(), &report_);
    hand_.name = out_.name();
    whole_ = guess_.layout;
    all_ = hand_;
  }

  [[noreturn]] void FailToTouch() const {
    std::string balls;
    for (std::size_t k = 0; k < sizes_mm_.size(); ++k)
      balls += fmt::format("{}{:.4g}",
                           k == 0                     ? ""
                           : k + 1 < sizes_mm_.size() ? ", "
                                                      : " or ",
                           sizes_mm_[k]);
    const bool ball = object_.empty();
    const std::string shared = SharedMotors(all_);
    throw Failure(
        ExitCode::kFailed,
        fmt::format("{}: no posture found in which {} fingertips touch a ball of {} mm{}{}",
                    options_.file, std::min(hand_.num_fingers(), 3), balls,
                    ball ? "" : ", which stands for " + object_,
                    shared.empty() ? "" : "; " + shared),
        !shared.empty()
            ? "regrasp hand check FILE tells which joints follow which"
            : fmt::format(
                  "regrasp hand new FILE -o NAME.toml {}--object-size MM, larger or smaller",
                  ball ? "" : "--object " + object_ + " "));
  }

  void ReadObject() {
    body_ = LoadObject(object_, ModelSearchPath(), options_.load());
    box_ = BoxOf(body_);
    search_.task.weight = body_.mass * gravity_W_;
    if (options_.Has("--object-size")) return;
    sizes_mm_.clear();
    for (const double size : BallsFor(box_, 1e-3 * kLeastBall)) sizes_mm_.push_back(1e3 * size);
  }

  /// With other starts where nothing is good and no finger can be spared; with fewer fingers where
  /// nothing holds.
  void SearchAll() {
    const int n = all_.num_fingers();
    const int searches = n < kFewestToRegrasp ? kSearches : 1;
    for (int k = 0; k < searches; ++k)
      for (const double size_mm : sizes_mm_)
        if (!best_.Good()) Search(0, size_mm, k);
    for (int out = 1; out <= 2 && n - out >= 3; ++out)
      for (const double size_mm : sizes_mm_)
        if (!best_.Holds()) Search(out, size_mm, 0);
  }

  /// With `out` fingers left out: one, the best choice of it; two, the first that holds. `again`:
  /// other starts than before.
  void Search(int out, double size_mm, int again) {
    const int n = all_.num_fingers();
    search_.task.radius = 0.5e-3 * size_mm;
    GraspSearch search = search_;
    search.seed += static_cast<std::uint64_t>(again) << 32;
    for (int a = 0; a < n; ++a)
      for (int b = a; b < n; ++b) {
        if (out == 2 && best_.Holds()) return;
        if (out == 0 ? a + b > 0 : (b == a) != (out == 1)) continue;
        without_ = out == 0 ? "" : " without " + all_.fingers[static_cast<std::size_t>(a)].name;
        if (out == 2) without_ += ", " + all_.fingers[static_cast<std::size_t>(b)].name;
        const HandLayout layout = Without(all_, whole_, out == 0 ? FingerSet{} : FingerSet{a, b});
        hand_ = LoadHand(urdf_, layout, options_.load());
        hand_.name = out_.name();
        const Found found = Choose(FindGrasps(hand_, search));
        if (!found.Better(best_)) continue;
        best_ = found;
        size_mm_ = size_mm;
        guess_.layout = layout;
      }
  }

  /// So wide that the object's farthest corner is clear of the fingertips, if they open so far [m].
  double OpenGap() const {
    constexpr double kClear = 0.005, kWidest = 0.035;
    if (object_.empty()) return kOpenGap;
    return std::clamp(box_.reach - search_.task.radius + kClear, kOpenGap, kWidest);
  }

  /// The best grasps get a way in and a trial. Of those that hold, the first by their margin are
  /// tried in use; the best of all is taken.
  Found Choose(const std::vector<BallGrasp>& grasps) {
    RandomStream random(search_.seed, 2);
    const std::size_t count = std::min(grasps.size(), kTried);
    std::vector<Found> tried;
    for (std::size_t k = 0; k < count; ++k) {
      progress_.Show("finding a way in" + without_ + ", trying it",
                     static_cast<double>(k) / kTried);
      Found found;
      found.grasp = grasps[k];
      search_.task.gap = OpenGap();
      found.way = FindWayIn(hand_, search_.task, found.grasp, 6, &random);
      if (found.way.stuck >= 0 && search_.task.gap > kOpenGap) {
        search_.task.gap = kOpenGap;
        found.way = FindWayIn(hand_, search_.task, found.grasp, 6, &random);
      }
      if (found.way.stuck >= 0 && k + 1 < count) continue;
      Scenario& scenario = found.model.scenario;
      scenario.name = scenario.hand = hand_.name;
      scenario.object = object_.empty() ? ball_.name : named_object_;
      scenario.q_preshape = found.way.open;
      scenario.q_closed = found.way.closed;
      scenario.X_WO.translation() = found.grasp.p_WO;
      scenario.gravity_W = gravity_W_;
      found.model.hand = hand_;
      found.model.object = object_.empty() ? ball_.model : body_;
      if (!object_.empty()) {
        touched_ = true;
        TryWays(found, &tried);
        continue;
      }
      found.Try(search_.seed);
      tried.push_back(found);
    }
    Rank(&tried, kTried, 0, kUses);
    Rank(&tried, kBest, kUses, kMoreUses);
    return tried.empty() ? Found{} : tried.front();
  }

  /// The object as it may lie in a grasp.
  void TryWays(Found found, std::vector<Found>* tried) {
    const std::vector<Way> ways =
        WaysToLie(found.model, box_, found.grasp.p_WO, Starts(found.model, search_.seed));
    for (std::size_t k = 0; k < std::min(ways.size(), kWays); ++k) {
      progress_.Show("laying the object in" + without_ + ", trying it",
                     static_cast<double>(k) / kWays);
      found.model.scenario.X_WO = ways[k].X_WO;
      found.inside = ways[k].inside;
      ++ways_;
      found.Try(search_.seed);
      tried->push_back(found);
    }
  }

  /// Tries the first `count` that are good in use, with `seeds` seeds after `before` that they have
  /// had, and puts them in order.
  void Rank(std::vector<Found>* tried, std::size_t count, unsigned before, unsigned seeds) {
    const auto better = [](const Found& a, const Found& b) { return a.Better(b); };
    std::ranges::stable_sort(*tried, better);
    tried->resize(std::min(tried->size(), count));
    for (std::size_t k = 0; k < tried->size(); ++k) {
      progress_.Show("exploring and turning with it",
                     static_cast<double>(k) / static_cast<double>(tried->size()));
      Found& found = (*tried)[k];
      if (found.Good() && CanRegrasp(found.model.hand))
        found.use += TryToUse(found.model, found.choice.stepper, search_.seed + before, seeds);
    }
    std::ranges::stable_sort(*tried, better);
  }

  Sheet MakeSheet() const {
    Sheet sheet;
    sheet.file = out_.path();
    sheet.urdf = urdf_;
    sheet.seed = search_.seed;
    sheet.guess = guess_;
    sheet.left_out = left_out_;
    sheet.report = report_;
    sheet.best = best_;
    sheet.ball = object_.empty();
    sheet.ball_mm = size_mm_;
    if (!ball_.urdf.empty()) sheet.ball_file = ball_.name;
    sheet.ways = ways_;
    return sheet;
  }

  void Write(const Sheet& sheet) const {
    ScenarioText text;
    text.urdf = named_urdf_;
    text.layout = guess_.layout;
    text.options = options_.load();
    text.scenario = best_.model.scenario;
    text.comments = {MadeBy(), sheet.ScoreLine()};
    out_.Write(WriteScenario(text, hand_), ball_.urdf);
  }

  /// The command again, as it is typed where the scenario is.
  std::string MadeBy() const {
    std::string line =
        fmt::format("Made by: regrasp hand new {} -o {}",
                    ShellWord(named_urdf_.empty() ? urdf_.filename().string() : named_urdf_),
                    ShellWord(out_.path().filename().string()));
    if (!object_.empty()) line += " --object " + ShellWord(named_object_);
    line += fmt::format(" --object-size {:g} --seed {} --tilt {:g}", size_mm_, search_.seed,
                        tilt_ * 180 / M_PI);
    for (const char* flag : {"--inertia-from-shape", "--fill-missing-meshes"})
      if (options_.Has(flag)) line += fmt::format(" {}", flag);
    return line;
  }

  const Options& options_;
  ScenarioFile out_;
  fs::path urdf_;
  std::string object_;                     // "": a ball
  std::string named_urdf_, named_object_;  // as the scenario names them
  HeldBall ball_;                          // where it is one
  ObjectModel body_;                       // otherwise
  ObjectBox box_;
  double size_mm_, tilt_;
  std::vector<double> sizes_mm_ = {size_mm_};  // of balls, tried until one is good
  bool touched_ = false;                       // the fingers can touch one of them
  int ways_ = 0;                               // to lay the object in, that were tried
  Vector3d gravity_W_;
  Progress progress_;
  GraspSearch search_;
  HandGuess guess_;
  HandModel hand_;
  HandLayout whole_;  // with every finger
  HandModel all_;
  std::vector<std::string> left_out_;  // names of fingers
  std::string without_;                // of the search that runs, for its progress
  ModelReport report_;
  Found best_;
};

}  // namespace

Answer NewHand(const Options& options) { return Maker(options).Make(); }

}  // namespace regrasp::hand
