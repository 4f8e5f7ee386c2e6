#pragma once

/// A small software renderer: spheres, capsules and boxes by ray intersection, meshes by
/// rasterising, into one depth buffer. Internal to snapshots/.

#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "core/common/frames.h"
#include "core/hand/hand_model.h"
#include "snapshots/outline.h"
#include "snapshots/palette.h"

namespace regrasp {

/// One body to draw, in W. A second colour paints alternate octants of its own frame B, which shows
/// how it is turned.
struct Body {
  enum class Kind { kCapsule, kBox, kMesh } kind = Kind::kCapsule;
  Isometry3d X_WB = Isometry3d::Identity();
  Vector3d a_B = Vector3d::Zero(),
           b_B = Vector3d::Zero();           ///< capsule axis; equal for a sphere [m]
  double radius = 0;                         ///< capsule [m]
  Vector3d half_extents = Vector3d::Zero();  ///< box [m]
  ObjectMesh mesh;                           ///< mesh, in B [m]
  Colour colour, second_colour;
  int id = 0;  ///< a contour is drawn between bodies of different id

  /// A sphere that contains the body: centre in W and radius [m].
  std::pair<Vector3d, double> BoundingSphere() const;
};

/// A pinhole camera: x right, y down, z forward.
struct Camera {
  Isometry3d X_CW = Isometry3d::Identity();
  double focal_px = 1000;
  double centre_x_px = 0, centre_y_px = 0;
  /// Pixel of a point in W; positions of pixel centres are whole numbers.
  cv::Point2d Project(const Vector3d& p_W) const {
    const Vector3d p = X_CW * p_W;
    return {centre_x_px + focal_px * p.x() / p.z(), centre_y_px + focal_px * p.y() / p.z()};
  }
  double Depth(const Vector3d& p_W) const { return (X_CW * p_W).z(); }
  /// Pixels per metre at the depth of a point.
  double ScaleAt(const Vector3d& p_W) const { return focal_px / Depth(p_W); }
};

/// A camera that looks from the direction `to_viewer_W` with `up_W` upwards and fits all bodies
/// into `size`, `margin` pixels from its border.
Camera FitCamera(std::span<const Body> bodies, const Vector3d& to_viewer_W, const Vector3d& up_W,
                 cv::Size size, double margin);

/// The picture, 8-bit BGR on white: diffuse and a little specular light from the upper left,
/// darkened behind nearer bodies [Luft, Colditz, Deussen 2006], with dark contours.
cv::Mat Render(std::span<const Body> bodies, const Camera& camera, cv::Size size);

}  // namespace regrasp
