#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <string>

#include "core/common/random.h"
#include "snapshots/outline.h"
#include "snapshots/renderer.h"
#include "snapshots/sphere_fit.h"

namespace regrasp {
namespace {

TEST(SphereFit, FindsTheSphereOfItsPoints) {
  RandomStream random(3, 0);
  const Vector3d centre(0.01, -0.2, 0.1);
  std::vector<Vector3d> exact, noisy;
  for (int i = 0; i < 2000; ++i) {
    Vector3d n = random.Normal3().normalized();
    n.z() = std::abs(n.z());  // one half only
    exact.push_back(centre + 0.025 * n);
    noisy.push_back(exact.back() + 0.001 * random.Normal() * n);
  }
  const auto fit = FitSphere(exact);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->radius, 0.025, 1e-12);  // rounding
  EXPECT_LT((fit->centre - centre).norm(), 1e-12);
  EXPECT_LT(fit->rms_error, 1e-12);
  const auto rough = FitSphere(noisy);
  ASSERT_TRUE(rough);
  // 1 mm of radial noise over 2000 points: the radius of a half sphere is known to about
  // 1 mm / sqrt(2000) * 4 (radius and centre along the axis are correlated) = 0.09 mm; 3 sigma.
  EXPECT_NEAR(rough->radius, 0.025, 3e-4);
  EXPECT_NEAR(rough->rms_error, 0.001, 6e-5);  // 3 sigma of a sample deviation: 3 / sqrt(2 * 2000)
}

TEST(SphereFit, RefusesPointsThatDetermineNone) {
  std::vector<Vector3d> circle, few = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}};
  for (int i = 0; i < 50; ++i) circle.emplace_back(std::cos(i), std::sin(i), 0.5);
  EXPECT_FALSE(FitSphere(circle));
  EXPECT_FALSE(FitSphere(few));
  EXPECT_FALSE(FitSphere({}));
  EXPECT_FALSE(FitSphere(std::vector<Vector3d>(10, Vector3d(1, 2, 3))));
}

std::vector<ObjectModel> Objects() {
  std::vector<ObjectModel> objects(2);
  objects[1].kind = ObjectModel::Kind::kBox;
  objects[1].half_extents = {0.02, 0.03, 0.01};
  return objects;
}

TEST(Outline, TrianglesFaceOutwardsAndEncloseTheVolume) {
  const std::array<double, 2> volumes = {4.0 / 3 * std::numbers::pi * std::pow(0.025, 3),
                                         8 * 0.02 * 0.03 * 0.01};
  const auto objects = Objects();
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const ObjectMesh mesh = MeshOf(objects[i]);
    double volume = 0;
    for (const auto& t : mesh.triangles) {
      const Vector3d &a = mesh.vertices_O[t[0]], &b = mesh.vertices_O[t[1]],
                     &c = mesh.vertices_O[t[2]];
      EXPECT_GT((b - a).cross(c - a).dot(a + b + c), 0);
      volume += a.dot(b.cross(c)) / 6;
    }
    // Chords of 5 degrees lose (1 - cos 2.5°) of the radius at most, about 0.3 % of the volume.
    EXPECT_NEAR(volume, volumes[i], 0.005 * volumes[i]) << i;
  }
}

TEST(Outline, SilhouetteOfASphereIsAGreatCircle) {
  const ObjectMesh mesh = MeshOf(ObjectModel());
  const Vector3d toward = Vector3d(1, 2, 0.7).normalized();
  const auto lines = Silhouette(mesh, toward);
  EXPECT_GT(lines.size(), 50u);
  double length = 0;
  for (const SurfaceLine& line : lines) {
    // Faces are 5 degrees wide, so the edge lies within that of the circle: 0.025 * sin 5°.
    EXPECT_LT(std::abs(line.a_O.dot(toward)), 0.0022);
    length += (line.b_O - line.a_O).norm();
  }
  EXPECT_GT(length, 2 * std::numbers::pi * 0.025 * 0.99);
}

TEST(Outline, BoxShowsItsTwelveEdges) {
  double length = 0;
  for (const SurfaceLine& line : ShapeLines(MeshOf(Objects()[1])))
    if (line.n1_O.dot(line.n2_O) < 0.5) length += (line.b_O - line.a_O).norm();
  EXPECT_NEAR(length, 4 * 2 * (0.02 + 0.03 + 0.01), 1e-12);
}

