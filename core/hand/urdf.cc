#include "core/hand/urdf.h"

#include <console_bridge/console.h>
#include <fmt/format.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <sstream>

#include "core/hand/mesh.h"

namespace regrasp {
namespace {

constexpr double kMaxSize = 10;  // [m]; anything larger is a unit mistake

/// Collects what urdfdom would print, so that it ends up in our exception.
class CollectedLog : public console_bridge::OutputHandler {
 public:
  CollectedLog() : previous_(console_bridge::getOutputHandler()) {
    console_bridge::useOutputHandler(this);
  }
  ~CollectedLog() override { console_bridge::useOutputHandler(previous_); }
  CollectedLog(const CollectedLog&) = delete;
  CollectedLog& operator=(const CollectedLog&) = delete;
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR)
      text_ += (text_.empty() ? "" : "; ") + text;
  }
  const std::string& text() const { return text_; }

 private:
  console_bridge::OutputHandler* previous_;
  std::string text_;
};

/// Throws ModelErrors that begin with the file's name.
struct Checker {
  std::string file;

  template <typename... Args>
  [[noreturn]] void Fail(fmt::format_string<Args...> format, Args&&... args) const {
    throw ModelError(file + ": " + fmt::format(format, std::forward<Args>(args)...));
  }
  void Finite(const std::string& element, const char* key, double value) const {
    if (!std::isfinite(value)) Fail("{}: {} = {}; must be finite", element, key, value);
  }
  void Between(const std::string& element, const char* key, double value, double min,
               double max) const {
    if (!(value >= min && value <= max))
      Fail("{}: {} = {:.6g}; allowed {:.6g} .. {:.6g}", element, key, value, min, max);
  }
  void Positive(const std::string& element, const char* key, double value) const {
    if (!(value > 0 && std::isfinite(value)))
      Fail("{}: {} = {:.6g}; must be > 0", element, key, value);
  }
};

urdf::ModelInterfaceSharedPtr Parse(const std::filesystem::path& path, const Checker& check) {
  std::ifstream in(path);
  std::stringstream text;
  if (!in || !(text << in.rdbuf())) check.Fail("cannot read the file");
  CollectedLog log;
  urdf::ModelInterfaceSharedPtr model;
  try {
    model = urdf::parseURDF(text.str());
  } catch (const std::exception& error) {
    check.Fail("not a valid URDF: {}", error.what());
  }
  if (!model)
    check.Fail("not a valid URDF: {}", log.text().empty() ? "unknown reason" : log.text());
  // Links own their children, so links in a ring would own each other for ever.
  return {model.get(), [model](urdf::ModelInterface*) {
            for (const auto& [name, link] : model->links_) link->clear();
          }};
}

Isometry3d ToIsometry(const urdf::Pose& pose, const std::string& element, const Checker& check) {
  const urdf::Vector3& p = pose.position;
  const urdf::Rotation& q = pose.rotation;
  Isometry3d X = Isometry3d::Identity();
  X.translation() = Vector3d(p.x, p.y, p.z);
  X.linear() = Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
  if (!X.matrix().allFinite()) check.Fail("{}: <origin> is not finite", element);
  for (const double c : {p.x, p.y, p.z})
    check.Between(element, "<origin> xyz", c, -kMaxSize, kMaxSize);
  return X;
}

