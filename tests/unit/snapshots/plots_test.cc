#include "snapshots/plots.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <regex>
#include <string>
#include <thread>

#include "snapshots/canvas.h"
#include "snapshots/plot_experiment.h"
#include "snapshots/timeline.h"
#include "tests/unit/snapshots/pixels.h"
#include "tests/unit/snapshots/synthetic_run.h"

namespace regrasp {
namespace {

namespace fs = std::filesystem;

/// A folder of this test, removed at its end.
class Snapshots : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(::testing::TempDir()) / (std::string("regrasp_snapshots_") + info->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string File(std::string_view name, const std::string& suffix = "") const {
    return (folder_ / name).string() + suffix;
  }

  const HandModel hand_ = SyntheticHand();
  const std::vector<Frame> run_ = SyntheticRun(6);
  const std::vector<Event> events_ = {{1000, EventKind::kContactMade, 0, 0, 0, "contact"},
                                      {2500, EventKind::kPush, -1, 0, 0, "push"}};
  const ObjectModel object_;
  fs::path folder_;
};

/// A drop at the end of the history; the last finger let go half a second before.
IncidentNote NoteOf(std::span<const Frame> history) {
  IncidentNote note;
  if (!history.empty()) note.tick = history.back().tick;
  note.time_s = 1e-3 * static_cast<double>(note.tick);
  note.cause = "Dropped while holding: a push, then three lost its contact first.";
  note.margin_limit = 0.1;
  note.drop_distance = 0.03;
  note.ends = {{2, note.time_s - 0.5, false}};
  return note;
}

/// A ball of 25 mm felt on the side of +x, by `off` too large [m].
FeltSurface FeltBall(double off) {
  FeltSurface felt;
  for (const Vector3d& way : {Vector3d(1, 0, 0), Vector3d(1, 0.3, 0.2), Vector3d(1, -0.3, 0.4)}) {
    const Vector3d u = way.normalized();
    felt.Add((0.025 + off) * u, u, 50);
  }
  return felt;
}

/// A history, or its newest frame, as every picture takes it.
PlotInput InputOf(std::span<const Frame> history, const PlotOptions& options = {}) {
  PlotInput input;
  input.frames.assign(history.begin(), history.end());
  input.events = {{1000, EventKind::kContactMade, 0, 0, 0, "contact"},
                  {2500, EventKind::kPush, -1, 0, 0, "push"}};
  input.explorations = {input.frames, input.frames};
  input.incident = NoteOf(history);
  input.felt = std::make_shared<FeltSurface>(FeltBall(0.0004));
  input.hand = SyntheticHand();
  input.options = options;
  return input;
}

void Draw(const PlotRow& plot, std::span<const Frame> history, const PlotOptions& options,
          const std::string& path) {
  DrawPlot(plot.name, InputOf(history, options), path);
}

std::string ErrorOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

std::string Bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST_F(Snapshots, EveryPictureIsWrittenInTheRequestedSizeAndFormat) {
  for (const PlotRow& plot : kPlotTable) {
    for (const auto& [width, height, suffix] :
         {std::tuple{1600, 1000, ".png"}, std::tuple{800, 600, ".jpg"},
          std::tuple{401, 303, ".PNG"}}) {
      const std::string path = File(plot.name, suffix);
      PlotOptions options;
      options.width = width;
      options.height = height;
      Draw(plot, run_, options, path);
      const cv::Mat picture = cv::imread(path);
      EXPECT_EQ(picture.size(), cv::Size(width, height)) << path;
    }
    EXPECT_EQ(Bytes(File(plot.name, ".png")).substr(1, 3), "PNG");
    EXPECT_EQ(Bytes(File(plot.name, ".jpg")).substr(0, 2),
              "\xff\xd8");  // JPEG's start of image
  }
}

TEST_F(Snapshots, SameInputGivesTheSameBytesFromAnyThread) {
  for (const PlotRow& plot : kPlotTable) {
    PlotOptions options;
    options.width = 480;
    options.height = 300;
    Draw(plot, run_, options, File(plot.name, "1.png"));
    std::array<std::thread, 2> threads;
    for (int i = 0; i < 2; ++i)
      threads[i] = std::thread(
          [&, i] { Draw(plot, run_, options, File(plot.name, std::to_string(i + 2) + ".png")); });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(Bytes(File(plot.name, "1.png")), Bytes(File(plot.name, "2.png"))) << plot.name;
    EXPECT_EQ(Bytes(File(plot.name, "1.png")), Bytes(File(plot.name, "3.png"))) << plot.name;
  }
}

TEST_F(Snapshots, EmptyHistoryIsRefusedByPathAndCause) {
  for (const PlotRow& plot : kPlotTable) {
    const std::string path = File(plot.name, ".png");
    const std::string error = ErrorOf([&] { Draw(plot, {}, {}, path); });
    EXPECT_NE(error.find(path), std::string::npos) << error;
    EXPECT_NE(error.find("history is empty"), std::string::npos) << error;
    EXPECT_FALSE(fs::exists(path));
  }
  EXPECT_NE(
      ErrorOf([&] { PlotQualityComparison({}, hand_, {}, File("none.png")); }).find("no runs"),
      std::string::npos);
}

TEST_F(Snapshots, SceneOfAnotherHandIsRefused) {
  const std::string error =
      ErrorOf([&] { PlotScene(Frame(), hand_, object_, {}, File("scene.png")); });
  EXPECT_NE(error.find("0 joint angles"), std::string::npos) << error;
  EXPECT_NE(error.find(File("scene.png")), std::string::npos) << error;
}

TEST_F(Snapshots, APictureInMemoryIsThatOfTheFile) {
  PlotOptions options;
  options.width = 640;
  options.height = 400;
  PlotScene(run_.back(), hand_, object_, options, File("scene.png"));
  PlotQuality(run_, events_, hand_, options, File("quality.png"));
  const auto difference = [&](Pixels pixels, const char* name) {
    const cv::Mat picture = cv::imread(File(name));
    EXPECT_EQ(pixels.size(), picture.total() * picture.elemSize());
    return cv::norm(cv::Mat(picture.size(), CV_8UC3, pixels.data()), picture, cv::NORM_L1) /
           static_cast<double>(pixels.size());
  };
  EXPECT_EQ(difference(QualityPixels(run_, events_, hand_, options), "quality.png"), 0);
  // The bodies have fewer samples there: their rims, 3 % of the pixels of so small a picture, are
  // off by some 20 levels of 255 (0.6 on average).
  const double rims = difference(ScenePixels(run_.back(), hand_, object_, options), "scene.png");
  EXPECT_GT(rims, 0);
  EXPECT_LT(rims, 1);
}

TEST_F(Snapshots, FewTrialsArePointsInsteadOfABox) {
  ExperimentPicture picture;
  picture.title = "Few";
  picture.facts = "a · b";
  picture.measure_labels = {"gain"};
  QuantileMark mark;
  mark.has_values = true;
  mark.few = {0.1, 0.2, 0.7};
  picture.groups = {{"first", "", "", {{"φ rose", 0.9, 0.6, 1}}, {mark}}};
  PlotExperiment(picture, File("few.svg"));
  picture.groups[0].measures[0].few.clear();
  PlotExperiment(picture, File("many.svg"));
  const std::string few = Bytes(File("few.svg")), many = Bytes(File("many.svg"));
  const auto says = [](const std::string& svg, const char* text) {
    return svg.find(text) != std::string::npos;
  };
  EXPECT_TRUE(says(few, "one trial") && !says(few, "of the trials"));
  EXPECT_TRUE(says(many, "of the trials") && !says(many, "one trial"));
}

TEST_F(Snapshots, InAColumnAllTextIsSevenPointsHighAndOnTheSheet) {
  constexpr double kWidth_mm = 88;
  PlotOptions options;
  options.width_mm = kWidth_mm;
  PlotScene(run_.back(), hand_, object_, options, File("scene.svg"));
  PlotContacts(run_, hand_, object_, options, File("contacts.svg"));
  DrawPlot("shape", InputOf(run_, options), File("shape.svg"));
  std::vector<Event> events = events_;
  for (const std::int64_t tick : {100, 2900, 5900})
    events.push_back(
        {tick, EventKind::kParameter, -1, 0, 0,
         "parameter control.force_feedback_gain = 0.25, which was changed while held"});
  IncidentNote note = NoteOf(run_);
  note.cause += " Two of the fingers had slid by more than a millimetre before that.";
  PlotIncident(run_, events, note, hand_, options, File("incident.svg"));
  ExperimentPicture sweep;
  sweep.title = "Sweep";
  sweep.facts = "a · b";
  sweep.width_mm = kWidth_mm;
  for (const char* finger : {"first", "thumb"})
    for (const char* noise : {"off", "paper", "coarse"})
      sweep.groups.push_back({noise, "secant", finger, {{"φ rose", 0.9, 0.6, 1}}, {}});
  PlotSweep(sweep, File("sweep.svg"));
  const Canvas measure(SizeOf({}));
  const std::regex any_text("<text ");
  for (const char* name : {"scene.svg", "contacts.svg", "shape.svg", "incident.svg", "sweep.svg"}) {
    const std::string svg = Bytes(File(name));
    std::smatch sheet;
    ASSERT_TRUE(std::regex_search(
        svg, sheet, std::regex("width=\"88.00mm\".*viewBox=\"0 0 ([0-9.]+) ([0-9.]+)\"")));
    const double width = std::stod(sheet[1]), height = std::stod(sheet[2]);
    const double pt_per_unit = kWidth_mm * 72 / 25.4 / width;
    const std::regex text(
        "<text transform=\"translate\\(([0-9.-]+) ([0-9.-]+)\\)( rotate\\(-90\\))?\" y=\"[^\"]*\" "
        "font-size=\"([0-9.]+)\" text-anchor=\"(start|middle|end)\"( font-weight=\"bold\")?[^>]*>"
        "([^<]*)<");
    int count = 0;
    for (std::sregex_iterator it(svg.begin(), svg.end(), text), end; it != end; ++it, ++count) {
      const double x = std::stod((*it)[1]), y = std::stod((*it)[2]), size = std::stod((*it)[4]);
      const std::string words = (*it)[7];
      EXPECT_GT(size * pt_per_unit, 7 - 0.02) << name;  // sizes have two decimals
      EXPECT_GE(y, 0) << name;
      EXPECT_LT(y, height) << name;
      // From its beginning to its end; what is turned goes up.
      const double length = measure.TextWidth(words, 100, (*it)[6].matched) / 100 * size;
      const double before = (*it)[5] == "start" ? 0 : (*it)[5] == "end" ? length : length / 2;
      const bool upwards = (*it)[3].matched;
      const double first = upwards ? y + before - length : x - before;
      EXPECT_GE(x, 0) << name << ": " << words;
      EXPECT_LE(x, width) << name << ": " << words;
      EXPECT_GE(first, 0) << name << ": " << words;
      EXPECT_LE(first + length, upwards ? height : width) << name << ": " << words;
    }
    EXPECT_EQ(count, std::distance(std::sregex_iterator(svg.begin(), svg.end(), any_text),
                                   std::sregex_iterator()))
        << name;
    EXPECT_GT(count, 10) << name;
  }
}

TEST_F(Snapshots, SceneWithADroppedObjectStillShowsTheHandAtItsSize) {
  const auto drawn = [&](const Frame& frame) {
    PlotScene(frame, hand_, object_, {}, File("scene.png"));
    const cv::Mat picture =
        cv::imread(File("scene.png"))(cv::Rect(30, 240, 640, 650));  // inside the left view
    return cv::countNonZero(picture.reshape(1) != 255) / 3.0 / (640 * 650);
  };
  Frame frame = run_.back();
  const double held = drawn(frame);
  EXPECT_GT(held, 0.1);
  for (const Vector3d& far :
       {Vector3d(0, 0, -100), Vector3d(0, -5, 0), Vector3d(std::nan(""), 0, 0)}) {
    frame.p_WO = far;
    EXPECT_GT(drawn(frame), 0.5 * held) << far.transpose();
  }
  frame.q[0] = std::nan("");
  EXPECT_NE(ErrorOf([&] { drawn(frame); }).find("not finite"), std::string::npos);
}

TEST_F(Snapshots, ContactsWithoutAHeldObjectAreRefused) {
  std::vector<Frame> idle = run_;
  for (Frame& frame : idle) frame.state = SessionState::kIdle;
  const std::string error = ErrorOf([&] { PlotContacts(idle, hand_, object_, {}, File("c.png")); });
  EXPECT_NE(error.find("no finger held the object"), std::string::npos) << error;
}

TEST_F(Snapshots, UnwritablePathUnknownSuffixAndBadSizeAreRefused) {
  for (const PlotRow& plot : kPlotTable) {
    const std::string missing = File("no_such_folder/x.png"), gif = File("x.gif"),
                      good = File("x.png");
    std::string error = ErrorOf([&] { Draw(plot, run_, {}, missing); });
    EXPECT_NE(error.find(missing), std::string::npos) << error;
    EXPECT_NE(error.find("No such file or directory"), std::string::npos) << error;
    error = ErrorOf([&] { Draw(plot, run_, {}, gif); });
    EXPECT_NE(error.find(gif + ": unsupported suffix '.gif'"), std::string::npos) << error;
    for (const auto& [width, height] :
         {std::pair{0, 1000}, std::pair{1600, 299}, std::pair{8001, 1000}}) {
      PlotOptions options;
      options.width = width;
      options.height = height;
      error = ErrorOf([&] { Draw(plot, run_, options, good); });
      EXPECT_NE(error.find(good + ": picture size"), std::string::npos) << error;
    }
    EXPECT_FALSE(fs::exists(gif));
    EXPECT_FALSE(fs::exists(good));
  }
}

TEST_F(Snapshots, NumbersThatAreNotFiniteLeaveGapsAndNothingElse) {
  std::vector<Frame> run = run_;
  for (std::size_t i = 100; i < 120; ++i) {
    run[i].fingers[0].true_manipulability = run[i].fingers[1].manipulability = std::nan("");
    run[i].stability.active = std::nan("");
    run[i].stability.load_margin = std::numeric_limits<double>::infinity();
    run[i].fingers[2].p_WC = Vector3d::Constant(std::nan(""));
  }
  for (const PlotRow& plot : kPlotTable)
    EXPECT_NO_THROW(Draw(plot, run, {}, File(plot.name, ".png"))) << plot.name;
}

TEST_F(Snapshots, AHistoryOfOneFrameCanBeDrawn) {
  const auto explores = [](const Frame& frame) { return frame.exploration.active; };
  const auto one = std::ranges::find_if(run_, explores);
  ASSERT_NE(one, run_.end());
  for (const PlotRow& plot : kPlotTable)
    EXPECT_NO_THROW(Draw(plot, {one, 1}, {}, File(plot.name, ".png"))) << plot.name;
  // Where no finger explores there is nothing to compare; all else can be drawn.
  ASSERT_FALSE(run_.back().exploration.active);
  for (const PlotRow& plot : kPlotTable) {
    const auto draw = [&] { Draw(plot, std::span(run_).last(1), {}, File(plot.name, ".png")); };
    if (plot.name == "comparison")
      EXPECT_THROW(draw(), std::runtime_error);
    else
      EXPECT_NO_THROW(draw()) << plot.name;
  }
}

TEST_F(Snapshots, QualityShowsTheExploringFingerBold) {
  PlotQuality(run_, events_, hand_, {}, File("q.png"));
  const cv::Mat picture = cv::imread(File("q.png"));
  // Inside the upper panel (150 .. 1310 px across); the legend lies to the right of it.
  const cv::Rect plot(152, 206, 1150, 290);
  const int explorer = Count(picture, LookOfFinger(kSyntheticExplorer).colour, plot);
  // A third of 1160 px, 4 px wide, of which the two rims are anti-aliased: at least 2 px are pure.
  EXPECT_GT(explorer, 1160 / 3 * 2);
  for (int other : {0, 2})
    EXPECT_LT(Count(picture, LookOfFinger(other).colour, plot), explorer / 2);
}

TEST_F(Snapshots, QualityWithoutExplorationHasNoBoldCurve) {
  std::vector<Frame> run = run_;
  for (Frame& frame : run) frame.exploration = {};
  PlotQuality(run, {}, hand_, {}, File("q.png"));
  EXPECT_LT(Count(cv::imread(File("q.png")), LookOfFinger(kSyntheticExplorer).colour,
                  {152, 206, 1150, 290}),
            200);
}

TEST_F(Snapshots, IncidentShowsTheForceOfEveryFingerAndWhoLetGo) {
  std::vector<Frame> run = run_;
  for (Frame& frame : run)
    for (int f = 0; f < 3; ++f)
      frame.fingers[f].true_force_W = -(0.3 + 0.4 * f) * frame.fingers[f].true_normal_W;
  PlotOptions options;
  options.last_s = 2;
  PlotIncident(run, {}, NoteOf(run), hand_, options, File("i.png"));
  const cv::Mat picture = cv::imread(File("i.png"));
  // Below the strips, left of the legend.
  const cv::Rect panels(152, 340, 1196, 570);
  // A curve across 1200 px, 3 px wide, of which at least 1 px is pure; letters cover a part of it.
  for (int f = 0; f < 3; ++f) EXPECT_GT(Count(picture, LookOfFinger(f).colour, panels), 800) << f;
  EXPECT_GT(Count(picture, Tint(kVermillion, 0.72), panels), 1000);  // below the margin's limit

  IncidentNote nobody = NoteOf(run);
  nobody.ends.clear();
  PlotIncident(run, {}, nobody, hand_, options, File("n.png"));
  const auto vermillion = [&](const std::string& name) {
    return Count(cv::imread(File(name)), LookOfFinger(2).colour, panels);
  };
  // The dashed line down the panels: 500 px, 60 % of it drawn, at least 1 px pure.
  EXPECT_GT(vermillion("i.png"), vermillion("n.png") + 100);
}

TEST_F(Snapshots, ComparisonShowsBothRunsAndTheThreshold) {
  std::vector<Frame> other = run_;
  for (Frame& frame : other) frame.fingers[kSyntheticExplorer].true_manipulability *= 0.8;
  const std::array<LabelledRun, 2> runs = {LabelledRun{"manipulability", run_},
                                           LabelledRun{"combined", other}};
  PlotQualityComparison(runs, hand_, {}, File("c.png"));
  const cv::Mat picture = cv::imread(File("c.png"));
  const cv::Rect upper(152, 118, 1150, 370), lower(152, 530, 1150, 370);
  for (const cv::Rect& panel : {upper, lower})
    EXPECT_GT(Count(picture, kVermillion, panel),
              500);                              // solid, so at least about one pixel per column
  EXPECT_GT(Count(picture, kBlue, upper), 200);  // dotted
  EXPECT_GT(Count(picture, kGrey, lower), 300);  // dashed threshold
}

TEST_F(Snapshots, ContactsShowEveryFingerInItsColour) {
  PlotContacts(run_, hand_, object_, {}, File("c.png"));
  const cv::Mat picture = cv::imread(File("c.png"));
  for (int f = 0; f < 3; ++f) {
    const Colour near = LookOfFinger(f).colour, far = Tint(near, 0.62);
    const cv::Rect plots(0, 90, 1350, 900);
    EXPECT_GT(Count(picture, near, plots) + Count(picture, far, plots), 100) << f;
  }
}

TEST_F(Snapshots, ShapeShowsWhatWasFeltAndOnWhichSideOfTheTruth) {
  const auto count = [&](double off, Colour colour, const cv::Rect& view) {
    PlotInput input = InputOf(run_);
    input.felt = std::make_shared<FeltSurface>(FeltBall(off));
    DrawPlot("shape", input, File("s.png"));
    // Shaded by up to a quarter: by hue and depth rather than by the very colour.
    const cv::Mat picture = cv::imread(File("s.png"))(view);
    int pixels = 0;
    for (auto it = picture.begin<cv::Vec3b>(); it != picture.end<cv::Vec3b>(); ++it)
      pixels += colour == kBlue ? (*it)[0] > (*it)[2] + 60 : (*it)[2] > (*it)[0] + 60;
    return pixels;
  };
  // The views of a sheet of 1600 x 1000: from -x on the left, from +x on the right.
  const cv::Rect left(22, 106, 630, 870), right(680, 106, 630, 870);
  EXPECT_GT(count(0.0004, kVermillion, right), 5000);
  EXPECT_EQ(count(0.0004, kBlue, right), 0);
  EXPECT_GT(count(-0.0004, kBlue, right), 5000);
  EXPECT_EQ(count(-0.0004, kVermillion, right), 0);
  EXPECT_EQ(count(0, kBlue, right) + count(0, kVermillion, right), 0);
  EXPECT_LT(count(0.0004, kVermillion, left), count(0.0004, kVermillion, right) / 4);
}

TEST_F(Snapshots, AShapeThatNobodyFeltIsRefused) {
  PlotInput input = InputOf(run_);
  for (const auto& felt : {std::shared_ptr<const FeltSurface>(),
                           std::shared_ptr<const FeltSurface>(new FeltSurface)}) {
    input.felt = felt;
    const std::string error = ErrorOf([&] { DrawPlot("shape", input, File("s.png")); });
    EXPECT_NE(error.find(File("s.png") + ": nothing to draw: no finger has felt the object"),
              std::string::npos)
        << error;
    EXPECT_FALSE(fs::exists(File("s.png")));
  }
}

TEST_F(Snapshots, LastSecondsCutTheHistoryAndAResetBeginsANewOne) {
  const auto late = Newest(run_, 1.0, "x");
  EXPECT_NEAR(late.front().time_s, run_.back().time_s - 1, 1e-9);
  EXPECT_EQ(&late.back(), &run_.back());
  EXPECT_EQ(Newest(run_, 0, "x").size(), run_.size());
  EXPECT_EQ(Newest(run_, 1e6, "x").size(), run_.size());
  std::vector<Frame> twice = run_;
  const auto second = SyntheticRun(2);
  twice.insert(twice.end(), second.begin(), second.end());
  EXPECT_EQ(Newest(twice, 0, "x").size(), second.size());
}

TEST_F(Snapshots, BandsTouchAndGapsStayOpen) {
  const auto bands = Bands(run_, [](const Frame& frame) { return frame.exploration.finger; });
  ASSERT_EQ(bands.size(), 1u);
  EXPECT_EQ(bands[0].value, kSyntheticExplorer);
  EXPECT_NEAR(bands[0].end_s - bands[0].begin_s, 2.0, 1e-9);  // a third of 6 s
  const auto states = Bands(run_, [](const Frame& frame) { return static_cast<int>(frame.state); });
  ASSERT_EQ(states.size(), 4u);
  for (std::size_t i = 1; i < states.size(); ++i) EXPECT_EQ(states[i].begin_s, states[i - 1].end_s);
}

}  // namespace
}  // namespace regrasp
