#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <regex>
#include <string>
#include <thread>

#include "core/common/random.h"
#include "snapshots/axes.h"
#include "snapshots/outline.h"
#include "snapshots/plot_experiment.h"
#include "snapshots/renderer.h"
#include "snapshots/snapshots.h"
#include "snapshots/sphere_fit.h"
#include "snapshots/timeline.h"
#include "tests/unit/snapshots/synthetic_run.h"

namespace regrasp {
namespace {

namespace fs = std::filesystem;

/// The pixels of what has been drawn.
cv::Mat Picture(Canvas* canvas) {
  const std::string png = canvas->Bytes();
  return cv::imdecode(std::vector<std::uint8_t>(png.begin(), png.end()), cv::IMREAD_COLOR);
}

/// A folder of this test, removed at its end.
class Snapshots : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(::testing::TempDir()) / (std::string("regrasp_snapshots_") + info->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string File(const std::string& name) const { return (folder_ / name).string(); }

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

/// Draws one kind of picture of a history.
using Plot = std::function<void(std::span<const Frame>, const PlotOptions&, const std::string&)>;

std::vector<std::pair<std::string, Plot>> AllPlots(const HandModel& hand, const ObjectModel& object,
                                                   std::span<const Event> events) {
  return {
      {"quality",
       [&hand, events](auto h, auto& o, auto& p) { PlotQuality(h, events, hand, o, p); }},
      {"comparison",
       [&hand](auto h, auto& o, auto& p) {
         const std::array<LabelledRun, 2> runs = {LabelledRun{"a", h}, LabelledRun{"b", h}};
         PlotQualityComparison(runs, hand, o, p);
       }},
      {"contacts", [&](auto h, auto& o, auto& p) { PlotContacts(h, hand, object, o, p); }},
      {"gait", [&hand, events](auto h, auto& o, auto& p) { PlotGait(h, events, hand, o, p); }},
      {"incident", [&hand, events](auto h, auto& o,
                                   auto& p) { PlotIncident(h, events, NoteOf(h), hand, o, p); }},
      {"scene", [&](auto h, auto& o, auto& p) { PlotScene(h.back(), hand, object, o, p); }}};
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

/// Pixels within 12 levels of a colour in every channel: anti-aliased rims are lighter and do not
/// count.
int Count(const cv::Mat& bgr, Colour colour, const cv::Rect& where) {
  int count = 0;
  for (int y = where.y; y < where.br().y; ++y)
    for (int x = where.x; x < where.br().x; ++x) {
      const auto& p = bgr.at<cv::Vec3b>(y, x);
      count += std::abs(p[0] - colour.b) <= 12 && std::abs(p[1] - colour.g) <= 12 &&
               std::abs(p[2] - colour.r) <= 12;
    }
  return count;
}

// ------------------------------------------------------------------------------------------ every
// picture

TEST_F(Snapshots, EveryPictureIsWrittenInTheRequestedSizeAndFormat) {
  for (const auto& [name, plot] : AllPlots(hand_, object_, events_)) {
    for (const auto& [width, height, suffix] :
         {std::tuple{1600, 1000, ".png"}, std::tuple{800, 600, ".jpg"},
          std::tuple{401, 303, ".PNG"}}) {
      const std::string path = File(name + suffix);
      PlotOptions options;
      options.width = width;
      options.height = height;
      plot(run_, options, path);
      const cv::Mat picture = cv::imread(path);
      EXPECT_EQ(picture.size(), cv::Size(width, height)) << path;
    }
    EXPECT_EQ(Bytes(File(name + ".png")).substr(1, 3), "PNG");
    EXPECT_EQ(Bytes(File(name + ".jpg")).substr(0, 2), "\xff\xd8");  // JPEG's start of image
  }
}

TEST_F(Snapshots, SameInputGivesTheSameBytesFromAnyThread) {
  for (const auto& [name, plot] : AllPlots(hand_, object_, events_)) {
    PlotOptions options;
    options.width = 480;
    options.height = 300;
    plot(run_, options, File(name + "1.png"));
    std::array<std::thread, 2> threads;
    for (int i = 0; i < 2; ++i)
      threads[i] =
          std::thread([&, i] { plot(run_, options, File(name + std::to_string(i + 2) + ".png")); });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(Bytes(File(name + "1.png")), Bytes(File(name + "2.png"))) << name;
    EXPECT_EQ(Bytes(File(name + "1.png")), Bytes(File(name + "3.png"))) << name;
  }
}

TEST_F(Snapshots, EmptyHistoryIsRefusedByPathAndCause) {
  for (const auto& [name, plot] : AllPlots(hand_, object_, events_)) {
    if (name == "scene") continue;  // takes a frame, not a history
    const std::string path = File(name + ".png");
    const std::string error = ErrorOf([&] { plot({}, {}, path); });
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
  for (const auto& [pixels, name] :
       {std::pair{ScenePixels(run_.back(), hand_, object_, options), "scene.png"},
        std::pair{QualityPixels(run_, events_, hand_, options), "quality.png"}}) {
    const cv::Mat picture = cv::imread(File(name));
    ASSERT_EQ(pixels.size(), picture.total() * picture.elemSize());
    EXPECT_TRUE(std::equal(pixels.begin(), pixels.end(), picture.data)) << name;
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
  for (const auto& [name, plot] : AllPlots(hand_, object_, events_)) {
    const std::string missing = File("no_such_folder/x.png"), gif = File("x.gif"),
                      good = File("x.png");
    std::string error = ErrorOf([&] { plot(run_, {}, missing); });
    EXPECT_NE(error.find(missing), std::string::npos) << error;
    EXPECT_NE(error.find("No such file or directory"), std::string::npos) << error;
    error = ErrorOf([&] { plot(run_, {}, gif); });
    EXPECT_NE(error.find(gif + ": unsupported suffix '.gif'"), std::string::npos) << error;
    for (const auto& [width, height] :
         {std::pair{0, 1000}, std::pair{1600, 299}, std::pair{8001, 1000}}) {
      PlotOptions options;
      options.width = width;
      options.height = height;
      error = ErrorOf([&] { plot(run_, options, good); });
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
  for (const auto& [name, plot] : AllPlots(hand_, object_, events_))
    EXPECT_NO_THROW(plot(run, {}, File(name + ".png"))) << name;
}

TEST_F(Snapshots, AHistoryOfOneFrameCanBeDrawn) {
  for (const auto& [name, plot] : AllPlots(hand_, object_, events_))
    EXPECT_NO_THROW(plot(std::span(run_).last(1), {}, File(name + ".png"))) << name;
}

// ------------------------------------------------------------------------------------------- what
// is shown

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

// ---------------------------------------------------------------------------------------------
// canvas, axes

TEST(NiceAxis, StepsAreOneTwoOrFiveTimesAPowerOfTenAndCoverTheRange) {
  RandomStream random(1, 0);
  for (int i = 0; i < 2000; ++i) {
    const double lo = 100 * random.Normal(), width = std::pow(10, 8 * random.Uniform() - 4);
    const Axis axis = NiceAxis(lo, lo + width, 6, true, "");
    const double mantissa =
        axis.step / std::pow(10, std::floor(std::log10(axis.step * (1 + 1e-9))));
    EXPECT_TRUE(std::abs(mantissa - 1) < 1e-6 || std::abs(mantissa - 2) < 1e-6 ||
                std::abs(mantissa - 5) < 1e-6)
        << axis.step;
    // round_out may give up 1e-9 of a step, so that a range that ends on a tick is not widened.
    EXPECT_LE(axis.lo, lo + 2e-9 * axis.step);
    EXPECT_GE(axis.hi, lo + width - 2e-9 * axis.step);
    // The step is within a factor of sqrt(10)/2 of the wished one: 3.8 to 9.5 steps, and the ends
    // that are rounded out add up to two.
    EXPECT_GE(axis.Ticks().size(), 4u);
    EXPECT_LE(axis.Ticks().size(), 12u);
  }
}

TEST(NiceAxis, TickTextHasTheDecimalsOfTheStepAndATrueMinus) {
  const Axis axis{-0.4, 0.4, 0.2, ""};
  EXPECT_EQ(axis.TickText(-0.2), "\u22120.2");
  EXPECT_EQ(axis.TickText(-1e-17), "0.0");
  EXPECT_EQ((Axis{0, 100, 20, ""}.TickText(80)), "80");
  EXPECT_EQ((Axis{0, 1e-3, 5e-4, ""}.TickText(5e-4)), "0.0005");
}

TEST(NiceAxis, EmptyAndInfiniteRangesStillGiveAnAxis) {
  for (const auto& [lo, hi] :
       {std::pair{3.0, 3.0}, std::pair{0.0, 0.0}, std::pair{1.0, std::nan("")}}) {
    const Axis axis = NiceAxis(lo, hi, 5, true, "");
    EXPECT_LT(axis.lo, axis.hi);
    EXPECT_GE(axis.Ticks().size(), 2u);
  }
}

/// A big-endian number of a PNG.
std::uint32_t Number(const std::string& bytes, std::size_t at) {
  std::uint32_t v = 0;
  for (std::size_t k = 0; k < 4; ++k) v = v << 8 | static_cast<std::uint8_t>(bytes[at + k]);
  return v;
}

TEST(Canvas, PngNamesItsPrintedSize) {
  const std::string png = Canvas({.width_px = 1600, .width_mm = 80}, "x.png").Bytes();
  ASSERT_EQ(png.substr(37, 4), "pHYs");  // right after the header
  EXPECT_EQ(Number(png, 41), 20000u);    // 1600 px on 80 mm, per metre
  EXPECT_EQ(png[49], 1);
}

TEST(Canvas, SvgHoldsTextAsTextAndWhatIsDrawnWhereItIs) {
  Canvas canvas({.width_mm = 88}, "x.svg");
  canvas.Text({100, 200}, "φ < 1 & ρ", {.size = 20});
  canvas.Line({1, 2}, {3, 4}, {kBlue, 2});
  const std::string svg = canvas.Bytes();
  EXPECT_NE(svg.find(">φ &lt; 1 &amp; ρ</text>"), std::string::npos) << svg;
  EXPECT_NE(svg.find("points=\"1.00,2.00 3.00,4.00\""), std::string::npos) << svg;
  EXPECT_NE(svg.find("width=\"88.00mm\""), std::string::npos) << svg;
}

TEST(Canvas, PdfHasThePrintedSizeAndEmbedsItsFont) {
  Canvas canvas({.width_mm = 180}, "x.pdf");
  canvas.Text({100, 200}, "stability", {.size = 20});
  const std::string pdf = canvas.Bytes();
  EXPECT_EQ(pdf.substr(0, 5), "%PDF-");
  EXPECT_NE(pdf.find("DejaVuSans"), std::string::npos);
  EXPECT_NE(pdf.find("/FontFile"), std::string::npos);
  EXPECT_EQ(pdf.find("/CreationDate"), std::string::npos) << "the same run gives the same file";
  // 180 mm are 510.236 pt.
  EXPECT_NE(pdf.find("510.236"), std::string::npos);
}

TEST(Canvas, PrintedTextIsSevenPointsHigh) {
  for (const double mm : {165.0, 180.0}) {
    PlotOptions options;
    options.width_mm = mm;
    const Canvas canvas(SizeOf(options), "x.pdf");
    const double pt_per_unit = mm * 72 / 25.4 / canvas.width();
    EXPECT_GT(15 * pt_per_unit, 7 - 1e-2) << mm;  // 15: the smallest text of all pictures
  }
}

TEST_F(Snapshots, InAColumnAllTextIsSevenPointsHighAndOnTheSheet) {
  constexpr double kWidth_mm = 88;
  PlotOptions options;
  options.width_mm = kWidth_mm;
  PlotScene(run_.back(), hand_, object_, options, File("scene.svg"));
  PlotContacts(run_, hand_, object_, options, File("contacts.svg"));
  ExperimentPicture sweep;
  sweep.title = "Sweep";
  sweep.facts = "a · b";
  sweep.width_mm = kWidth_mm;
  for (const char* finger : {"first", "thumb"})
    for (const char* noise : {"off", "paper", "coarse"})
      sweep.groups.push_back({noise, "secant", finger, {{"φ rose", 0.9, 0.6, 1}}, {}});
  PlotSweep(sweep, File("sweep.svg"));
  for (const char* name : {"scene.svg", "contacts.svg", "sweep.svg"}) {
    const std::string svg = Bytes(File(name));
    std::smatch sheet;
    ASSERT_TRUE(std::regex_search(
        svg, sheet, std::regex("width=\"88.00mm\".*viewBox=\"0 0 ([0-9.]+) ([0-9.]+)\"")));
    const double width = std::stod(sheet[1]), height = std::stod(sheet[2]);
    const double pt_per_unit = kWidth_mm * 72 / 25.4 / width;
    const std::regex text(
        "<text transform=\"translate\\(([0-9.-]+) ([0-9.-]+)\\)[^\"]*\" y=\"[^\"]*\" "
        "font-size=\"([0-9.]+)\"");
    int count = 0;
    for (std::sregex_iterator it(svg.begin(), svg.end(), text), end; it != end; ++it, ++count) {
      EXPECT_GT(std::stod((*it)[3]) * pt_per_unit, 7 - 0.02) << name;  // sizes have two decimals
      EXPECT_GE(std::stod((*it)[2]), 0) << name;
      EXPECT_LT(std::stod((*it)[2]), height) << name;
    }
    EXPECT_GT(count, 10) << name;
  }
}

TEST(Canvas, CurveLandsWhereTheAxisSays) {
  // 1.3 values per pixel, at sizes with and without scaling of the sheet.
  for (const auto& [width, height] : {std::pair{1600, 1000}, std::pair{800, 500}}) {
    Canvas canvas({width, height}, "x.png");
    const Panel panel{
        {100, 100, 1200, 700}, NiceAxis(0, 10, 5, true, ""), NiceAxis(-1, 1, 5, true, "")};
    std::vector<double> xs, ys;
    for (int i = 0; i <= 1560; ++i) {
      xs.push_back(10.0 * i / 1560);
      ys.push_back(0.8 * std::sin(xs.back()));
    }
    DrawCurve(&canvas, panel, xs, ys, {kBlue, 3});
    const cv::Mat picture = Picture(&canvas);
    for (double x : {0.7, 1.5707963, 4.0, 9.3}) {
      const Point2 at = panel.At(x, 0.8 * std::sin(x)) * canvas.unit();
      double sum = 0, weight = 0;
      for (int row = 0; row < picture.rows; ++row) {
        const double ink =
            255 - picture.at<cv::Vec3b>(row, static_cast<int>(at.x))[2];  // blue has no red
        sum += ink * (row + 0.5);
        weight += ink;
      }
      ASSERT_GT(weight, 0);
      // Half a pixel of rounding in the column, times the slope (at most 0.8 * 350 / 120 = 2.3),
      // and OpenCV's rounding of thick strokes: 2 px.
      EXPECT_NEAR(sum / weight, at.y, 2.0) << x;
    }
  }
}

TEST(Canvas, OneSampleSpikeSurvivesDenseData) {
  Canvas canvas({}, "x.png");
  const Panel panel{
      {100, 100, 1200, 700}, NiceAxis(0, 1, 5, true, ""), NiceAxis(0, 1, 5, true, "")};
  std::vector<double> xs, ys(200001, 0.1);
  for (int i = 0; i <= 200000; ++i) xs.push_back(i / 200000.0);
  ys[77777] = 0.9;
  DrawCurve(&canvas, panel, xs, ys, {kBlue, 2});
  const Point2 top = panel.At(xs[77777], 0.88);
  EXPECT_GT(Count(Picture(&canvas), kBlue,
                  {static_cast<int>(top.x) - 3, static_cast<int>(top.y), 7, 100}),
            50);
}

TEST(Canvas, CurvesStayInsideTheirPanel) {
  Canvas canvas({}, "x.png");
  const Panel panel{{400, 300, 600, 300}, NiceAxis(0, 1, 5, true, ""), NiceAxis(0, 1, 5, true, "")};
  const std::vector<double> xs = {-5, 0.2, 0.5, 0.8, 7}, ys = {0.5, 1e9, -1e9, 40, 0.5};
  DrawCurve(&canvas, panel, xs, ys, {kBlue, 6});
  cv::Mat picture = Picture(&canvas);
  EXPECT_GT(Count(picture, kBlue, {400, 300, 600, 300}), 100);
  picture(cv::Rect(400, 300, 600, 300)).setTo(cv::Scalar::all(255));
  EXPECT_EQ(cv::countNonZero(picture.reshape(1) != 255), 0);
}

TEST(Canvas, GreekAndMathematicalLettersHaveGlyphs) {
  const auto draw = [](const std::string& text) {
    Canvas canvas({400, 300}, "x.png");
    canvas.Text({400, 400}, text, {.size = 200});
    return Picture(&canvas);
  };
  const cv::Mat unknown = draw("\U000E0FFF");  // no font has this one: an empty box, or nothing
  for (const char* text : {"φ", "λ", "∇", "√", "°", "σ", "ε", "ρ", "→", "µ", "⁻", "⁴", "³", "·",
                           "ₘ", "ᵢ", "ₙ", "ᵀ", "\u2212"}) {
    const cv::Mat glyph = draw(text);
    EXPECT_GT(cv::countNonZero(glyph.reshape(1) != 255), 0) << text;
    EXPECT_GT(cv::countNonZero(glyph.reshape(1) != unknown.reshape(1)), 0) << text;
    EXPECT_GT(cv::countNonZero(glyph.reshape(1) != draw("?").reshape(1)), 0) << text;
  }
}

TEST(Canvas, TextStandsWhereItIsAligned) {
  for (const auto align : {AlignX::kLeft, AlignX::kCentre, AlignX::kRight}) {
    Canvas canvas({}, "x.png");
    canvas.Text({800, 500}, "HHHH", {.size = 100, .align_x = align});
    cv::Mat ink;
    cv::extractChannel(Picture(&canvas), ink, 0);
    const cv::Rect box = cv::boundingRect(ink != 255);
    const double x = align == AlignX::kLeft    ? box.x
                     : align == AlignX::kRight ? box.br().x
                                               : box.x + box.width / 2.0;
    // H has side bearings of 0.1 em = 10 px; capitals of 0.73 em are centred to rounding.
    EXPECT_NEAR(x, 800, 12);
    EXPECT_NEAR(box.y + box.height / 2.0, 500, 3);
    EXPECT_NEAR(box.height, 73, 3);
  }
}

TEST(Palette, FingersDifferInColourAndMarker) {
  for (int a = 0; a < kMaxFingers; ++a)
    for (int b = 0; b < a; ++b) {
      EXPECT_FALSE(LookOfFinger(a).colour == LookOfFinger(b).colour);
      EXPECT_NE(LookOfFinger(a).marker, LookOfFinger(b).marker);
    }
}

// ------------------------------------------------------------------------------------------------
// geometry

TEST(SphereFit, FindsTheSphereOfItsPoints) {
  RandomStream random(3, 0);
  const Vector3d centre(0.01, -0.2, 0.1);
  std::vector<Vector3d> exact, noisy;
  for (int i = 0; i < 2000; ++i) {
    Vector3d n = random.Normal3().normalized();
    n.z() = std::abs(n.z());  // one half only
    exact.push_back(centre + 0.025 * n);
    noisy.push_back(exact.back() + 0.001 * random.Normal() * n);
  }
  const auto fit = FitSphere(exact);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->radius, 0.025, 1e-12);  // rounding
  EXPECT_LT((fit->centre - centre).norm(), 1e-12);
  EXPECT_LT(fit->rms_error, 1e-12);
  const auto rough = FitSphere(noisy);
  ASSERT_TRUE(rough);
  // 1 mm of radial noise over 2000 points: the radius of a half sphere is known to about
  // 1 mm / sqrt(2000) * 4 (radius and centre along the axis are correlated) = 0.09 mm; 3 sigma.
  EXPECT_NEAR(rough->radius, 0.025, 3e-4);
  EXPECT_NEAR(rough->rms_error, 0.001, 6e-5);  // 3 sigma of a sample deviation: 3 / sqrt(2 * 2000)
}

TEST(SphereFit, RefusesPointsThatDetermineNone) {
  std::vector<Vector3d> circle, few = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}};
  for (int i = 0; i < 50; ++i) circle.emplace_back(std::cos(i), std::sin(i), 0.5);
  EXPECT_FALSE(FitSphere(circle));
  EXPECT_FALSE(FitSphere(few));
  EXPECT_FALSE(FitSphere({}));
  EXPECT_FALSE(FitSphere(std::vector<Vector3d>(10, Vector3d(1, 2, 3))));
}

std::vector<ObjectModel> Objects() {
  std::vector<ObjectModel> objects(3);
  objects[1].kind = ObjectModel::Kind::kBox;
  objects[1].half_extents = {0.02, 0.03, 0.01};
  objects[2].kind = ObjectModel::Kind::kCapsule;
  objects[2].radius = 0.015;
  objects[2].half_length = 0.02;
  return objects;
}

TEST(Outline, TrianglesFaceOutwardsAndEncloseTheVolume) {
  const std::array<double, 3> volumes = {
      4.0 / 3 * std::numbers::pi * std::pow(0.025, 3), 8 * 0.02 * 0.03 * 0.01,
      std::numbers::pi * std::pow(0.015, 2) * (4.0 / 3 * 0.015 + 0.04)};
  const auto objects = Objects();
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const ObjectMesh mesh = MeshOf(objects[i]);
    double volume = 0;
    for (const auto& t : mesh.triangles) {
      const Vector3d &a = mesh.vertices_O[t[0]], &b = mesh.vertices_O[t[1]],
                     &c = mesh.vertices_O[t[2]];
      EXPECT_GT((b - a).cross(c - a).dot(a + b + c), 0);
      volume += a.dot(b.cross(c)) / 6;
    }
    // Chords of 5 degrees lose (1 - cos 2.5°) of the radius at most, about 0.3 % of the volume.
    EXPECT_NEAR(volume, volumes[i], 0.005 * volumes[i]) << i;
  }
}

TEST(Outline, SilhouetteOfASphereIsAGreatCircle) {
  const ObjectMesh mesh = MeshOf(ObjectModel());
  const Vector3d toward = Vector3d(1, 2, 0.7).normalized();
  const auto lines = Silhouette(mesh, toward);
  EXPECT_GT(lines.size(), 50u);
  double length = 0;
  for (const SurfaceLine& line : lines) {
    // Faces are 5 degrees wide, so the edge lies within that of the circle: 0.025 * sin 5°.
    EXPECT_LT(std::abs(line.a_O.dot(toward)), 0.0022);
    length += (line.b_O - line.a_O).norm();
  }
  EXPECT_GT(length, 2 * std::numbers::pi * 0.025 * 0.99);
}

TEST(Outline, BoxShowsItsTwelveEdges) {
  double length = 0;
  for (const SurfaceLine& line : ShapeLines(MeshOf(Objects()[1])))
    if (line.n1_O.dot(line.n2_O) < 0.5) length += (line.b_O - line.a_O).norm();
  EXPECT_NEAR(length, 4 * 2 * (0.02 + 0.03 + 0.01), 1e-12);
}

Body Ball(const Vector3d& centre, double radius, Colour colour, int id) {
  Body body;
  body.X_WB.translation() = centre;
  body.radius = radius;
  body.colour = body.second_colour = colour;
  body.id = id;
  return body;
}

TEST(Renderer, SphereHasTheDiscOfItsTangentCone) {
  const cv::Size size(600, 600);
  const std::array<Body, 1> bodies = {Ball({0.1, 0.2, 0.3}, 0.05, kBlue, 0)};
  const Camera camera = FitCamera(bodies, {1, -1, 0.3}, Vector3d::UnitZ(), size, 40);
  const cv::Mat picture = Render(bodies, camera, size);
  cv::Mat grey;
  cv::extractChannel(picture, grey, 2);
  const double distance = camera.Depth({0.1, 0.2, 0.3});
  const double radius = camera.focal_px * 0.05 / std::sqrt(distance * distance - 0.05 * 0.05);
  const cv::Rect box = cv::boundingRect(grey != 255);
  // The contour adds about 0.5 mm, which is 2.6 px here, and is softened by a pixel.
  EXPECT_NEAR(box.width, 2 * radius, 8);
  EXPECT_NEAR(box.height, 2 * radius, 8);
  EXPECT_NEAR(box.x + box.width / 2.0, 300, 3);
  EXPECT_NEAR(radius, 260, 1);  // it fills the picture to the margin
}

TEST(Renderer, NearerBodiesHideFartherOnes) {
  const cv::Size size(300, 300);
  for (const bool swapped : {false, true}) {
    std::vector<Body> bodies = {Ball({0, -0.05, 0}, 0.02, kBlue, 0),
                                Ball({0, 0.05, 0}, 0.02, kVermillion, 1)};
    if (swapped) std::swap(bodies[0], bodies[1]);
    const Camera camera = FitCamera(bodies, {0, -1, 0}, Vector3d::UnitZ(), size, 30);
    const auto pixel = Render(bodies, camera, size).at<cv::Vec3b>(150, 150);
    EXPECT_GT(pixel[0], pixel[2]) << "the blue ball is nearer";
  }
}

TEST(Renderer, CapsuleBoxAndTheirMeshesCoverTheSamePixels) {
  const cv::Size size(500, 500);
  const auto objects = Objects();
  for (const ObjectModel& object : objects) {
    Body exact;
    exact.X_WB.linear() = FromRotationVector({0.4, -0.8, 0.3}).toRotationMatrix();
    exact.colour = exact.second_colour = kBlue;
    Body meshed = exact;
    meshed.kind = Body::Kind::kMesh;
    meshed.mesh = MeshOf(object);
    exact.radius = object.radius;
    exact.b_B = {0, 0, object.half_length};
    exact.a_B = -exact.b_B;
    if (object.kind == ObjectModel::Kind::kBox) {
      exact.kind = Body::Kind::kBox;
      exact.half_extents = object.half_extents;
    }
    const Camera camera = FitCamera({&exact, 1}, {1, -1, 0.5}, Vector3d::UnitZ(), size, 60);
    const cv::Mat a = Render({&exact, 1}, camera, size), b = Render({&meshed, 1}, camera, size);
    cv::Mat ga, gb;
    cv::extractChannel(a, ga, 2);
    cv::extractChannel(b, gb, 2);
    const int covered = cv::countNonZero(ga != 255),
              differ = cv::countNonZero((ga != 255) != (gb != 255));
    // Chords of 5 degrees lie up to 0.1 % of the radius inside the sphere: a rim of under 1 px.
    EXPECT_LT(differ, 0.01 * covered);
    EXPECT_GT(covered, 10000);
  }
}

}  // namespace
}  // namespace regrasp
