#include "snapshots/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "core/common/box_corners.h"
#include "snapshots/mesh_normals.h"

namespace regrasp {
namespace {

using Vector3f = Eigen::Vector3f;

constexpr double kViewDistance = 0.7;   // of the camera from the middle of the bodies [m]
constexpr double kBehind = 0.03;        // the white ground counts as this far behind the scene [m]
constexpr float kDeepestShadow = 0.5F;  // part of the light that the deepest shadow takes
constexpr float kShadowDepth = 0.02F;   // depth behind the surroundings that takes half of that [m]
constexpr double kContourDepth = 0.004;  // a step in depth that earns a contour [m]

/// Depth, body and surface normal (camera frame) per pixel.
struct Buffers {
  explicit Buffers(cv::Size size)
      : depth(size, std::numeric_limits<float>::infinity()), body(size, -1), normal(size) {}
  cv::Mat_<float> depth;
  cv::Mat_<std::int16_t> body;
  cv::Mat_<cv::Vec3f> normal;

  bool Hides(int x, int y, double z) const { return z < depth(y, x); }
  void Put(int x, int y, double z, int index, const Vector3d& n) {
    if (!Hides(x, y, z)) return;
    depth(y, x) = static_cast<float>(z);
    body(y, x) = static_cast<std::int16_t>(index);
    normal(y, x) =
        cv::Vec3f(static_cast<float>(n.x()), static_cast<float>(n.y()), static_cast<float>(n.z()));
  }
};

cv::Rect PixelBounds(const Camera& camera, const Vector3d& centre_C, double radius, cv::Size size) {
  const double near = std::max(1e-3, centre_C.z() - radius);
  const double reach = camera.focal_px * radius / near + 2;
  const double x = camera.centre_x_px + camera.focal_px * centre_C.x() / centre_C.z();
  const double y = camera.centre_y_px + camera.focal_px * centre_C.y() / centre_C.z();
  const double extra = camera.focal_px * radius * centre_C.head<2>().norm() / (near * centre_C.z());
  const double r = reach + extra;
  return cv::Rect(
             cv::Point(static_cast<int>(std::floor(x - r)), static_cast<int>(std::floor(y - r))),
             cv::Point(static_cast<int>(std::ceil(x + r)), static_cast<int>(std::ceil(y + r)))) &
         cv::Rect({0, 0}, size);
}

/// Nearest t > 0 at which the ray t d from the origin meets the sphere; negative when it does not.
double HitSphere(const Vector3d& d, const Vector3d& c, double r) {
  const double dd = d.squaredNorm(), dc = d.dot(c), h = dc * dc - dd * (c.squaredNorm() - r * r);
  return h < 0 ? -1 : (dc - std::sqrt(h)) / dd;
}

void DrawCapsule(const Body& body, int index, const Camera& camera, Buffers* out) {
  const Isometry3d X_CB = camera.X_CW * body.X_WB;
  const Vector3d a = X_CB * body.a_B, b = X_CB * body.b_B;
  const double length = (b - a).norm(), r = body.radius;
  const bool round = length < 1e-6;  // a sphere
  const Vector3d e = round ? Vector3d(Vector3d::Zero()) : Vector3d((b - a) / length);
  const double ae = a.dot(e), C = a.squaredNorm() - r * r - ae * ae;
  const cv::Size size = out->depth.size();
  const cv::Rect box = PixelBounds(camera, a, r, size) | PixelBounds(camera, b, r, size);
  for (int y = box.y; y < box.br().y; ++y) {
    const double dy = (y - camera.centre_y_px) / camera.focal_px;
    const double dd_row = dy * dy + 1, de_row = dy * e.y() + e.z(), da_row = dy * a.y() + a.z();
    for (int x = box.x; x < box.br().x; ++x) {
      // The ray t d, d = (dx, dy, 1), meets the infinite cylinder, |(t d - a) x e|² = r², or the
      // sphere, where A t² - 2 B t + C = 0.
      const double dx = (x - camera.centre_x_px) / camera.focal_px;
      const double de = dx * e.x() + de_row;
      const double A = dx * dx + dd_row - de * de, B = dx * a.x() + da_row - de * ae;
      const double h = B * B - A * C;
      if (h < 0) continue;
      const Vector3d d(dx, dy, 1);
      double t = (B - std::sqrt(h)) / A, along = t * de - ae;
      if (!round && (along < 0 || along > length)) {
        const double ta = HitSphere(d, a, r), tb = HitSphere(d, b, r);
        t = ta > 0 && (tb <= 0 || ta < tb) ? ta : tb;
        along = t == ta ? 0 : length;
      }
      if (t > 0 && out->Hides(x, y, t)) out->Put(x, y, t, index, (d * t - a - e * along) / r);
    }
  }
}

/// The pixels that points in front of the camera span.
cv::Rect PixelBounds(const Camera& camera, std::span<const Vector3d> p_W, cv::Size size) {
  cv::Rect_<double> all(camera.Project(p_W.front()), cv::Size2d());
  for (const Vector3d& p : p_W) {
    const cv::Point2d q = camera.Project(p);
    all |= cv::Rect_<double>(q - cv::Point2d(1, 1), cv::Size2d(2, 2));
  }
  return cv::Rect(cv::Point(cvFloor(all.x), cvFloor(all.y)),
                  cv::Point(cvCeil(all.br().x), cvCeil(all.br().y))) &
         cv::Rect({0, 0}, size);
}

std::array<Vector3d, 8> CornersOf(const Body& box) {
  std::array<Vector3d, 8> corners = BoxCorners(box.half_extents);
  for (Vector3d& corner : corners) corner = box.X_WB * corner;
  return corners;
}

void DrawBox(const Body& body, int index, const Camera& camera, Buffers* out) {
  const Isometry3d X_CB = camera.X_CW * body.X_WB, X_BC = X_CB.inverse();
  const Vector3d eye = X_BC.translation();
  const cv::Rect box = PixelBounds(camera, CornersOf(body), out->depth.size());
  for (int y = box.y; y < box.br().y; ++y) {
    const double dy = (y - camera.centre_y_px) / camera.focal_px;
    const Vector3d d_row = X_BC.linear() * Vector3d(0, dy, 1);
    for (int x = box.x; x < box.br().x; ++x) {
      const Vector3d d =
          d_row + X_BC.linear().col(0) * ((x - camera.centre_x_px) / camera.focal_px);
      double enter = -1e30, leave = 1e30;
      int side = 0;
      for (int k = 0; k < 3; ++k) {
        const double inverse = 1 / (std::abs(d[k]) < 1e-12 ? std::copysign(1e-12, d[k]) : d[k]);
        const double middle = -eye[k] * inverse, reach = std::abs(body.half_extents[k] * inverse);
        if (middle - reach > enter) enter = middle - reach, side = k;
        leave = std::min(leave, middle + reach);
      }
      if (enter <= 0 || enter > leave) continue;
      out->Put(x, y, enter, index, X_CB.linear().col(side) * (d[side] > 0 ? -1 : 1));
    }
  }
}

void DrawMesh(const Body& body, int index, const Camera& camera, Buffers* out) {
  const Isometry3d X_CB = camera.X_CW * body.X_WB;
  const auto& triangles = body.mesh.triangles;
  std::vector<Vector3d> p;
  for (const Vector3d& v : body.mesh.vertices_O) p.push_back(X_CB * v);
  const auto normals = CornerNormals(p, triangles);
  const auto pixel = [&](const Vector3d& v) {
    return cv::Point2d(camera.centre_x_px + camera.focal_px * v.x() / v.z(),
                       camera.centre_y_px + camera.focal_px * v.y() / v.z());
  };
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto& t = triangles[i];
    const std::array<Vector3d, 3> v = {p[t[0]], p[t[1]], p[t[2]]};
    const Vector3d face = (v[1] - v[0]).cross(v[2] - v[0]).normalized();
    if (face.dot(v[0]) >= 0) continue;  // faces away
    const std::array<cv::Point2d, 3> q = {pixel(v[0]), pixel(v[1]), pixel(v[2])};
    const double area = (q[1] - q[0]).cross(q[2] - q[0]);
    if (std::abs(area) < 1e-9) continue;
    const auto [x0, x1] = std::minmax({q[0].x, q[1].x, q[2].x});
    const auto [y0, y1] = std::minmax({q[0].y, q[1].y, q[2].y});
    for (int y = std::max(0, static_cast<int>(std::ceil(y0)));
         y <= std::min<double>(out->depth.rows - 1, y1); ++y)
      for (int x = std::max(0, static_cast<int>(std::ceil(x0)));
           x <= std::min<double>(out->depth.cols - 1, x1); ++x) {
        const cv::Point2d s(x, y);
        const double w0 = (q[1] - s).cross(q[2] - s) / area, w1 = (q[2] - s).cross(q[0] - s) / area;
        const double w2 = 1 - w0 - w1;
        if (w0 < -1e-9 || w1 < -1e-9 || w2 < -1e-9) continue;
        const double z = 1 / (w0 / v[0].z() + w1 / v[1].z() + w2 / v[2].z());
        const auto& n = normals[i];
        out->Put(x, y, z, index, (w0 * n[0] + w1 * n[1] + w2 * n[2]).normalized());
      }
  }
}

/// The depth of each pixel's surroundings [m]: what lies behind it is in the shadow of what is
/// nearer. The blur is wide, so that a quarter of the resolution is enough.
cv::Mat_<float> Surroundings(const cv::Mat_<float>& depth, double far, double radius_px) {
  constexpr int kShrink = 4;
  cv::Mat_<float> small(depth.rows / kShrink + 1, depth.cols / kShrink + 1), blurred;
  for (int y = 0; y < small.rows; ++y)
    for (int x = 0; x < small.cols; ++x) {
      const float z =
          depth(std::min(depth.rows - 1, y * kShrink), std::min(depth.cols - 1, x * kShrink));
      small(y, x) = std::isinf(z) ? static_cast<float>(far) : z;
    }
  cv::GaussianBlur(small, small, {}, std::max(0.8, radius_px / kShrink));
  cv::resize(small, blurred, {small.cols * kShrink, small.rows * kShrink}, 0, 0, cv::INTER_LINEAR);
  return blurred;
}

float Power28(float v) {
  const float v4 = (v * v) * (v * v), v8 = v4 * v4;
  return v4 * v8 * v8 * v8;
}

}  // namespace

