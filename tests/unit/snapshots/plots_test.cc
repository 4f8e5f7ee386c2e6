// What holds for every picture.

#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <regex>
#include <string>
#include <thread>

#include "snapshots/canvas.h"
#include "snapshots/plot_experiment.h"
#include "tests/unit/snapshots/snapshots_fixture.h"

namespace regrasp {
namespace {

namespace fs = std::filesystem;

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

TEST_F(Snapshots, EveryPictureNamesTheParametersThatDiffer) {
  PlotOptions options;
  options.changed = "gait.speed 1 (2)";
  for (const PlotRow& plot : kPlotTable) {
    PlotInput input = InputOf(run_, options);
    for (PlotRun& run : input.explorations) run.changed = options.changed;
    DrawPlot(plot.name, input, File(plot.name, ".svg"));
    EXPECT_NE(Bytes(File(plot.name, ".svg")).find("changed: gait.speed 1 (2)"), std::string::npos)
        << plot.name;
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

TEST_F(Snapshots, ASweepIsAsHighAsItsPanels) {
  ExperimentPicture sweep;
  sweep.title = "Sweep";
  sweep.facts = "a · b";
  const auto height_and_lowest = [&] {
    PlotSweep(sweep, File("sweep.svg"));
    const std::string svg = Bytes(File("sweep.svg"));
    std::smatch sheet;
    EXPECT_TRUE(std::regex_search(svg, sheet, std::regex("viewBox=\"0 0 ([0-9.]+) ([0-9.]+)\"")));
    const std::regex text("<text transform=\"translate\\(([0-9.-]+) ([0-9.-]+)\\)");
    double lowest = 0;
    for (std::sregex_iterator it(svg.begin(), svg.end(), text), end; it != end; ++it)
      lowest = std::max(lowest, std::stod((*it)[2]));
    return std::pair{std::stod(sheet[2]), lowest};
  };
  for (const char* finger : {"first", "middle", "ring", "little"}) {
    for (const char* noise : {"off", "paper", "coarse"})
      sweep.groups.push_back({noise, "secant", finger, {{"φ rose", 0.9, 0.6, 1}}, {}});
    // The name of the axis is the last on the sheet.
    const auto [height, lowest] = height_and_lowest();
    EXPECT_LT(height - lowest, 80) << finger;
  }
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
      EXPECT_EQ(error, good + ": a picture of " + std::to_string(width) + " x " +
                           std::to_string(height) +
                           " pixels; allowed are 400 x 300 to 8000 x 8000");
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
    run[i].exploration.criterion = Criterion::kStability;  // its phi is not known yet
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

}  // namespace
}  // namespace regrasp
