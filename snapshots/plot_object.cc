#include "snapshots/plot_object.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "snapshots/axes.h"
#include "snapshots/renderer.h"

namespace regrasp {
namespace {

constexpr Colour kLight{244, 236, 212}, kDark{222, 205, 160};
constexpr double kNames = 120;  // width of the table's first column
constexpr std::array<Colour, 3> kAxes = {Colour{190, 60, 50}, Colour{50, 135, 60},
                                         Colour{50, 80, 180}};

/// 1, 2 or 5 times a power of ten, at most `value`.
double RoundBelow(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  const double ratio = value / power;
  return power * (ratio >= 5 ? 5 : ratio >= 2 ? 2 : 1);
}

void PaintView(Canvas* canvas, const Box& box, const Body& body, const ObjectModel& object,
               const Vector3d& to_viewer) {
  const double unit = canvas->scale();
  const cv::Size size = canvas->PixelsOf(box);
  Camera camera = FitCamera({&body, 1}, to_viewer, Vector3d::UnitZ(),
                            size - cv::Size(0, static_cast<int>(80 * unit)), 90 * unit);
  canvas->Paste(Render({&body, 1}, camera, size), box);
  canvas->Clip(box);
  const auto at = [&](const Vector3d& p) {
    return box.tl() + camera.Project(p) * (1 / canvas->scale());
  };
  // The axes begin at the centre of mass and end outside of the body.
  Eigen::AlignedBox3d extent;
  for (const Vector3d& v : body.mesh.vertices_O) extent.extend(v);
  for (int k = 0; k < 3; ++k) {
    const auto colour = kAxes[static_cast<std::size_t>(k)];
    const Vector3d end = (extent.max()[k] + 0.25 * object.bounding_radius) * Vector3d::Unit(k);
    const Point2 head = at(end), way = head - at(Vector3d::Zero());
    canvas->Arrow(at(Vector3d::Zero()), head, {colour, 2.5}, 1);
    canvas->Text(head + way * (18 / std::max(1.0, cv::norm(way))), std::string(1, "xyz"[k]),
                 {.size = 20, .colour = colour, .align_x = AlignX::kCentre, .halo = 2});
  }
  canvas->Disc(at(Vector3d::Zero()), 6, kWhite);
  canvas->Disc(at(Vector3d::Zero()), 4, kInk);
  const double bar = RoundBelow(object.bounding_radius);
  const Point2 left(box.x + 24, box.br().y - 26);
  const Point2 right = left + Point2(bar * camera.ScaleAt(Vector3d::Zero()) / unit, 0);
  canvas->Line(left, right, {kInk, 2.5});
  canvas->Text(right + Point2(12, 0), fmt::format("{:g} mm", bar * 1e3), {.size = 18, .halo = 2});
  canvas->Unclip();
}

}  // namespace

void PlotObject(const ObjectModel& object, std::span<const TableRow> rows,
                const PlotOptions& options, const std::string& path) {
  Canvas canvas(SizeOf(options), path);
  DrawTitle(&canvas, options.title.empty() ? object.name : options.title,
            "in the axes of its file, about the centre of mass");
  Body body;
  body.kind = Body::Kind::kMesh;
  body.mesh = MeshOf(object);
  body.colour = kLight;
  body.second_colour = kDark;
  const double gap = 20, top = 104, side_width = 480;
  const double width = (canvas.width() - side_width - 3 * gap) / 2,
               height = canvas.height() - top - 24;
  const std::array<Vector3d, 2> to_viewer = {Vector3d(0.55, -1, 0.45), Vector3d(1, 0.35, 0.9)};
  for (std::size_t i = 0; i < to_viewer.size(); ++i)
    PaintView(&canvas, Box(gap + static_cast<double>(i) * (width + gap), top, width, height), body,
              object, to_viewer[i]);
  double y = top + 30;
  for (const TableRow& row : rows) {
    const double left = canvas.width() - side_width;
    canvas.Text({left + (row.below ? 16 : 0), y}, row.name, {.size = 18, .colour = kGrey});
    canvas.Text({left + kNames, y}, row.value, {.size = 18});
    y += 28;
  }
  canvas.Save();
}

}  // namespace regrasp