std::pair<Vector3d, double> Body::BoundingSphere() const {
  switch (kind) {
    case Kind::kCapsule:
      return {X_WB * (0.5 * (a_B + b_B)), 0.5 * (a_B - b_B).norm() + radius};
    case Kind::kBox:
      return {X_WB.translation(), half_extents.norm()};
    case Kind::kMesh:
      break;
  }
  double r = 0;
  for (const Vector3d& v : mesh.vertices_O) r = std::max(r, v.norm());
  return {X_WB.translation(), r};
}

Camera FitCamera(std::span<const Body> bodies, const Vector3d& to_viewer_W, const Vector3d& up_W,
                 cv::Size size, double margin) {
  Eigen::AlignedBox3d all;
  for (const Body& body : bodies) all.extend(body.BoundingSphere().first);
  const Vector3d middle = bodies.empty() ? Vector3d::Zero() : Vector3d(all.center());
  const Vector3d z = -to_viewer_W.normalized(), x = z.cross(up_W).normalized();
  Matrix3d R_CW;
  R_CW << x.transpose(), z.cross(x).transpose(), z.transpose();
  Camera camera;
  camera.X_CW.linear() = R_CW;
  camera.X_CW.translation() = -R_CW * (middle + to_viewer_W.normalized() * kViewDistance);
  camera.focal_px = 1;

  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
  const auto include = [&](const Vector3d& p_W, double radius) {
    const cv::Point2d q = camera.Project(p_W);
    const double r = radius / camera.Depth(p_W);
    left = std::min(left, q.x - r), right = std::max(right, q.x + r);
    top = std::min(top, q.y - r), bottom = std::max(bottom, q.y + r);
  };
  for (const Body& body : bodies) {
    if (body.kind == Body::Kind::kCapsule) {
      include(body.X_WB * body.a_B, body.radius);
      include(body.X_WB * body.b_B, body.radius);
    } else if (body.kind == Body::Kind::kBox) {
      for (const Vector3d& corner : CornersOf(body)) include(corner, 0);
    } else {
      const auto [centre, radius] = body.BoundingSphere();
      include(centre, radius);
    }
  }
  camera.focal_px = std::min((size.width - 2 * margin) / (right - left),
                             (size.height - 2 * margin) / (bottom - top));
  camera.centre_x_px = size.width / 2.0 - camera.focal_px * (left + right) / 2;
  camera.centre_y_px = size.height / 2.0 - camera.focal_px * (top + bottom) / 2;
  return camera;
}