/// Mass, centre and inertia of <inertial>, checked. A rotated inertia is turned into link axes.
void ReadInertial(const urdf::Inertial& in, const std::string& element, const Checker& check,
                  double* mass, Vector3d* p_com, Matrix3d* inertia) {
  check.Positive(element, "<mass>", in.mass);
  for (const double value : {in.ixx, in.ixy, in.ixz, in.iyy, in.iyz, in.izz})
    check.Finite(element, "<inertia>", value);
  const Isometry3d X = ToIsometry(in.origin, element + ": <inertial>", check);
  Matrix3d I;
  I << in.ixx, in.ixy, in.ixz, in.ixy, in.iyy, in.iyz, in.ixz, in.iyz, in.izz;
  const Vector3d moments =
      Eigen::SelfAdjointEigenSolver<Matrix3d>(I, Eigen::EigenvaluesOnly).eigenvalues();
  if (!(moments[0] > 0))
    check.Fail("{}: <inertia> has the principal moment {:.4g}; all three must be > 0", element,
               moments[0]);
  // A rounded number may miss equality (a flat body) by its last digit.
  if (moments[2] > (moments[0] + moments[1]) * (1 + 1e-3))
    check.Fail(
        "{}: <inertia> has the principal moments {:.4g}, {:.4g}, {:.4g}; none may exceed the sum "
        "of the other two",
        element, moments[0], moments[1], moments[2]);
  *mass = in.mass;
  *p_com = X.translation();
  *inertia = X.linear() * I * X.linear().transpose();
}

Shape ToShape(const urdf::Collision& collision, const Isometry3d& X_LG, const std::string& element,
              const Checker& check) {
  const Isometry3d X = X_LG * ToIsometry(collision.origin, element + ": <collision>", check);
  Shape shape;
  const urdf::Geometry& geometry = *collision.geometry;
  if (geometry.type == urdf::Geometry::SPHERE) {
    shape.radius = static_cast<const urdf::Sphere&>(geometry).radius;
    shape.a_L = shape.b_L = X.translation();
    check.Positive(element, "<sphere> radius", shape.radius);
  } else if (geometry.type == urdf::Geometry::CYLINDER) {
    const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
    check.Positive(element, "<cylinder> radius", cylinder.radius);
    check.Positive(element, "<cylinder> length", cylinder.length);
    shape.radius = cylinder.radius;
    shape.a_L = X * Vector3d(0, 0, -cylinder.length / 2);
    shape.b_L = X * Vector3d(0, 0, cylinder.length / 2);
  } else if (geometry.type == urdf::Geometry::BOX) {
    const urdf::Vector3& size = static_cast<const urdf::Box&>(geometry).dim;
    for (const double edge : {size.x, size.y, size.z}) check.Positive(element, "<box> size", edge);
    shape.kind = Shape::Kind::kBox;
    shape.X_LB = X;
    shape.half_extents = Vector3d(size.x, size.y, size.z) / 2;
  } else {
    check.Fail("{}: a <mesh> cannot be a hand's <collision>; allowed are sphere, cylinder, box",
               element);
  }
  return shape;
}

std::string LinkElement(const std::string& name) { return fmt::format("link \"{}\"", name); }
std::string JointElement(const std::string& name) { return fmt::format("joint \"{}\"", name); }

Matrix3d PointInertia(double mass, const Vector3d& p) {
  return mass * (p.squaredNorm() * Matrix3d::Identity() - p * p.transpose());
}

/// Adds the body of `in`, which is fixed to `link` at X_LG, to `link`.
void AddBody(const urdf::Link& in, const Isometry3d& X_LG, const Checker& check, Link* link) {
  const std::string element = LinkElement(in.name);
  if (in.inertial) {
    double mass;
    Vector3d p_GCom;
    Matrix3d I;
    ReadInertial(*in.inertial, element, check, &mass, &p_GCom, &I);
    const Vector3d p = X_LG * p_GCom;
    const double total = link->mass + mass;
    const Vector3d com = (link->mass * link->p_LCom + mass * p) / total;
    link->I_LCom += PointInertia(link->mass, link->p_LCom - com) + PointInertia(mass, p - com) +
                    X_LG.linear() * I * X_LG.linear().transpose();
    link->mass = total;
    link->p_LCom = com;
  }
  for (const auto& collision : in.collision_array)
    link->shapes.push_back(ToShape(*collision, X_LG, element, check));
}

/// Walks the URDF's tree. Bodies joined by fixed joints become one link.
class HandReader {
 public:
  HandReader(const urdf::ModelInterface& model, Checker check)
      : model_(model), check_(std::move(check)) {}

