#include "core/hand/object_loader.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <system_error>
#include <vector>

#include "core/hand/object_pieces.h"
#include "core/hand/rigid_body.h"
#include "core/hand/solid.h"
#include "core/hand/toml_file.h"
#include "core/hand/urdf_file.h"

namespace regrasp {
namespace {

class ObjectReader {
 public:
  ObjectReader(const std::filesystem::path& path, const LoadOptions& options, ModelReport* report,
               ObjectFacts* facts, const Matrix3d& R_OL)
      : problems_(path.string(), report),
        file_(ReadUrdf(path, &problems_)),
        options_(options),
        facts_out_(facts),
        R_OL_(R_OL) {}

  ObjectModel Read() {
    problems_.ThrowIfAny();
    const UrdfLink body = OneBody(file_, &problems_);
    element_ = LinkElement(body.name);
    collisions_ = body.collisions;
    Isometry3d X_OL = Isometry3d::Identity();
    X_OL.linear() = R_OL_;
    for (UrdfCollision& collision : collisions_) collision.X_LG = X_OL * collision.X_LG;
    if (!body.inertial)
      problems_.Add(body.line, "{}: has no <inertial>", element_);
    else if (!(body.inertial->mass > 0))
      problems_.Add(body.inertial->line, "{}: <mass> = {:.6g}; must be > 0", element_,
                    body.inertial->mass);
    if (collisions_.empty())
      problems_.Add(body.line, "{}: has no <collision>; an object has at least one", element_);
    problems_.ThrowIfAny();
    inertial_ = *body.inertial;
    inertial_.X_LI = X_OL * inertial_.X_LI;
    object_.name = file_.name;
    ReadShape();
    problems_.ThrowIfAny();
    ReadBody();
    problems_.ThrowIfAny();
    facts_.p_LCom = R_OL_.transpose() * facts_.p_LCom;
    if (facts_out_ != nullptr) *facts_out_ = facts_;
    return std::move(object_);
  }

 private:
  /// The shape, about the centre of mass.
  void ReadShape() {
    using Kind = UrdfGeometry::Kind;
    const UrdfCollision& first = collisions_.front();
    const UrdfGeometry& geometry = first.geometry;
    facts_.collisions = static_cast<int>(collisions_.size());
    facts_.pieces = 1;
    // A homogeneous body has its centre of mass in its middle.
    facts_.p_LCom = options_.inertia_from_shape ? first.X_LG.translation() : PCom();
    const Matrix3d& R = first.X_LG.linear();
    const bool whole =
        geometry.kind == Kind::kSphere || (geometry.kind == Kind::kBox && R.isIdentity(1e-9));
    if (collisions_.size() > 1 || !whole ||
        (first.X_LG.translation() - facts_.p_LCom).norm() > 1e-9)
      return ReadPieces();
    if (geometry.kind == Kind::kSphere) {
      object_.kind = ObjectModel::Kind::kSphere;
      object_.radius = object_.bounding_radius = geometry.radius;
    } else {
      object_.kind = ObjectModel::Kind::kBox;
      object_.half_extents = geometry.size / 2;
      object_.bounding_radius = object_.half_extents.norm();
    }
    CheckSize();
  }

  void ReadPieces() {
    object_.kind = ObjectModel::Kind::kMesh;
    TriangleMesh mesh = JoinPieces(collisions_, element_, &problems_);
    problems_.ThrowIfAny();
    const Solid solid = PiecesSolid(mesh, &facts_.overlap_m3);
    facts_.p_LCom = options_.inertia_from_shape ? solid.centre : PCom();
    facts_.pieces = static_cast<int>(PiecesOf(mesh).size());
    object_.vertices_O = std::move(mesh.vertices);
    object_.triangles = std::move(mesh.triangles);
    object_.bounding_radius = 0;
    for (Vector3d& v : object_.vertices_O) {
      v -= facts_.p_LCom;
      object_.bounding_radius = std::max(object_.bounding_radius, v.norm());
    }
    CheckSize();
  }

  void CheckSize() {
    const double radius = object_.bounding_radius;
    constexpr double kMin = 1e-3, kMax = 1;
    if (radius >= kMin && radius <= kMax) return;
    constexpr double kSmall = 5e-3;  // in a hand: smaller in millimetres means centimetres
    const bool centimetres = radius > kMax && radius / 1000 < kSmall && radius / 100 <= kMax;
    const bool millimetres = radius > kMax && radius / 1000 >= kMin && radius / 1000 <= kMax;
    const char* fix =
        !millimetres && !centimetres ? ""
        : object_.kind == ObjectModel::Kind::kMesh
            ? centimetres ? "; if the file is in centimetres: <mesh scale=\"0.01 0.01 0.01\">"
                          : "; if the file is in millimetres: <mesh scale=\"0.001 0.001 0.001\">"
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
      if (options_.force)
        problems_.Warn(line, element_, reason.why + "; taken because of --force");
      else
        problems_.Add(
            line, "{}: {}; {}--force takes it as it is", element_, reason.why,
            reason.changed_by_shape ? "--inertia-from-shape computes centre and inertia, " : "");
    }
  }

  Vector3d PCom() const { return inertial_.X_LI.translation(); }

  Problems problems_;
  UrdfFile file_;
  const LoadOptions& options_;
  ObjectFacts* facts_out_;
  ObjectFacts facts_;
  Matrix3d R_OL_;
  std::string element_;
  std::vector<UrdfCollision> collisions_;
  UrdfInertial inertial_;
  ObjectModel object_;
};

}  // namespace

ObjectModel LoadObjectUrdf(const std::filesystem::path& urdf_file, const LoadOptions& options,
                           ModelReport* report, ObjectFacts* facts, const Matrix3d& R_OL) {
  return ObjectReader(urdf_file, options, report, facts, R_OL).Read();
}

ObjectModel LoadObjectFile(const std::filesystem::path& urdf_file, LoadOptions options,
                           ModelReport* report, ObjectFacts* facts) {
  std::filesystem::path toml_file = urdf_file;
  toml_file.replace_extension(".toml");
  std::error_code ignored;
  double friction = ObjectModel().friction;
  Matrix3d R_OL = Matrix3d::Identity();
  if (std::filesystem::is_regular_file(toml_file, ignored)) {
    const TomlFile file(toml_file);
    file.CheckKeys(file.root(), {"friction", "rotation_deg", "inertia_from_shape", "force"});
    if (const toml::node* node = file.root().get("friction"))
      friction = file.Number(*node, "friction", 1e-3, 1);
    if (file.root().contains("rotation_deg"))
      R_OL = FromRotationVector(file.Vector(file.root(), "rotation_deg", 360) * M_PI / 180)
                 .toRotationMatrix();
    options.inertia_from_shape |= file.Flag(file.root(), "inertia_from_shape");
    options.force |= file.Flag(file.root(), "force");
    file.ThrowIfAny();
  }
  ObjectModel model = LoadObjectUrdf(urdf_file, options, report, facts, R_OL);
  model.name = urdf_file.stem().string();
  model.friction = friction;
  return model;
}

}  // namespace regrasp
