#include "core/hand/hand_shapes.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <system_error>

#include "core/hand/mesh_path.h"
#include "core/hand/mesh_units.h"
#include "core/hand/primitive_mesh.h"
#include "core/hand/shape_fit.h"
#include "core/hand/urdf_values.h"

namespace regrasp {
namespace {

namespace fs = std::filesystem;

constexpr double kLargestLink = 1;    // [m]; what is larger, or farther off, has another unit
constexpr double kLargestStand = 10;  // ... of what the hand stands on

/// The longest side of a shape that is no mesh.
double Size(const UrdfGeometry& geometry) {
  switch (geometry.kind) {
    case UrdfGeometry::Kind::kSphere:
      return 2 * geometry.radius;
    case UrdfGeometry::Kind::kCylinder:
      return std::max(2 * geometry.radius, geometry.length);
    case UrdfGeometry::Kind::kBox:
      return geometry.size.maxCoeff();
    case UrdfGeometry::Kind::kMesh:
      break;
  }
  return 0;
}

void Pose(const Isometry3d& X, Shape* shape) {
  shape->a_L = X * shape->a_L;
  shape->b_L = X * shape->b_L;
  shape->X_LB = X * shape->X_LB;
}

/// Of a link that has boxes only, the one farthest from its joint; null of any other.
const UrdfCollision* FarthestIfBoxes(const UrdfLink& in) {
  const UrdfCollision* farthest = nullptr;
  for (const UrdfCollision& c : in.collisions) {
    if (c.geometry.kind != UrdfGeometry::Kind::kBox) return nullptr;
    if (farthest == nullptr || c.X_LG.translation().norm() > farthest->X_LG.translation().norm())
      farthest = &c;
  }
  return farthest;
}

double HalfWidth(const Shape& shape) {
  return shape.kind == Shape::Kind::kBox ? shape.half_extents.minCoeff() : shape.radius;
}

bool IsFile(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

}  // namespace

std::vector<Shape> HandShapes::Read(const UrdfLink& in, const Isometry3d& X_LG, LinkRole role) {
  std::vector<Shape> shapes;
  const bool fingertip = role == LinkRole::kFingertip;
  const UrdfCollision* tip_box = fingertip ? FarthestIfBoxes(in) : nullptr;
  for (const UrdfCollision& collision : in.collisions) {
    const Isometry3d X = X_LG * collision.X_LG;
    const UrdfGeometry& geometry = collision.geometry;
    if (!CheckSize(in, collision, role == LinkRole::kStand ? kLargestStand : kLargestLink))
      continue;
    Shape shape;
    switch (geometry.kind) {
      case UrdfGeometry::Kind::kSphere:
        shape.radius = geometry.radius;
        shape.a_L = shape.b_L = X.translation();
        break;
      case UrdfGeometry::Kind::kCylinder:
        if (geometry.length < geometry.radius) {  // round ends would make it a ball
          TriangleMesh disc = CylinderMesh(geometry.radius, geometry.length / 2);
          for (Vector3d& v : disc.vertices) v = X * v;
          shape = Fitted(in, geometry, disc, "<cylinder>", fingertip);
          break;
        }
        shape.radius = geometry.radius;
        shape.a_L = X * Vector3d(0, 0, -geometry.length / 2);
        shape.b_L = X * Vector3d(0, 0, geometry.length / 2);
        break;
      case UrdfGeometry::Kind::kBox:
        if (&collision == tip_box) {
          TriangleMesh box = BoxMesh(geometry.size);
          for (Vector3d& v : box.vertices) v = X * v;
          shape = Fitted(in, geometry, box, "<box>", true);
          break;
        }
        shape.kind = Shape::Kind::kBox;
        shape.X_LB = X;
        shape.half_extents = geometry.size / 2;
        break;
      case UrdfGeometry::Kind::kMesh:
        if (const auto fitted = OfMesh(in, geometry, X, role)) shapes.push_back(*fitted);
        continue;
    }
    shapes.push_back(shape);
  }
  for (const Shape& shape : shapes) {
    double& half_width = half_widths_[in.name];
    half_width = std::max(half_width, HalfWidth(shape));
  }
  return shapes;
}

bool HandShapes::CheckSize(const UrdfLink& in, const UrdfCollision& collision, double most) {
  const auto add = [&](const char* what, double length) {
    problems_->Add(collision.geometry.line,
                   "{}: <collision> {} {:.4g} m; allowed are at most {:g} m; lengths are in metres",
                   LinkElement(in.name), what, length, most);
    return false;
  };
  if (const double size = Size(collision.geometry); size > most)
    return add("has a length of", size);
  const double off = collision.X_LG.translation().norm();
  return off <= most || add("lies off its link by", off);
}

fs::path HandShapes::Find(const UrdfLink& in, const UrdfGeometry& geometry) {
  if (IsFile(geometry.mesh)) return geometry.mesh;
  fs::path beside;
  std::error_code ignored;
  std::set<fs::path> directories;
  for (const auto& entry :
       fs::directory_iterator(geometry.mesh.parent_path().parent_path(), ignored))
    directories.insert(entry.path());
  for (const fs::path& directory : directories)
    if (beside.empty() && IsFile(directory / geometry.mesh.filename()))
      beside = directory / geometry.mesh.filename();
  if (beside.empty()) beside = OtherCase(geometry.mesh);
  if (!options_.fill_missing_meshes) {
    problems_->Add(geometry.line,
                   "{}: <mesh> filename = {}: file not found{}; --fill-missing-meshes takes {}",
                   LinkElement(in.name), QuotedPath(geometry.mesh_name),
                   beside.empty() ? WherePackagesAre(geometry.mesh_name)
                                  : ", but " + beside.lexically_normal().string() + " is there",
                   beside.empty() ? "a capsule along the link" : "that");
    return {};
  }
  if (!beside.empty())
    problems_->Warn(
        geometry.line, LinkElement(in.name),
        fmt::format("<mesh> filename = {}: not found; {} in its place",
                    QuotedPath(geometry.mesh_name), beside.lexically_normal().string()));
  return beside;
}

const UrdfLink* HandShapes::Before(const UrdfLink& in) const {
  const UrdfLink* link = &in;
  while (link->parent_joint >= 0) {
    const auto joint = static_cast<std::size_t>(link->parent_joint);
    link = &file_.links[static_cast<std::size_t>(file_.joints[joint].parent)];
    if (link->parent_joint >= 0 && half_widths_.contains(link->name)) return link;
  }
  return nullptr;
}

Shape HandShapes::Filled(const UrdfLink& in, const UrdfGeometry& geometry) {
  Vector3d end = Vector3d::Zero();
  for (const int j : in.child_joints) {
    const Vector3d p = file_.joints[static_cast<std::size_t>(j)].X_PJ.translation();
    if (p.norm() > end.norm()) end = p;
  }
  // Links of hands are some 3.5 times as long as they are thick.
  constexpr double kSlender = 0.28, kLeast = 4e-3, kMost = 12e-3;
  const UrdfLink* before = end.isZero() ? Before(in) : nullptr;
  Shape shape;
  shape.radius =
      std::clamp(before ? half_widths_.at(before->name) : kSlender * end.norm(), kLeast, kMost);
  if (end.norm() > shape.radius) shape.b_L = end * (1 - shape.radius / end.norm());
  std::string taken = fmt::format("a ball of {:.3g} mm radius", 1e3 * shape.radius);
  if (shape.b_L != shape.a_L)
    taken = fmt::format("a capsule of {:.3g} mm radius and {:.3g} mm segment", 1e3 * shape.radius,
                        1e3 * shape.b_L.norm());
  if (before) taken += ", about as thick as " + LinkElement(before->name) + ",";
  problems_->Warn(geometry.line, LinkElement(in.name),
                  fmt::format("<mesh> filename = {}: not found; {} in its place",
                              QuotedPath(geometry.mesh_name), taken));
  return shape;
}

const TriangleMesh* HandShapes::Mesh(const fs::path& file, const Vector3d& scale) {
  const std::string key =
      fmt::format("{} {} {} {}", file.string(), scale.x(), scale.y(), scale.z());
  const auto known = meshes_.find(key);
  if (known != meshes_.end()) return &known->second;
  return &meshes_.emplace(key, LoadMesh(file, scale)).first->second;
}

std::optional<Shape> HandShapes::OfMesh(const UrdfLink& in, const UrdfGeometry& geometry,
                                        const Isometry3d& X, LinkRole role) {
  const fs::path file = Find(in, geometry);
  if (file.empty()) {
    if (!options_.fill_missing_meshes) return {};
    Shape shape = Filled(in, geometry);
    // Along the link's own frame, not where the mesh would have been.
    Pose(X * in.collisions.front().X_LG.inverse(), &shape);
    return shape;
  }
  TriangleMesh posed;
  try {
    posed = *Mesh(file, geometry.scale);
    if (posed.unread_bytes > 0)
      problems_->Warn(geometry.line, LinkElement(in.name), UnreadBytes(file, posed));
    Eigen::AlignedBox3d box;
    for (Vector3d& v : posed.vertices) {
      v = X * v;
      box.extend(v);
    }
    const double most = role == LinkRole::kStand ? kLargestStand : kLargestLink;
    if (const double size = box.sizes().maxCoeff(); size > most)
      throw ModelError(fmt::format("{}: the mesh is {:.4g} m long; allowed are at most {:g} m{}",
                                   file.string(), size, most, UnitHint(size, 1e-3, most)));
    return Fitted(in, geometry, posed, file.string(), role == LinkRole::kFingertip);
  } catch (const ModelError& error) {
    problems_->Add(geometry.line, "{}: {}", LinkElement(in.name), error.what());
    return {};
  }
}

Shape HandShapes::Fitted(const UrdfLink& in, const UrdfGeometry& geometry,
                         const TriangleMesh& posed, const std::string& name, bool fingertip) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& v : posed.vertices) box.extend(v);
  const Vector3d middle = box.center();
  const Vector3d toward = middle.norm() > 1e-3 ? Vector3d(middle.normalized()) : Vector3d::UnitZ();
  const FittedShape fit = fingertip ? FitFingertip(posed, toward) : FitShape(posed);
  if (report_)
    report_->fits.push_back({in.name, name, fit.kind, fit.error_m, fit.rms_m, fingertip});
  const std::string what = name.starts_with('<') ? name.substr(1, name.size() - 2) : "mesh";
  if (fingertip && fit.error_m > kGoodFit)
    problems_->Warn(
        geometry.line, LinkElement(in.name),
        fmt::format("the fingertip's {} differs from its {} by up to {:.2g} mm (rms {:.2g} mm); "
                    "within 1 mm contacts would be those of the {}{}",
                    fit.kind, what, 1e3 * fit.error_m, 1e3 * fit.rms_m, what,
                    fit.within ? fmt::format("; no round end meets it, so it is one within it, of "
                                             "{:.3g} mm radius",
                                             1e3 * fit.shape.radius)
                               : ""));
  return fit.shape;
}

}  // namespace regrasp