  HandModel Read(const HandLayout& layout) {
    hand_.name = model_.getName();
    CheckTree();
    StartLink(*model_.getRoot(), -1);
    for (const auto& finger : layout.fingers) ReadFinger(finger);
    ReadRest(*model_.getRoot());
    if (hand_.num_joints() == 0) check_.Fail("the hand has no revolute joint");
    for (Joint& joint : hand_.joints) joint.armature = layout.armature;
    for (std::size_t l = 1; l < hand_.links.size(); ++l) {
      if (!(hand_.links[l].mass > 0))
        check_.Fail("{}: has no <inertial>; a link that moves needs mass > 0",
                    LinkElement(hand_.links[l].name));
    }
    for (std::size_t f = 0; f < layout.fingers.size(); ++f)
      FindFingertip(layout.fingers[f], &hand_.fingers[f]);
    return std::move(hand_);
  }

 private:
  /// Every link is the child of at most one joint, and all hang from the root.
  void CheckTree() const {
    std::map<std::string, std::string> joint_of_child;
    for (const auto& [name, joint] : model_.joints_) {
      const auto [it, is_new] = joint_of_child.try_emplace(joint->child_link_name, name);
      if (!is_new)
        check_.Fail("{} is the child of the joints \"{}\" and \"{}\"; allowed is one",
                    LinkElement(joint->child_link_name), it->second, name);
    }
    std::set<std::string> reached;
    std::vector<const urdf::Link*> open{model_.getRoot().get()};
    while (!open.empty()) {
      const urdf::Link* link = open.back();
      open.pop_back();
      if (!reached.insert(link->name).second) continue;
      for (const auto& child : link->child_links) open.push_back(child.get());
    }
    for (const auto& [name, link] : model_.links_)
      if (!reached.contains(name))
        check_.Fail("{} is not connected to the root \"{}\"", LinkElement(name),
                    model_.getRoot()->name);
  }

  /// Makes a new link of `in` and all that is fixed to it.
  void StartLink(const urdf::Link& in, int parent_joint) {
    Link link;
    link.name = in.name;
    link.parent_joint = parent_joint;
    hand_.links.push_back(link);
    Merge(in, Isometry3d::Identity(), static_cast<int>(hand_.links.size()) - 1);
  }

  void Merge(const urdf::Link& in, const Isometry3d& X_LG, int link) {
    AddBody(in, X_LG, check_, &hand_.links[link]);
    frames_[in.name] = {link, X_LG};
    for (const auto& joint : in.child_joints)
      if (joint->type == urdf::Joint::FIXED)
        Merge(*model_.getLink(joint->child_link_name),
              X_LG * ToIsometry(joint->parent_to_joint_origin_transform, JointElement(joint->name),
                                check_),
              link);
  }

  void AddJoint(const urdf::Joint& in) {
    const std::string element = JointElement(in.name);
    if (in.type != urdf::Joint::REVOLUTE)
      check_.Fail("{}: type is not supported; allowed are revolute and fixed", element);
    if (in.mimic)
      check_.Fail("{}: <mimic> is not supported; every joint has its own drive", element);
    if (hand_.num_joints() == kMaxJoints) check_.Fail("more than {} revolute joints", kMaxJoints);
    Joint joint;
    joint.name = in.name;
    joint.parent_link = frames_.at(in.parent_link_name).link;
    joint.child_link = static_cast<int>(hand_.links.size());
    joint.X_PJ = frames_.at(in.parent_link_name).X_LG *
                 ToIsometry(in.parent_to_joint_origin_transform, element, check_);
    joint.axis_J = Vector3d(in.axis.x, in.axis.y, in.axis.z);
    const double length = joint.axis_J.norm();
    if (!(length > 1e-6 && std::isfinite(length)))
      check_.Fail("{}: <axis> = ({}, {}, {}); must not be zero", element, in.axis.x, in.axis.y,
                  in.axis.z);
    joint.axis_J /= length;
    joint.lower = in.limits->lower;
    joint.upper = in.limits->upper;
    check_.Between(element, "<limit> lower [rad]", joint.lower, -M_PI, M_PI);
    check_.Between(element, "<limit> upper [rad]", joint.upper, -M_PI, M_PI);
    if (!(joint.lower < joint.upper))
      check_.Fail("{}: <limit> lower = {:.6g} must be less than upper = {:.6g}", element,
                  joint.lower, joint.upper);
    joint.effort = in.limits->effort;
    check_.Positive(element, "<limit> effort [N m]", joint.effort);
    if (in.dynamics) joint.damping = in.dynamics->damping;
    if (!(joint.damping >= 0 && std::isfinite(joint.damping)))
      check_.Fail("{}: <dynamics> damping = {:.6g}; must be >= 0", element, joint.damping);
    hand_.joints.push_back(joint);
    joint_index_[in.name] = hand_.num_joints() - 1;
    StartLink(*model_.getLink(in.child_link_name), hand_.num_joints() - 1);
  }

