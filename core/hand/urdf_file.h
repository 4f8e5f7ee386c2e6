#pragma once

/// A URDF file as plain data, each element with its line. Three steps: the file is XML
/// (model_xml.h); every mistake of it is told at once, with its line (urdf_check.h); urdfdom builds
/// the model from what is left, and gives every number that stands here. Alone it would not do: it
/// names no line, stops at an element's first error or goes on without the link's shapes, needs
/// attributes that published files lack, and forgets the order of the file and whether a damping
/// was given. <visual>, <transmission>, <gazebo> and all else that is not named here are never
/// looked at.

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/common/frames.h"
#include "core/hand/problems.h"

namespace regrasp {

struct UrdfGeometry {
  enum class Kind { kSphere, kBox, kCylinder, kMesh };
  Kind kind = Kind::kSphere;
  int line = 0;
  double radius = 0, length = 0;      ///< sphere, cylinder [m]
  Vector3d size = Vector3d::Zero();   ///< box [m]
  std::filesystem::path mesh;         ///< resolved: relative to the file, file:// or package://
  std::string mesh_name;              ///< as written
  Vector3d scale = Vector3d::Ones();  ///< mesh; no component is zero
};

struct UrdfCollision {
  int line = 0;
  Isometry3d X_LG = Isometry3d::Identity();
  UrdfGeometry geometry;
};

/// Numbers as written; whether a body can have them is for the loaders.
struct UrdfInertial {
  int line = 0, inertia_line = 0;            ///< the second is the first without <inertia>
  bool has_mass = true, has_inertia = true;  ///< else 0
  double mass = 0;                           ///< [kg]
  Isometry3d X_LI = Isometry3d::Identity();  ///< centre of mass, axes of the inertia
  Matrix3d inertia = Matrix3d::Zero();       ///< [kg m²]
};

struct UrdfLink {
  std::string name;
  int line = 0;
  std::optional<UrdfInertial> inertial;
  std::vector<UrdfCollision> collisions;
  int parent_joint = -1;
  std::vector<int> child_joints;
};

struct UrdfMimic {
  std::string joint;
  double multiplier = 1, offset = 0;  ///< q = multiplier * q(joint) + offset [rad]
};

struct UrdfJoint {
  enum class Type { kRevolute, kContinuous, kFixed, kPrismatic, kOther };
  std::string name;
  int line = 0;
  Type type = Type::kFixed;
  std::string type_name;
  int parent = -1, child = -1;  ///< links
  Isometry3d X_PJ = Isometry3d::Identity();
  Vector3d axis = Vector3d::UnitX();  ///< unit
  double lower = 0, upper = 0, effort = 0;
  int limit_line = 0;             ///< 0: no <limit>
  bool has_effort = true;         ///< the <limit>; else 0
  std::optional<double> damping;  ///< [N m s/rad]
  std::optional<UrdfMimic> mimic;
};

struct UrdfFile {
  std::string name;
  std::vector<UrdfLink> links;
  std::vector<UrdfJoint> joints;
  int root = 0;

  /// Index of the link or joint of this name, or -1.
  int FindLink(const std::string& link) const;
  int FindJoint(const std::string& joint) const;
};

/// Reads and checks the file. Throws ModelError where it is no XML or no <robot>; adds every other
/// mistake to `problems`, whose caller throws them (ThrowIfAny) before it uses the result, and
/// warns of what is not read though it looks as if it were.
UrdfFile ReadUrdf(const std::filesystem::path& path, Problems* problems);

inline std::string LinkElement(const std::string& name) { return "link \"" + name + "\""; }
inline std::string JointElement(const std::string& name) { return "joint \"" + name + "\""; }

}  // namespace regrasp