cv::Mat Render(std::span<const Body> bodies, const Camera& camera, cv::Size size) {
  Buffers buffers(size);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const int index = static_cast<int>(i);
    switch (bodies[i].kind) {
      case Body::Kind::kCapsule:
        DrawCapsule(bodies[i], index, camera, &buffers);
        break;
      case Body::Kind::kBox:
        DrawBox(bodies[i], index, camera, &buffers);
        break;
      case Body::Kind::kMesh:
        DrawMesh(bodies[i], index, camera, &buffers);
        break;
    }
  }
  double far = 0;
  for (const Body& body : bodies) {
    const auto [centre, radius] = body.BoundingSphere();
    far = std::max(far, camera.Depth(centre) + radius);
  }
  const double unit = camera.focal_px / kViewDistance * 1e-3;  // pixels per mm, about
  const cv::Mat_<float> around = Surroundings(buffers.depth, far + kBehind, 5 * unit);

  const Vector3f key =
      Vector3f(-0.45F, -0.75F, -0.75F).normalized();  // towards the light, camera frame
  const Vector3f half_way = (key - Vector3f::UnitZ()).normalized();
  std::vector<Isometry3d> X_BC;
  for (const Body& body : bodies) X_BC.push_back((camera.X_CW * body.X_WB).inverse());
  cv::Mat picture(size, CV_8UC3);
  std::memset(picture.data, 255, picture.total() * picture.elemSize());
  for (int y = 0; y < size.height; ++y) {
    const std::int16_t* shown = buffers.body[y];
    const float *depth = buffers.depth[y], *depth_around = around[y];
    const cv::Vec3f* normal = buffers.normal[y];
    auto* pixel = picture.ptr<cv::Vec3b>(y);
    for (int x = 0; x < size.width; ++x) {
      if (shown[x] < 0) continue;
      const auto index = static_cast<std::size_t>(shown[x]);
      const Body& body = bodies[index];
      const Vector3f n(normal[x][0], normal[x][1], normal[x][2]);
      Colour base = body.colour;
      if (!(body.second_colour == body.colour)) {
        const double z = depth[x];
        const Vector3d p_B =
            X_BC[index] * Vector3d((x - camera.centre_x_px) / camera.focal_px * z,
                                   (y - camera.centre_y_px) / camera.focal_px * z, z);
        if (p_B.x() * p_B.y() * p_B.z() > 0) base = body.second_colour;
      }
      const float diffuse = std::max(0.0F, n.dot(key)), sky = 0.5F - 0.5F * n.y();
      const float behind = std::max(0.0F, depth[x] - depth_around[x] - 0.001F);
      const float shadow = 1 - kDeepestShadow * behind / (behind + kShadowDepth);
      const float light = (0.52F + 0.16F * sky + 0.44F * diffuse) * shadow;
      const float shine = 34 * shadow * Power28(std::max(0.0F, n.dot(half_way)));
      const auto tone = [&](std::uint8_t c) {
        return static_cast<std::uint8_t>(std::min(c * light + shine, 255.0F));
      };
      pixel[x] = {tone(base.b), tone(base.g), tone(base.r)};
    }
  }

  std::vector<int> ids;
  for (const Body& body : bodies) ids.push_back(body.id);
  cv::Mat_<std::uint8_t> contour(size, 0);
  for (int y = 0; y + 1 < size.height; ++y) {
    const float *z = buffers.depth[y], *z_below = buffers.depth[y + 1];
    const std::int16_t *body = buffers.body[y], *body_below = buffers.body[y + 1];
    std::uint8_t* marked = contour[y];
    const auto step = [&](int one, float z1, int other, float z2) {
      if (one < 0 || other < 0) return one != other;
      return ids[one] != ids[other] || std::abs(z1 - z2) > kContourDepth;
    };
    for (int x = 0; x + 1 < size.width; ++x)
      if (step(body[x], z[x], body[x + 1], z[x + 1]) ||
          step(body[x], z[x], body_below[x], z_below[x]))
        marked[x] = 255;
  }
  const int width = std::max(1, static_cast<int>(std::lround(0.45 * unit)));
  cv::dilate(contour, contour, cv::getStructuringElement(cv::MORPH_ELLIPSE, {width, width}));
  cv::blur(contour, contour, {2, 2});
  for (int y = 0; y < size.height; ++y) {
    const std::uint8_t* dark = contour[y];
    auto* pixel = picture.ptr<cv::Vec3b>(y);
    for (int x = 0; x < size.width; ++x) {
      if (dark[x] == 0) continue;
      const int keep = 255 - dark[x] * 3 / 4;
      for (int k = 0; k < 3; ++k) pixel[x][k] = static_cast<std::uint8_t>(pixel[x][k] * keep / 255);
    }
  }
  return picture;
}

}  // namespace regrasp