  void ReadFinger(const HandLayout::Finger& layout) {
    const urdf::LinkConstSharedPtr tip = model_.getLink(layout.tip_link);
    if (!tip) {
      std::string names;
      for (const auto& [name, link] : model_.links_) names += (names.empty() ? "" : ", ") + name;
      check_.Fail("finger \"{}\": there is no link \"{}\"; links are {}", layout.name,
                  layout.tip_link, names);
    }
    Finger finger;
    finger.name = layout.name;
    std::vector<const urdf::Joint*> chain;
    for (const urdf::Link* link = tip.get(); link->parent_joint;
         link = model_.getLink(link->parent_joint->parent_link_name).get())
      if (link->parent_joint->type != urdf::Joint::FIXED) chain.push_back(link->parent_joint.get());
    std::reverse(chain.begin(), chain.end());
    if (chain.empty() || static_cast<int>(chain.size()) > kMaxFingerJoints)
      check_.Fail("finger \"{}\": {} revolute joints between root and \"{}\"; allowed 1 .. {}",
                  layout.name, chain.size(), layout.tip_link, kMaxFingerJoints);
    for (const urdf::Joint* joint : chain) {
      if (!joint_index_.contains(joint->name)) AddJoint(*joint);
      finger.joints.push_back(joint_index_.at(joint->name));
    }
    finger.tip_link = frames_.at(layout.tip_link).link;
    hand_.fingers.push_back(finger);
  }

  /// Joints that belong to no finger.
  void ReadRest(const urdf::Link& link) {
    for (const auto& joint : link.child_joints) {
      if (joint->type != urdf::Joint::FIXED && !joint_index_.contains(joint->name))
        AddJoint(*joint);
      ReadRest(*model_.getLink(joint->child_link_name));
    }
  }

  void FindFingertip(const HandLayout::Finger& layout, Finger* finger) const {
    const Link& link = hand_.links[finger->tip_link];
    if (link.shapes.size() != 1 || link.shapes[0].kind != Shape::Kind::kCapsule)
      check_.Fail(
          "finger \"{}\": tip {} must have exactly one <collision>, a cylinder (read as a capsule) "
          "or a sphere",
          layout.name, LinkElement(link.name));
    const Shape& shape = link.shapes[0];
    finger->p_LF = shape.b_L.norm() >= shape.a_L.norm() ? shape.b_L : shape.a_L;
    finger->tip_radius = shape.radius;
  }

  struct Frame {
    int link;
    Isometry3d X_LG;
  };
  const urdf::ModelInterface& model_;
  Checker check_;
  HandModel hand_;
  std::map<std::string, Frame> frames_;  ///< every URDF link: our link that carries it, and where
  std::map<std::string, int> joint_index_;
};

std::filesystem::path MeshPath(const std::filesystem::path& urdf_file, const std::string& name,
                               const Checker& check) {
  constexpr std::string_view kFileScheme = "file://";
  if (name.starts_with(kFileScheme)) return name.substr(kFileScheme.size());
  if (name.find("://") != std::string::npos)
    check.Fail(
        "<mesh> filename = \"{}\"; allowed are a path relative to the URDF file, an absolute path, "
        "or file://",
        name);
  return urdf_file.parent_path() / name;
}

