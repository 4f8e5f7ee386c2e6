#include "core/hand/object_loader.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "core/hand/link_body.h"
#include "core/hand/mesh.h"
#include "core/hand/primitive_mesh.h"
#include "core/hand/solid.h"
#include "core/hand/toml_file.h"
#include "core/hand/urdf_file.h"

namespace regrasp {
namespace {

/// Surfaces that share no corner.
int CountPieces(const ObjectModel& object) {
  std::vector<int> up(object.vertices_O.size());
  std::iota(up.begin(), up.end(), 0);
  const auto top = [&](int i) {
    while (up[static_cast<std::size_t>(i)] != i)
      i = up[static_cast<std::size_t>(i)] =
          up[static_cast<std::size_t>(up[static_cast<std::size_t>(i)])];
    return i;
  };
  for (const Eigen::Vector3i& t : object.triangles)
    for (int k = 1; k < 3; ++k) up[static_cast<std::size_t>(top(t[k]))] = top(t[0]);
  int pieces = 0;
  for (std::size_t i = 0; i < up.size(); ++i) pieces += up[i] == static_cast<int>(i);
  return pieces;
}

class ObjectReader {
 public:
  ObjectReader(const std::filesystem::path& path, const LoadOptions& options, ModelReport* report,
               ObjectFacts* facts, const Matrix3d& R_OL)
      : problems_(path.string()),
        file_(ReadUrdf(path, &problems_)),
        options_(options),
        report_(report),
        facts_out_(facts),
        R_OL_(R_OL) {}

  ObjectModel Read() {
    problems_.ThrowIfAny();
    const UrdfLink& root = file_.links[static_cast<std::size_t>(file_.root)];
    element_ = LinkElement(root.name);
    std::optional<UrdfInertial> inertial = root.inertial;
    collisions_ = root.collisions;
    if (file_.links.size() > 1) Merge(&inertial);
    Isometry3d X_OL = Isometry3d::Identity();
    X_OL.linear() = R_OL_;
    for (UrdfCollision& collision : collisions_) collision.X_LG = X_OL * collision.X_LG;
    if (!inertial)
      problems_.Add(root.line, "{}: has no <inertial>", element_);
    else if (!(inertial->mass > 0))
      problems_.Add(inertial->line, "{}: <mass> = {:.6g}; must be > 0", element_, inertial->mass);
    if (collisions_.empty())
      problems_.Add(root.line, "{}: has no <collision>; an object has at least one", element_);
    problems_.ThrowIfAny();
    for (const UrdfLink& link : file_.links)
      if (link.second_inertial_line > 0 && report_)
        report_->warnings.push_back({problems_.file(), link.second_inertial_line,
                                     LinkElement(link.name), "a second <inertial> is not read"});
    inertial_ = *inertial;
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
  /// Makes one body of links that are fixed to each other, in the frame of the first.
  void Merge(std::optional<UrdfInertial>* inertial) {
    for (const UrdfJoint& joint : file_.joints)
      if (joint.type != UrdfJoint::Type::kFixed)
        problems_.Add(joint.line, "{}: type \"{}\": an object is one rigid body; allowed is fixed",
                      JointElement(joint.name), joint.type_name.substr(0, 40));
    Link sum;
    std::optional<UrdfInertial> first;
    const auto add = [&](const auto& self, int l, const Isometry3d& X) -> void {
      const UrdfLink& link = file_.links[static_cast<std::size_t>(l)];
      if (l != file_.root)
        for (UrdfCollision collision : link.collisions) {
          collision.X_LG = X * collision.X_LG;
          collisions_.push_back(collision);
        }
      if (link.inertial && !(link.inertial->mass >= 0))
        problems_.Add(link.inertial->line, "{}: <mass> = {:.6g}; must be >= 0",
                      LinkElement(link.name), link.inertial->mass);
      else if (link.inertial)
        AddBodyTo(&sum, *link.inertial, X);
      if (!first || !(first->mass > 0)) first = link.inertial ? link.inertial : first;
      for (const int j : link.child_joints) {
        const UrdfJoint& joint = file_.joints[static_cast<std::size_t>(j)];
        self(self, joint.child, X * joint.X_PJ);
      }
    };
    add(add, file_.root, Isometry3d::Identity());
    *inertial = first;  // for its lines
    if (!first) return;
    (*inertial)->mass = sum.mass;
    (*inertial)->inertia = sum.I_LCom;
    (*inertial)->X_LI = Isometry3d(Eigen::Translation3d(sum.p_LCom));
  }

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
    const bool turned = geometry.kind == Kind::kSphere     ? false
                        : geometry.kind == Kind::kCylinder ? std::abs(R(2, 2)) < 1 - 1e-12
                                                           : !R.isIdentity(1e-9);
    if (collisions_.size() > 1 || geometry.kind == Kind::kMesh || turned ||
        (first.X_LG.translation() - facts_.p_LCom).norm() > 1e-9)
      return ReadPieces();
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

  /// Throws ModelError.
  static TriangleMesh MeshOf(const UrdfGeometry& geometry) {
    switch (geometry.kind) {
      case UrdfGeometry::Kind::kSphere:
        return CapsuleMesh(geometry.radius, 0);
      case UrdfGeometry::Kind::kCylinder:
        return CapsuleMesh(geometry.radius, geometry.length / 2);
      case UrdfGeometry::Kind::kBox:
        return BoxMesh(geometry.size);
      case UrdfGeometry::Kind::kMesh:
        break;
    }
    return LoadClosedMesh(geometry.mesh, geometry.scale);
  }

  void ReadPieces() {
    object_.kind = ObjectModel::Kind::kMesh;
    for (const UrdfCollision& piece : collisions_) {
      TriangleMesh mesh;
      try {
        mesh = MeshOf(piece.geometry);
        if (mesh.unread_bytes > 0 && report_)
          report_->warnings.push_back({problems_.file(), piece.geometry.line, element_,
                                       UnreadBytes(piece.geometry.mesh, mesh)});
      } catch (const ModelError& error) {
        problems_.Add(piece.geometry.line, "{}: {}", element_, error.what());
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
    const Solid solid = PiecesSolid({object_.vertices_O, object_.triangles}, &facts_.overlap_m3);
    facts_.p_LCom = options_.inertia_from_shape ? solid.centre : PCom();
    facts_.pieces = CountPieces(object_);
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
