#pragma once

/// An object in its own frame O, as a distant viewer sees it. Internal to snapshots/.

#include <array>
#include <span>

#include "snapshots/axes.h"
#include "snapshots/canvas.h"
#include "snapshots/outline.h"

namespace regrasp {

/// Orthographic view: right, up and towards the viewer in O; p [m] is drawn in mm.
struct ObjectView {
  Matrix3d R_VO;  ///< rows: right, up, to the viewer
  Point2 centre;  ///< where the origin of O is drawn
  double per_mm;  ///< logical units
  Point2 At(const Vector3d& p_O) const {
    const Vector3d v = R_VO * p_O * 1e3;
    return centre + Point2(v.x(), -v.y()) * per_mm;
  }
  Vector3d ToViewer() const { return R_VO.row(2); }
};

/// `to_viewer`, `up`: in O, of any length, not parallel.
ObjectView MakeView(const Vector3d& to_viewer, const Vector3d& up, Point2 centre, double per_mm);

/// Its z upwards, so large that the cube |x|, |y|, |z| <= half_mm fills `box` with the values and
/// names that DrawCube writes.
ObjectView ViewOfCube(const Vector3d& to_viewer, double half_mm, const Box& box);

/// Of the lines on its surface those that face the viewer, with its outline; or those that do not.
void DrawObject(Canvas* canvas, const ObjectView& view, const ObjectMesh& mesh,
                std::span<const SurfaceLine> lines, bool front);

/// A little larger than it is, so that no seams show between neighbours.
void FillTriangle(Canvas* canvas, std::array<Point2, 3> corners, Colour colour);

/// Its surface in one colour.
void FillObject(Canvas* canvas, const ObjectView& view, const ObjectMesh& mesh, Colour colour);

/// The three far walls of the cube |x|, |y|, |z| <= axis.hi [mm], with grid, ticks and names of the
/// axes.
void DrawCube(Canvas* canvas, const ObjectView& view, const Axis& axis);

/// Arrows along x, y and z of O.
void DrawDirections(Canvas* canvas, const ObjectView& view, Point2 origin);

/// A bar of 1, 2 or 5 times a power of ten millimetres, at most `width` long; from `left` on.
void DrawScaleBar(Canvas* canvas, const ObjectView& view, Point2 left, double width);

}  // namespace regrasp