void ReadObjectShape(const std::filesystem::path& path, const urdf::Geometry& geometry,
                     const Isometry3d& X_OG, const std::string& element, const Checker& check,
                     ObjectModel* object) {
  if (geometry.type == urdf::Geometry::MESH) {
    const auto& in = static_cast<const urdf::Mesh&>(geometry);
    const std::filesystem::path mesh_file = MeshPath(path, in.filename, check);
    TriangleMesh mesh = LoadClosedMesh(mesh_file);
    for (const double s : {in.scale.x, in.scale.y, in.scale.z})
      check.Positive(element, "<mesh> scale", s);
    object->kind = ObjectModel::Kind::kMesh;
    object->bounding_radius = 0;
    for (const Vector3d& v : mesh.vertices) {
      object->vertices_O.push_back(X_OG *
                                   v.cwiseProduct(Vector3d(in.scale.x, in.scale.y, in.scale.z)));
      object->bounding_radius = std::max(object->bounding_radius, object->vertices_O.back().norm());
    }
    object->triangles = mesh.triangles;
    return;
  }
  if (!X_OG.isApprox(Isometry3d::Identity(), 1e-9))
    check.Fail(
        "{}: a sphere, box or cylinder must have its <collision> <origin> at the centre of mass, "
        "unrotated",
        element);
  if (geometry.type == urdf::Geometry::SPHERE) {
    object->kind = ObjectModel::Kind::kSphere;
    object->radius = object->bounding_radius = static_cast<const urdf::Sphere&>(geometry).radius;
    check.Positive(element, "<sphere> radius", object->radius);
  } else if (geometry.type == urdf::Geometry::BOX) {
    const urdf::Vector3& size = static_cast<const urdf::Box&>(geometry).dim;
    for (const double edge : {size.x, size.y, size.z}) check.Positive(element, "<box> size", edge);
    object->kind = ObjectModel::Kind::kBox;
    object->half_extents = Vector3d(size.x, size.y, size.z) / 2;
    object->bounding_radius = object->half_extents.norm();
  } else {
    const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
    check.Positive(element, "<cylinder> radius", cylinder.radius);
    check.Positive(element, "<cylinder> length", cylinder.length);
    object->kind = ObjectModel::Kind::kCapsule;
    object->radius = cylinder.radius;
    object->half_length = cylinder.length / 2;
    object->bounding_radius = object->half_length + object->radius;
  }
}

}  // namespace

HandModel LoadHand(const std::filesystem::path& urdf_file, const HandLayout& layout) {
  const Checker check{urdf_file.string()};
  const urdf::ModelInterfaceSharedPtr model = Parse(urdf_file, check);
  return HandReader(*model, check).Read(layout);
}

ObjectModel LoadObjectUrdf(const std::filesystem::path& urdf_file) {
  const Checker check{urdf_file.string()};
  const urdf::ModelInterfaceSharedPtr model = Parse(urdf_file, check);
  if (model->links_.size() != 1)
    check.Fail("an object has exactly one link; this file has {}", model->links_.size());
  const urdf::Link& link = *model->getRoot();
  const std::string element = LinkElement(link.name);
  if (!link.inertial) check.Fail("{}: has no <inertial>", element);
  if (link.collision_array.size() != 1)
    check.Fail("{}: has {} <collision> elements; an object has exactly one", element,
               link.collision_array.size());

  ObjectModel object;
  object.name = model->getName();
  Vector3d p_com;
  ReadInertial(*link.inertial, element, check, &object.mass, &p_com, &object.I_OCom);
  Isometry3d X_OG = ToIsometry(link.collision->origin, element + ": <collision>", check);
  X_OG.pretranslate(-p_com);
  ReadObjectShape(urdf_file, *link.collision->geometry, X_OG, element, check, &object);
  check.Between(element, "bounding radius [m]", object.bounding_radius, 1e-3, 1);
  return object;
}

}  // namespace regrasp
