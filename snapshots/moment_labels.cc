#include "snapshots/moment_labels.h"

#include <algorithm>
#include <array>

namespace regrasp {
namespace {

constexpr int kMostRows = 6;
constexpr double kSize = 18, kMark = 12;  // of the text; from the mark to it

/// As many of the words as fit, and an ellipsis for the others.
std::string Shortened(const Canvas& canvas, const std::string& text, double room) {
  if (canvas.TextWidth(text, kSize, true) <= room) return text;
  std::string shorter = text;
  do {
    const std::size_t end = shorter.rfind(' ');
    shorter.resize(end == std::string::npos ? 0 : end);
  } while (!shorter.empty() && canvas.TextWidth(shorter + " …", kSize, true) > room);
  return shorter.empty() ? "" : shorter + " …";
}

}  // namespace

std::vector<MomentLabel> PlaceLabels(const Canvas& canvas, const Panel& scale,
                                     std::span<const Moment> moments) {
  std::array<double, kMostRows> taken;
  taken.fill(-1e9);
  std::vector<MomentLabel> labels;
  for (const Moment& moment : moments) {
    MomentLabel& label = labels.emplace_back();
    label.x = scale.At(moment.before_s, 0).x;
    const double at_right = scale.area.br().x - label.x - kMark, at_left = label.x - 8 - kMark;
    label.left = canvas.TextWidth(moment.text, kSize, true) > at_right && at_left > at_right;
    label.text = Shortened(canvas, moment.text, label.left ? at_left : at_right);
    label.width = canvas.TextWidth(label.text, kSize, true) + kMark;
    const double from = label.left ? label.x - label.width : label.x;
    const auto row = std::ranges::find_if(taken, [from](double end) { return end < from; });
    if (row == taken.end()) continue;
    *row = from + label.width + 8;
    label.row = static_cast<int>(row - taken.begin());
  }
  return labels;
}

int RowsOf(std::span<const MomentLabel> labels) {
  int rows = 0;
  for (const MomentLabel& label : labels) rows = std::max(rows, label.row + 1);
  return rows;
}

void DrawMoments(Canvas* canvas, std::span<const Panel> panels, double y,
                 std::span<const Moment> moments, std::span<const MomentLabel> labels) {
  const auto middle = [y](const MomentLabel& label) { return y + kLabelRow * label.row; };
  const double bottom = panels.back().area.br().y;
  for (std::size_t i = 0; i < moments.size(); ++i) {
    const bool named = labels[i].row >= 0;
    canvas->Line({labels[i].x, named ? middle(labels[i]) + 6 : panels.front().area.y},
                 {labels[i].x, bottom}, {moments[i].colour, kMomentPen.width, kMomentPen.dash});
  }
  for (std::size_t i = 0; i < moments.size(); ++i) {
    const MomentLabel& label = labels[i];
    if (label.row < 0) continue;
    const double line = middle(label), begin = label.left ? label.x - label.width : label.x + kMark;
    canvas->FillBox({begin - 2, line - 11, label.width - kMark + 4, 22}, kWhite);
    canvas->Mark(Marker::kDown, {label.x, line}, 5, moments[i].colour);
    canvas->Text({begin, line}, label.text,
                 {.size = kSize, .colour = Shade(moments[i].colour, 0.15), .bold = true});
  }
}

}  // namespace regrasp
