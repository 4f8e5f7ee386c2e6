#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "snapshots/axes.h"
#include "snapshots/plot_experiment.h"

namespace regrasp {
namespace {

constexpr double kTop = 130, kBottom = 90, kRocWidth = 640, kRocLeft = 110;
constexpr double kForestLeft = 1120, kForestRight = 60, kBetween = 8;
constexpr std::size_t kCurves = 6;

Pen PenOf(std::size_t k) {
  const FingerLook look = LookOfFinger(static_cast<int>(k));
  return {look.colour, 3, look.dash};
}

/// The ROC of the best form of each of the best measures.
void DrawRoc(Canvas* canvas, const PredictionPicture& picture, double height) {
  const Panel panel{Box(kRocLeft, kTop, kRocWidth, height),
                    NiceAxis(0, 1, 5, false, "windows that hold, with an alarm (share)"),
                    NiceAxis(0, 1, 5, false, "windows before a failure, with an alarm (share)")};
  DrawGrid(canvas, panel, true);
  canvas->Line(panel.At(0, 0), panel.At(1, 1), {kLightGrey, 1.5, {6, 6}});
  std::vector<LegendEntry> legend;
  for (std::size_t k = 0; k < std::min(kCurves, picture.predictors.size()); ++k) {
    const PredictorMark& p = picture.predictors[k];
    DrawCurve(canvas, panel, p.false_alarms, p.foretold, PenOf(k));
    legend.push_back(LineEntry(p.name + ", " + p.form, PenOf(k)));
  }
  DrawFrame(canvas, panel);
  const double lines = static_cast<double>(legend.size());
  DrawLegend(canvas, {kRocLeft + 0.29 * kRocWidth, kTop + height - 40 - 27 * lines}, "", legend);
}

/// Areas under the ROC with their intervals, best first.
void DrawForest(Canvas* canvas, const PredictionPicture& picture, double height) {
  const double rows = static_cast<double>(picture.predictors.size());
  double least = 0.4;  // and lower where an interval begins there
  for (const PredictorMark& p : picture.predictors) least = std::min(least, p.low);
  least = std::max(0.0, std::floor(10 * least) / 10);
  const Panel panel{Box(kForestLeft, kTop, canvas->width() - kForestLeft - kForestRight, height),
                    NiceAxis(least, 1, 6, false, "area under the ROC, 95 % interval"),
                    Axis{0.01, rows, rows + 1, ""}};
  DrawGrid(canvas, panel, true);
  canvas->Line(panel.At(0.5, 0), panel.At(0.5, rows), {kGrey, 1.5, {6, 6}});
  for (std::size_t k = 0; k < picture.predictors.size(); ++k) {
    const PredictorMark& p = picture.predictors[k];
    const double row = rows - 0.5 - static_cast<double>(k);
    const Colour colour = k < kCurves ? PenOf(k).colour : kGrey;
    const auto x = [&](double area) { return std::clamp(area, least, 1.0); };
    canvas->Line(panel.At(x(p.low), row), panel.At(x(p.high), row), {colour, 3});
    canvas->Mark(Marker::kDisc, panel.At(x(p.area), row), 7, colour);
    canvas->Text({kForestLeft - kBetween, panel.At(least, row).y}, p.name + ", " + p.form,
                 {.size = 16, .align_x = AlignX::kRight});
  }
  DrawFrame(canvas, panel);
}

}  // namespace

void PlotPrediction(const PredictionPicture& picture, const std::string& path) {
  if (picture.predictors.empty())
    throw std::runtime_error(path + ": nothing to draw: no window is before a failure");
  Canvas canvas({.height_px = 900}, path);
  DrawTitle(&canvas, picture.title, picture.facts);
  const double height = canvas.height() - kTop - kBottom;
  DrawRoc(&canvas, picture, height);
  DrawForest(&canvas, picture, height);
  canvas.Save();
}

}  // namespace regrasp
