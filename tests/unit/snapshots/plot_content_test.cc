// What single pictures show.

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "snapshots/plot_experiment.h"
#include "snapshots/timeline.h"
#include "tests/unit/snapshots/pixels.h"
#include "tests/unit/snapshots/snapshots_fixture.h"

namespace regrasp {
namespace {

namespace fs = std::filesystem;

TEST_F(Snapshots, SceneOfAnotherHandIsRefused) {
  const std::string error =
      ErrorOf([&] { PlotScene(Frame(), hand_, object_, {}, File("scene.png")); });
  EXPECT_NE(error.find("0 joint angles"), std::string::npos) << error;
  EXPECT_NE(error.find(File("scene.png")), std::string::npos) << error;
}

/// Where a text stands in an SVG, the last time it does.
double PlaceOf(const std::string& svg, const std::string& text) {
  const std::size_t at = svg.rfind(">" + text + "</text>");
  const std::size_t begin = svg.rfind("<text", at), x = svg.find("translate(", begin);
  EXPECT_LT(x, at) << text;
  return x < at ? std::stod(svg.substr(x + 10)) : 0;
}

// The first finger stands at -x, the third at +x; the second touches at +y, the third at -y.
TEST_F(Snapshots, TheThumbsSideIsWhereTheThumbIs) {
  const auto drawn = [&](int thumb, const std::string& name) {
    HandModel hand = hand_;
    hand.fingers[1].name = "far_y";
    hand.fingers[static_cast<std::size_t>(thumb)].name = name;
    PlotScene(run_.back(), hand, object_, {}, File("side.svg"));
    return Bytes(File("side.svg"));
  };
  const std::string right = drawn(2, "thumb"), left = drawn(0, "thumb"), none = drawn(0, "digit");
  for (const std::string& svg : {right, left})
    EXPECT_NE(svg.find("from the thumb's side"), std::string::npos);
  EXPECT_EQ(none.find("thumb"), std::string::npos);
  EXPECT_NE(none.find(">from +x<"), std::string::npos);
  EXPECT_GT(PlaceOf(right, "far_y"), PlaceOf(right, "thumb"));
  EXPECT_GT(PlaceOf(none, "far_y"), PlaceOf(none, "three"));
  EXPECT_LT(PlaceOf(left, "far_y"), PlaceOf(left, "three"));
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

TEST_F(Snapshots, AnExperimentOfManyCasesShowsWhatThereIsRoomFor) {
  ExperimentPicture picture;
  picture.title = "Many";
  picture.measure_labels = {"gain"};
  for (int panel = 0; panel < 60; ++panel)
    for (const char* row : {"first", "middle", "ring", "little", "thumb"})
      picture.groups.push_back(
          {row, "", fmt::format("body {}", panel), {{"φ rose", 0.9, 0.6, 1}}, {{}}});
  const auto drawn = [&](double width_mm) {
    picture.width_mm = width_mm;
    PlotExperiment(picture, File("cases.svg"));
    return Bytes(File("cases.svg"));
  };
  for (const double width_mm : {0.0, 88.0, 180.0}) {
    SCOPED_TRACE(width_mm);
    const std::string svg = drawn(width_mm);
    EXPECT_NE(svg.find("of 60 panels"), std::string::npos);
    EXPECT_NE(svg.find("body 0<"), std::string::npos);
    EXPECT_EQ(svg.find("body 59<"), std::string::npos);
  }
  for (auto& group : picture.groups) {
    group.row = group.panel + " " + group.row;
    group.panel.clear();
  }
  EXPECT_NE(drawn(0).find("of 300 rows"), std::string::npos);
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

TEST_F(Snapshots, IncidentTellsWhereTheObjectIsOnlyWhileItIsHeldAndNamesItsLines) {
  std::vector<Frame> run = run_;
  for (Frame& frame : run) {
    // Nobody has asked for a place while the hand closes: half a metre would set the axis.
    frame.p_WO_reference = frame.p_WO;
    if (frame.stand_in) frame.p_WO_reference.x() += 0.5;
  }
  const auto svg = [&](std::span<const Event> events) {
    PlotIncident(run, events, NoteOf(run), hand_, {}, File("i.svg"));
    return Bytes(File("i.svg"));
  };
  const auto says = [](const std::string& text, const char* words) {
    return text.find(words) != std::string::npos;
  };
  EXPECT_FALSE(says(svg(events_), ">500<"));
  EXPECT_TRUE(says(svg(events_), "event, see above"));
  IncidentNote nobody = NoteOf(run);
  nobody.ends.clear();
  PlotIncident(run, {}, nobody, hand_, {}, File("n.svg"));
  EXPECT_FALSE(says(Bytes(File("n.svg")), "event, see above"));
}

TEST_F(Snapshots, ComparisonShowsBothRunsAndTheThreshold) {
  std::vector<Frame> other = run_;
  for (Frame& frame : other) frame.fingers[kSyntheticExplorer].true_manipulability *= 0.8;
  const std::array<LabelledRun, 2> runs = {LabelledRun{"manipulability", run_, "", ""},
                                           LabelledRun{"combined", other, "", ""}};
  PlotQualityComparison(runs, hand_, {}, File("c.png"));
  const cv::Mat picture = cv::imread(File("c.png"));
  const cv::Rect upper(152, 118, 1150, 370), lower(152, 530, 1150, 370);
  for (const cv::Rect& panel : {upper, lower})
    EXPECT_GT(Count(picture, kVermillion, panel),
              500);                              // solid, so at least about one pixel per column
  EXPECT_GT(Count(picture, kBlue, upper), 200);  // dotted
  EXPECT_GT(Count(picture, kGrey, lower), 300);  // dashed threshold
}

TEST_F(Snapshots, ComparisonSaysWhatIsCommonToTheRunsAndWhatIsNot) {
  std::vector<Frame> other = run_;
  for (Frame& frame : other) frame.seed = 8;
  const auto svg = [&](const LabelledRun& second) {
    const std::array<LabelledRun, 2> runs = {LabelledRun{"A", run_, "egg", ""}, second};
    PlotOptions options;
    options.object_name = "of the last run";
    PlotQualityComparison(runs, hand_, options, File("c.svg"));
    return Bytes(File("c.svg"));
  };
  const std::string seeds = svg({"B", other, "egg", "gait.speed 1 (2)"});
  for (const char* text : {"noise paper · hand synthetic · object egg (80 g, µ 0.8) · simulated",
                           "A: seed 7, default parameters", "B: seed 8, changed: gait.speed 1 (2)"})
    EXPECT_NE(seeds.find(text), std::string::npos) << text;
  const std::string objects = svg({"B", run_, "cube", ""});
  EXPECT_NE(objects.find("seed 7 · noise paper · hand synthetic · simulated"), std::string::npos);
  EXPECT_NE(objects.find("B: object cube"), std::string::npos);
  EXPECT_EQ((seeds + objects).find("of the last run"), std::string::npos);
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
