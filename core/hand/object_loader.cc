#include "core/hand/object_loader.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "core/hand/mesh_units.h"
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
    summed_ = problems_.empty();
    element_ = LinkElement(body.name);
    collisions_ = body.collisions;
    Isometry3d X_OL = Isometry3d::Identity();
    X_OL.linear() = R_OL_;
    for (UrdfCollision& collision : collisions_) collision.X_LG = X_OL * collision.X_LG;
    const bool has_mass = CheckMass(body);
    if (body.inertial) inertial_ = *body.inertial;
    inertial_.X_LI = X_OL * inertial_.X_LI;
    from_shape_ = options_.inertia_from_shape || !body.inertial;
    object_.name = file_.name;
    const std::size_t before = problems_.count();
    if (collisions_.empty())
      problems_.Add(body.line, "{}: has no <collision>; an object has at least one", element_);
    else
      ReadShape();
    const bool has_shape = problems_.count() == before;
    if (body.inertial) ReadBody(has_mass && has_shape);
    problems_.ThrowIfAny();
    facts_.p_LCom = R_OL_.transpose() * facts_.p_LCom;
    if (facts_out_ != nullptr) *facts_out_ = facts_;
    return std::move(object_);
  }

 private:
  bool CheckMass(const UrdfLink& body) {
    const std::size_t before = problems_.count();
    if (!body.inertial)
      problems_.Add(body.line, "{}: has no <inertial>; an object needs its <mass>", element_);
    else if (!body.inertial->has_mass)
      problems_.Add(body.inertial->line, "{}: <inertial> has no <mass>", element_);
    else if (!(body.inertial->mass > 0) && summed_)
      problems_.Add(body.inertial->line, "{}: <mass> = {:.6g}; must be > 0", element_,
                    body.inertial->mass);
    else if (const double mass = body.inertial->mass;
             summed_ && !(mass >= kLeastObjectMass && mass <= kMostObjectMass))
      problems_.Add(body.inertial->line, "{}: <mass> = {:.6g}; allowed {:g} .. {:g} kg", element_,
                    mass, kLeastObjectMass, kMostObjectMass);
    return problems_.count() == before && body.inertial->mass > 0;
  }

  /// The shape, about the centre of mass.
  void ReadShape() {
    using Kind = UrdfGeometry::Kind;
    const UrdfCollision& first = collisions_.front();
    const UrdfGeometry& geometry = first.geometry;
    facts_.collisions = static_cast<int>(collisions_.size());
    facts_.pieces = 1;
    // A homogeneous body has its centre of mass in its middle.
    facts_.p_LCom = from_shape_ ? first.X_LG.translation() : PCom();
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
    const std::size_t before = problems_.count();
    TriangleMesh mesh = JoinPieces(collisions_, element_, &problems_);
    if (problems_.count() > before) return;
    const Solid solid = PiecesSolid(mesh, &facts_.overlap_m3);
    facts_.p_LCom = from_shape_ ? solid.centre : PCom();
    const auto pieces = PiecesOf(mesh);
    facts_.pieces = static_cast<int>(pieces.size());
    if (const Parts parts = PartsOf(mesh.vertices, pieces); parts.count > 1)
      problems_.Warn(collisions_.front().line, element_,
                     fmt::format("{} parts that do not touch, {:.3g} mm apart: one rigid body all "
                                 "the same",
                                 parts.count, 1e3 * parts.gap));
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
    const bool mesh = object_.kind == ObjectModel::Kind::kMesh;
    const std::string units = radius > kMax ? UnitHint(radius, kMin, kMax) : "";
    const std::string fix = mesh || units.empty() ? units : "; lengths are in metres";
    problems_.Add(collisions_.front().geometry.line,
                  "{}: bounding radius [m] = {:.6g}; allowed {:g} .. {:g}{}", element_, radius,
                  kMin, kMax, fix);
  }

  /// `whole`: mass and shape are there, so that what follows from them can be told.
  void ReadBody(bool whole) {
    const int line = inertial_.inertia_line;
    const auto computes = [&](const std::string& why) {
      problems_.Add(line, "{}: {}; --inertia-from-shape computes it", element_, why);
    };
    const Matrix3d R = inertial_.X_LI.linear();
    object_.mass = inertial_.mass;
    object_.I_OCom = R * inertial_.inertia * R.transpose();
    if (from_shape_ && !whole) return;
    if (from_shape_) {
      const Solid solid = ObjectSolid(object_);
      object_.I_OCom = solid.inertia * (object_.mass / solid.volume);
    } else if (!inertial_.has_inertia && !options_.inertia_as_told) {
      return computes("<inertial> has no <inertia>");
    }
    facts_.inertia_told = from_shape_ || inertial_.has_inertia;
    if (!summed_) return;
    if (options_.inertia_as_told) return;
    if (const std::string why = WhyNoInertia(object_.I_OCom); !why.empty()) return computes(why);
    if (!whole) return;
    if (const std::string why = WhyUnlikely(object_); !why.empty())
      problems_.Warn(line, element_, why + "; --inertia-from-shape computes it");
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
  bool summed_ = false;      // its links, without a problem
  bool from_shape_ = false;  // centre and inertia
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
  std::optional<TomlFile> file;
  if (std::filesystem::is_regular_file(toml_file, ignored)) {
    file.emplace(toml_file);
    const toml::table& root = file->root();
    file->CheckKeys(root, {"friction", "rotation_deg", "inertia_from_shape", "force"});
    options.inertia_from_shape |= file->Flag(root, "inertia_from_shape");
    options.force |= file->Flag(root, "force");
    // A misspelt flag, say: the URDF is not blamed for what the flags would mend.
    if (file->count() > 0) options.inertia_from_shape = options.force = true;
    if (const toml::node* node = root.get("friction"))
      friction = file->Number(*node, "friction", kLeastFriction, kMostFriction);
    if (root.contains("rotation_deg"))
      R_OL = FromRotationVector(file->Vector(root, "rotation_deg", 360) * M_PI / 180)
                 .toRotationMatrix();
  }
  ObjectModel model;
  try {
    model = LoadObjectUrdf(urdf_file, options, report, facts, R_OL);
  } catch (const ModelError& error) {
    if (!file) throw;
    file->Add(error);
  }
  if (file) file->ThrowIfAny();
  model.name = urdf_file.stem().string();
  model.friction = friction;
  return model;
}

}  // namespace regrasp
