#include "core/hand/object_loader.h"

#include <algorithm>
#include <string>
#include <vector>

#include "core/hand/mesh.h"
#include "core/hand/solid.h"
#include "core/hand/urdf_file.h"

namespace regrasp {
namespace {

TriangleMesh BoxMesh(const Vector3d& size) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back(
        size.cwiseProduct(Vector3d((i & 1) - 0.5, ((i >> 1) & 1) - 0.5, ((i >> 2) & 1) - 0.5)));
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

class ObjectReader {
 public:
  ObjectReader(const std::filesystem::path& path, const LoadOptions& options, ModelReport* report)
      : problems_(path.string()),
        file_(ReadUrdf(path, &problems_)),
        options_(options),
        report_(report) {}

  ObjectModel Read() {
    problems_.ThrowIfAny();
    const UrdfLink& root = file_.links[static_cast<std::size_t>(file_.root)];
    element_ = LinkElement(root.name);
    collisions_ = root.collisions;
    if (file_.links.size() > 1)
      problems_.Add(file_.links[1].line, "an object has exactly one link; this file has {}",
                    file_.links.size());
    if (!root.inertial)
      problems_.Add(root.line, "{}: has no <inertial>", element_);
    else if (!(root.inertial->mass > 0))
      problems_.Add(root.inertial->line, "{}: <mass> = {:.6g}; must be > 0", element_,
                    root.inertial->mass);
    if (collisions_.empty())
      problems_.Add(root.line, "{}: has no <collision>; an object has at least one", element_);
    problems_.ThrowIfAny();
    inertial_ = *root.inertial;
    object_.name = file_.name;
    ReadShape();
    problems_.ThrowIfAny();
    ReadBody();
    problems_.ThrowIfAny();
    return std::move(object_);
  }

 private:
  /// The shape in the link's frame; meshes and boxes become one mesh where they must.
  void ReadShape() {
    using Kind = UrdfGeometry::Kind;
    const UrdfCollision& first = collisions_.front();
    const UrdfGeometry& geometry = first.geometry;
    if (collisions_.size() > 1) return ReadPieces();
    Isometry3d X = first.X_LG;
    // A homogeneous body has its centre of mass in its middle.
    X.pretranslate(options_.inertia_from_shape ? Vector3d(-X.translation()) : Vector3d(-PCom()));
    const bool centred = X.isApprox(Isometry3d::Identity(), 1e-9);
    if (geometry.kind == Kind::kMesh || (geometry.kind == Kind::kBox && !centred))
      return ReadPieces();
    if (!centred) {
      problems_.Add(first.line,
                    "{}: a sphere or cylinder must have its <collision> <origin> at the centre of "
                    "mass, unrotated",
                    element_);
      return;
    }
    if (geometry.kind == Kind::kSphere) {
      object_.kind = ObjectModel::Kind::kSphere;
      object_.radius = object_.bounding_radius = geometry.radius;
    } else if (geometry.kind == Kind::kBox) {
      object_.kind = ObjectModel::Kind::kBox;
      object_.half_extents = geometry.size / 2;
      object_.bounding_radius = object_.half_extents.norm();
    } else {
      object_.kind = ObjectModel::Kind::kCapsule;
      object_.radius = geometry.radius;
      object_.half_length = geometry.length / 2;
      object_.bounding_radius = object_.half_length + object_.radius;
    }
    CheckSize();
  }

  void ReadPieces() {
    object_.kind = ObjectModel::Kind::kMesh;
    for (const UrdfCollision& piece : collisions_) {
      const UrdfGeometry& geometry = piece.geometry;
      TriangleMesh mesh;
      if (geometry.kind == UrdfGeometry::Kind::kMesh) {
        try {
          mesh = LoadClosedMesh(geometry.mesh, geometry.scale);
        } catch (const ModelError& error) {
          problems_.Add(geometry.line, "{}: {}", element_, error.what());
          continue;
        }
      } else if (geometry.kind == UrdfGeometry::Kind::kBox) {
        mesh = BoxMesh(geometry.size);
      } else {
        problems_.Add(geometry.line,
                      "{}: a sphere or cylinder beside other <collision> elements; allowed are "
                      "meshes and boxes",
                      element_);
        continue;
      }
      const int base = static_cast<int>(object_.vertices_O.size());
      for (const Vector3d& v : mesh.vertices) object_.vertices_O.push_back(piece.X_LG * v);
      for (const auto& t : mesh.triangles)
        object_.triangles.push_back(t + Eigen::Vector3i::Constant(base));
    }
    problems_.ThrowIfAny();
    constexpr std::size_t kMaxVertices = 200000;
    if (object_.vertices_O.size() > kMaxVertices)
      problems_.Add(0, "the pieces have {} vertices; allowed are at most {}",
                    object_.vertices_O.size(), kMaxVertices);
    const Vector3d p_com = options_.inertia_from_shape
                               ? MeshSolid({object_.vertices_O, object_.triangles}).centre
                               : PCom();
    object_.bounding_radius = 0;
    for (Vector3d& v : object_.vertices_O) {
      v -= p_com;
      object_.bounding_radius = std::max(object_.bounding_radius, v.norm());
    }
    CheckSize();
  }

  void CheckSize() {
    const double radius = object_.bounding_radius;
    constexpr double kMin = 1e-3, kMax = 1;
    if (radius >= kMin && radius <= kMax) return;
    const bool millimetres = radius > kMax && radius / 1000 >= kMin && radius / 1000 <= kMax;
    const char* fix = !millimetres ? ""
                      : object_.kind == ObjectModel::Kind::kMesh
                          ? "; if the file is in millimetres: <mesh scale=\"0.001 0.001 0.001\">"
                          : "; lengths are in metres";
    problems_.Add(collisions_.front().geometry.line,
                  "{}: bounding radius [m] = {:.6g}; allowed {:g} .. {:g}{}", element_, radius,
                  kMin, kMax, fix);
  }

  void ReadBody() {
    const Matrix3d R = inertial_.X_LI.linear();
    object_.mass = inertial_.mass;
    object_.I_OCom = R * inertial_.inertia * R.transpose();
    if (options_.inertia_from_shape) {
      const Solid solid = ObjectSolid(object_);
      object_.I_OCom = solid.inertia * (object_.mass / solid.volume);
    }
    const int line = inertial_.inertia_line;
    if (const std::string why = WhyNoInertia(object_.I_OCom); !why.empty()) {
      problems_.Add(line, "{}: {}; --inertia-from-shape computes it", element_, why);
      return;
    }
    for (const Impossible& reason : WhyNoBody(object_)) {
      if (options_.force && report_)
        report_->warnings.push_back(
            {problems_.file(), line, element_, reason.why + "; taken because of --force"});
      if (!options_.force)
        problems_.Add(
            line, "{}: {}; {}--force takes it as it is", element_, reason.why,
            reason.changed_by_shape ? "--inertia-from-shape computes centre and inertia, " : "");
    }
  }

  Vector3d PCom() const { return inertial_.X_LI.translation(); }

  Problems problems_;
  UrdfFile file_;
  const LoadOptions& options_;
  ModelReport* report_;
  std::string element_;
  std::vector<UrdfCollision> collisions_;
  UrdfInertial inertial_;
  ObjectModel object_;
};

}  // namespace

ObjectModel LoadObjectUrdf(const std::filesystem::path& urdf_file, const LoadOptions& options,
                           ModelReport* report) {
  return ObjectReader(urdf_file, options, report).Read();
}

}  // namespace regrasp
