#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <string>

#include "core/common/random.h"
#include "snapshots/axes.h"
#include "snapshots/snapshots.h"
#include "tests/unit/snapshots/pixels.h"

namespace regrasp {
namespace {

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

}  // namespace
}  // namespace regrasp