Body Ball(const Vector3d& centre, double radius, Colour colour, int id) {
  Body body;
  body.X_WB.translation() = centre;
  body.radius = radius;
  body.colour = body.second_colour = colour;
  body.id = id;
  return body;
}

TEST(Renderer, SphereHasTheDiscOfItsTangentCone) {
  const cv::Size size(600, 600);
  const std::array<Body, 1> bodies = {Ball({0.1, 0.2, 0.3}, 0.05, kBlue, 0)};
  const Camera camera = FitCamera(bodies, {1, -1, 0.3}, Vector3d::UnitZ(), size, 40);
  const cv::Mat picture = Render(bodies, camera, size);
  cv::Mat grey;
  cv::extractChannel(picture, grey, 2);
  const double distance = camera.Depth({0.1, 0.2, 0.3});
  const double radius = camera.focal_px * 0.05 / std::sqrt(distance * distance - 0.05 * 0.05);
  const cv::Rect box = cv::boundingRect(grey != 255);
  // The contour adds about 0.5 mm, which is 2.6 px here, and is softened by a pixel.
  EXPECT_NEAR(box.width, 2 * radius, 8);
  EXPECT_NEAR(box.height, 2 * radius, 8);
  EXPECT_NEAR(box.x + box.width / 2.0, 300, 3);
  EXPECT_NEAR(radius, 260, 1);  // it fills the picture to the margin
}

TEST(Renderer, NearerBodiesHideFartherOnes) {
  const cv::Size size(300, 300);
  for (const bool swapped : {false, true}) {
    std::vector<Body> bodies = {Ball({0, -0.05, 0}, 0.02, kBlue, 0),
                                Ball({0, 0.05, 0}, 0.02, kVermillion, 1)};
    if (swapped) std::swap(bodies[0], bodies[1]);
    const Camera camera = FitCamera(bodies, {0, -1, 0}, Vector3d::UnitZ(), size, 30);
    const auto pixel = Render(bodies, camera, size).at<cv::Vec3b>(150, 150);
    EXPECT_GT(pixel[0], pixel[2]) << "the blue ball is nearer";
  }
}

TEST(Renderer, CapsuleBoxAndTheirMeshesCoverTheSamePixels) {
  const cv::Size size(500, 500);
  for (int i = 0; i < 3; ++i) {
    const ObjectModel object = Objects()[i % 2];
    const double half_length = i == 2 ? 0.02 : 0;  // of the capsule, a sphere pulled along z
    Body exact;
    exact.X_WB.linear() = FromRotationVector({0.4, -0.8, 0.3}).toRotationMatrix();
    exact.colour = exact.second_colour = kBlue;
    Body meshed = exact;
    meshed.kind = Body::Kind::kMesh;
    meshed.mesh = MeshOf(object);
    for (Vector3d& v : meshed.mesh.vertices_O)
      if (std::abs(v.z()) > 1e-9) v.z() += std::copysign(half_length, v.z());
    exact.radius = object.radius;
    exact.b_B = {0, 0, half_length};
    exact.a_B = -exact.b_B;
    if (object.kind == ObjectModel::Kind::kBox) {
      exact.kind = Body::Kind::kBox;
      exact.half_extents = object.half_extents;
    }
    const Camera camera = FitCamera({&exact, 1}, {1, -1, 0.5}, Vector3d::UnitZ(), size, 60);
    const cv::Mat a = Render({&exact, 1}, camera, size), b = Render({&meshed, 1}, camera, size);
    cv::Mat ga, gb;
    cv::extractChannel(a, ga, 2);
    cv::extractChannel(b, gb, 2);
    const int covered = cv::countNonZero(ga != 255),
              differ = cv::countNonZero((ga != 255) != (gb != 255));
    // Chords of 5 degrees lie up to 0.1 % of the radius inside the sphere: a rim of under 1 px.
    EXPECT_LT(differ, 0.01 * covered);
    EXPECT_GT(covered, 10000);
  }
}

}  // namespace
}  // namespace regrasp
