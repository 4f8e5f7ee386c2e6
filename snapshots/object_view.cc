#include "snapshots/object_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/common/box_corners.h"

namespace regrasp {
namespace {

constexpr double kMm = 1e3;

}  // namespace

ObjectView MakeView(const Vector3d& to_viewer, const Vector3d& up, Point2 centre, double per_mm) {
  ObjectView view;
  const Vector3d z = to_viewer.normalized(), x = up.cross(z).normalized();
  view.R_VO << x.transpose(), z.cross(x).transpose(), z.transpose();
  view.centre = centre;
  view.per_mm = per_mm;
  return view;
}

ObjectView ViewOfCube(const Vector3d& to_viewer, double half_mm, const Box& box) {
  ObjectView view = MakeView(to_viewer, Vector3d::UnitZ(), {0, 0}, 1);
  Range across, down;  // of the cube's corners, at 1 unit per mm
  for (const Vector3d& corner_O : BoxCorners(Vector3d::Constant(half_mm / kMm))) {
    const Point2 corner = view.At(corner_O);
    across.Add(corner.x);
    down.Add(corner.y);
  }
  // Room for tick values and names: 90 on the left and below.
  view.per_mm = std::min((box.width - 100) / (across.hi - across.lo),
                         (box.height - 100) / (down.hi - down.lo));
  view.centre = {box.x + 95 + (box.width - 100) / 2, box.y + 10 + (box.height - 100) / 2};
  return view;
}

void DrawObject(Canvas* canvas, const ObjectView& view, const ObjectMesh& mesh,
                std::span<const SurfaceLine> lines, bool front) {
  for (const SurfaceLine& line : lines)
    if (line.FacesViewer(view.ToViewer()) == front)
      canvas->Line(view.At(line.a_O), view.At(line.b_O),
                   {front ? Colour{172, 172, 172} : Colour{222, 222, 222}, front ? 1.2 : 1.0});
  if (!front) return;
  for (const SurfaceLine& line : Silhouette(mesh, view.ToViewer()))
    canvas->Line(view.At(line.a_O), view.At(line.b_O), {Colour{120, 120, 120}, 2});
}

void FillTriangle(Canvas* canvas, std::array<Point2, 3> corners, Colour colour) {
  constexpr double kSeam = 0.8;
  const Point2 middle = (corners[0] + corners[1] + corners[2]) * (1.0 / 3);
  for (Point2& corner : corners)
    corner += (corner - middle) * (kSeam / std::max(kSeam, cv::norm(corner - middle)));
  canvas->Polygon(corners, colour);
}

void FillObject(Canvas* canvas, const ObjectView& view, const ObjectMesh& mesh, Colour colour) {
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const std::array<Point2, 3> corners = {view.At(mesh.vertices_O[t[0]]),
                                           view.At(mesh.vertices_O[t[1]]),
                                           view.At(mesh.vertices_O[t[2]])};
    // Counter-clockwise from outside is so on paper, whose y goes up.
    if ((corners[1] - corners[0]).cross(corners[2] - corners[0]) < 0)
      FillTriangle(canvas, corners, colour);
  }
}

void DrawCube(Canvas* canvas, const ObjectView& view, const Axis& axis) {
  const Vector3d toward = view.ToViewer();
  const double half = axis.hi / kMm;
  Vector3d far;  // corner of the cube farthest from the viewer
  for (int k = 0; k < 3; ++k) far[k] = toward[k] > 0 ? -half : half;
  // Without those at the cube's corners, where the values of two edges meet.
  auto ticks = axis.Ticks();
  std::erase_if(ticks, [&](double tick) { return std::abs(tick) > 0.94 * axis.hi; });
  for (int wall = 0; wall < 3; ++wall) {
    const int u = (wall + 1) % 3, v = (wall + 2) % 3;
    const auto corner = [&](double cu, double cv) {
      Vector3d p = far;
      p[u] = cu;
      p[v] = cv;
      return view.At(p);
    };
    const std::vector<Point2> wall_corners = {corner(-half, -half), corner(half, -half),
                                              corner(half, half), corner(-half, half)};
    canvas->Polygon(wall_corners, wall == 2 ? Colour{246, 246, 246} : Colour{250, 250, 250});
    for (double tick : ticks) {
      canvas->Line(corner(tick / kMm, -half), corner(tick / kMm, half), {kGridGrey, 1});
      canvas->Line(corner(-half, tick / kMm), corner(half, tick / kMm), {kGridGrey, 1});
    }
  }
  // x and y are written along the near edges of the floor, z along the leftmost upright edge.
  static constexpr const char* kNames[] = {"x [mm]", "y [mm]", "z [mm]"};
  for (int k = 0; k < 3; ++k) {
    Vector3d edge = -far;
    edge[2] = -half;
    if (k == 2) {
      edge = far;
      // Of the two edges between a far and a near wall take the one further left.
      Vector3d other = far;
      edge[0] = -far[0];
      other[1] = -far[1];
      if (view.At(other).x < view.At(edge).x) edge = other;
    }
    Vector3d from = edge, to = edge;
    from[k] = -half;
    to[k] = half;
    const Point2 a = view.At(from), b = view.At(to), middle = (a + b) * 0.5;
    canvas->Line(a, b, {kInk, 1.5});
    // Ticks point away from the cube's centre on the sheet, perpendicular to the edge.
    Point2 out(-(b - a).y, (b - a).x);
    out *= 1.0 / std::max(1e-9, cv::norm(out));
    if (out.dot(middle - view.centre) < 0) out = -out;
    for (double tick : ticks) {
      Vector3d p = edge;
      p[k] = tick / kMm;
      const Point2 at = view.At(p);
      canvas->Line(at, at + out * 7, {kInk, 1.5});
      canvas->Text(at + out * (k == 2 ? 32 : 26), axis.TickText(tick),
                   {.size = 18, .align_x = AlignX::kCentre});
    }
    canvas->Text(middle + out * (k == 2 ? 74 : 78), kNames[k],
                 {.size = 20, .align_x = AlignX::kCentre, .upwards = k == 2});
  }
}

void DrawDirections(Canvas* canvas, const ObjectView& view, Point2 origin) {
  constexpr double kLength = 46;
  std::array<int, 3> order = {0, 1, 2};  // what points at the viewer goes on top
  std::ranges::sort(order, {}, [&](int k) { return view.R_VO(2, k); });
  for (const int k : order) {
    const Point2 way(view.R_VO(0, k), -view.R_VO(1, k));
    const Point2 head = origin + way * kLength;
    canvas->Arrow(origin, head, {kGrey, 2.4}, 1.5);
    canvas->Text(head + way * (16 / std::max(0.1, cv::norm(way))), std::string(1, "xyz"[k]),
                 {.size = 18, .colour = kGrey, .align_x = AlignX::kCentre, .halo = 2});
  }
}

void DrawScaleBar(Canvas* canvas, const ObjectView& view, Point2 left, double width) {
  const double most = width / view.per_mm, power = std::pow(10.0, std::floor(std::log10(most)));
  const double mm = power * (most / power >= 5 ? 5 : most / power >= 2 ? 2 : 1);
  const Point2 right = left + Point2(mm * view.per_mm, 0);
  canvas->Line(left, right, {kInk, 2.5});
  for (const Point2& end : {left, right})
    canvas->Line(end - Point2(0, 6), end + Point2(0, 6), {kInk, 2.5});
  canvas->Text(right + Point2(12, 0), fmt::format("{:g} mm", mm), {.size = 18, .halo = 2});
}

}  // namespace regrasp
