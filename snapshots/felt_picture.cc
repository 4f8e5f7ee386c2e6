#include "snapshots/felt_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/world/true_surface.h"
#include "snapshots/palette.h"

namespace regrasp {
namespace {

constexpr double kMm = 1e3;
constexpr int kDivisions = 5;  // of the mesh: 20480 triangles
constexpr std::array kScales = {0.1e-3, 0.2e-3, 0.5e-3, 1e-3, 2e-3, 5e-3};

/// The smallest of the scales that nearly all errors fit.
double ScaleOf(std::vector<double> sizes) {
  if (sizes.empty()) return kScales.front();
  const auto most =
      sizes.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(sizes.size() - 1));
  std::nth_element(sizes.begin(), most, sizes.end());
  const auto scale = std::ranges::find_if(kScales, [&](double s) { return s >= *most; });
  return scale == kScales.end() ? kScales.back() : *scale;
}

/// A triangle to draw.
struct Face {
  double depth = 0;  ///< towards the viewer
  std::array<Point2, 3> corners;
  Colour colour;
};

}  // namespace

FeltPicture JudgeFelt(const FeltSurface& felt, const ObjectModel& object) {
  FeltPicture picture;
  const TrueSurface truth(object);
  picture.mesh = MeshOf(felt, kDivisions);
  picture.judged = JudgeShape(felt, truth);
  std::vector<double> sizes;
  for (const SurfacePoint& point : picture.mesh.vertices) {
    const bool drawn = point.unknown < kFeltReach;
    picture.errors.push_back(drawn ? truth.At(point.p_O).distance : 0);
    if (drawn) sizes.push_back(std::abs(picture.errors.back()));
  }
  picture.scale = ScaleOf(std::move(sizes));
  return picture;
}

Colour ErrorColour(double share) {
  return Tint(share < 0 ? kBlue : kVermillion, 1 - std::min(1.0, std::abs(share)));
}

void DrawFelt(Canvas* canvas, const ObjectView& view, const FeltPicture& picture) {
  std::vector<Face> faces;
  for (const Eigen::Vector3i& t : picture.mesh.triangles) {
    Face face;
    Vector3d normal = Vector3d::Zero();
    double error = 0, unknown = 0;
    for (int k = 0; k < 3; ++k) {
      const SurfacePoint& point = picture.mesh.vertices[t[k]];
      face.corners[k] = view.At(point.p_O);
      face.depth += point.p_O.dot(view.ToViewer()) / 3;
      normal += point.normal_O;
      error += picture.errors[t[k]] / 3;
      unknown = std::max(unknown, point.unknown);
    }
    const double facing = normal.normalized().dot(view.ToViewer());
    if (unknown >= kFeltReach || facing <= 0) continue;
    // A little shade, so that the shape is seen.
    face.colour = Shade(ErrorColour(error / picture.scale), 0.25 * (1 - facing));
    faces.push_back(face);
  }
  std::ranges::stable_sort(faces, {}, &Face::depth);  // a body that is not convex hides parts
  for (const Face& face : faces) FillTriangle(canvas, face.corners, face.colour);
}

std::vector<LegendEntry> FeltFigures(const FeltPicture& picture) {
  const ShapeErrors& judged = picture.judged;
  if (judged.cells == 0) return {};
  const double bias = judged.mean_m * kMm;
  return {{fmt::format("rms error  {:.2f} mm", judged.rms_m * kMm), {}},
          {fmt::format("bias  {}{:.2f} mm", bias < -0.005 ? "−" : "",
                       std::abs(bias) < 0.005 ? 0 : std::abs(bias)),
           {}},
          {fmt::format("normals off by  {:.1f}°", judged.normal_rad * 180 / std::numbers::pi), {}}};
}

std::vector<LegendEntry> FeltFacts(const FeltPicture& picture) {
  const double scale = picture.scale * kMm;
  std::vector<LegendEntry> facts = {
      {fmt::format("−{:.1f} to {:.1f} mm off", scale, scale), [](Canvas* c, Point2 m) {
         constexpr int kSteps = 22;
         for (int i = 0; i < kSteps; ++i)
           c->FillBox({m.x - 22 + 44.0 * i / kSteps, m.y - 8, 44.0 / kSteps + 0.5, 16},
                      ErrorColour(2.0 * i / (kSteps - 1) - 1));
       }}};
  facts.push_back({fmt::format("touched  {:.0f} % of it", 100 * picture.judged.touched), {}});
  std::ranges::copy(FeltFigures(picture), std::back_inserter(facts));
  return facts;
}

}  // namespace regrasp
