#pragma once

/// Moments of a time axis that have names: a line through every panel, its name above them.
/// Internal to snapshots/.

#include <span>
#include <string>
#include <vector>

#include "snapshots/axes.h"

namespace regrasp {

/// Something with a moment and a name.
struct Moment {
  double before_s = 0;  ///< negative: before the drop
  std::string text;
  Colour colour;
};

/// Of moments in general; one of a finger has its colour.
inline const Pen kMomentPen{kInk, 1.6, {6, 4}};

inline constexpr double kLabelRow = 24;  ///< height of a row of labels

/// Where a label stands, to the right of its mark or to the left.
struct MomentLabel {
  std::string text;  ///< as much as fits
  double x = 0;      ///< of the mark
  int row = -1;      ///< from above; -1: it finds no room
  bool left = false;
  double width = 0;  ///< with its mark
};

/// A label for each of `moments`, which are in order. `scale`: the x axis, and where it lies.
std::vector<MomentLabel> PlaceLabels(const Canvas& canvas, const Panel& scale,
                                     std::span<const Moment> moments);
/// So many rows they take.
int RowsOf(std::span<const MomentLabel> labels);

/// The first row's middle is at `y`. The lines end at the last panel and run behind the labels.
void DrawMoments(Canvas* canvas, std::span<const Panel> panels, double y,
                 std::span<const Moment> moments, std::span<const MomentLabel> labels);

}  // namespace regrasp
