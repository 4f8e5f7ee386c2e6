#pragma once

/// One of the scene's two pictures: the rendered bodies with everything that is written on them.
/// Inside of snapshots/.

#include <span>
#include <string>
#include <vector>

#include "snapshots/canvas.h"
#include "snapshots/renderer.h"

namespace regrasp {

class SceneView {
 public:
  /// Draws the bodies into `box`. `detail`: pixels rendered per pixel of the picture, along either
  /// side.
  SceneView(Canvas* canvas, const Box& box, std::span<const Body> bodies, const Vector3d& to_viewer,
            const Vector3d& up, double detail);

  Point2 At(const Vector3d& p_W) const {
    return box_.tl() + camera_.Project(p_W) * (1 / canvas_->scale());
  }
  /// The force as an arrow that pushes with its head on the contact point.
  void Force(const Vector3d& p_W, const Vector3d& f_W, double metres_per_newton, Colour dot);
  /// A name near `p_W`, away from `from` on the sheet and from what has been written before.
  void Label(const Vector3d& p_W, Point2 from, const std::string& text, Colour colour);
  /// Directions x, y, z of the palm's frame, and gravity, in the corners at the top.
  void Directions(const Vector3d& gravity_W);
  /// Lengths at the depth of the object, in the lower left corner.
  void Scales(const Vector3d& p_WO, double newton, double metres_per_newton);

 private:
  double PerMetreAt(const Vector3d& p_W) const { return camera_.ScaleAt(p_W) / canvas_->scale(); }
  /// Part of a box on the sheet that bodies cover, 0 .. 1.
  double Covered(const Box& room) const;

  Canvas* canvas_;
  Box box_;
  Camera camera_;
  std::vector<Box> taken_;
  cv::Mat_<int> drawn_;  ///< sums over the cells above and to the left that show a body, 255 each
};

}  // namespace regrasp
