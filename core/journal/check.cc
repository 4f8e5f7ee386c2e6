#include "core/journal/check.h"

#include <cmath>
#include <cstdio>
#include <numbers>
#include <set>

#include "core/files/names.h"
#include "core/journal/model_fields.h"

namespace regrasp {
namespace {

// Wider than what the loaders of models take: a file is refused only for what no model can have.
constexpr double kMaxLength = 10;     // [m]
constexpr double kMaxMass = 1000;     // [kg]
constexpr double kMaxInertia = 1000;  // [kg m²]
constexpr double kUnitSlack = 1e-6;   // of axes and rotations written with all their digits
constexpr double kMaxAngle = 100;     // [rad] of a joint
constexpr double kMaxTorque = 1e4;    // [N m], also for damping
constexpr double kMaxRatio = 100;     // of a coupled joint to its driver
constexpr double kMaxOffset = 1000;   // [rad] of a coupled joint
constexpr std::size_t kMaxVertices = 2'000'000;

void CheckSize(const char* what, std::size_t size, std::size_t min, std::size_t max) {
  CheckRange(what, static_cast<double>(size), static_cast<double>(min), static_cast<double>(max));
}

void CheckName(const char* what, const std::string& name) {
  if (const std::string fault = NameFault(name); !fault.empty())
    throw JournalError(std::string(what) + " '" + Shown(name) + "' is no name: it " + fault);
}

template <typename Vector>
void CheckVector(const char* what, const Vector& v, double max) {
  for (Eigen::Index i = 0; i < v.size(); ++i) CheckRange(what, v.data()[i], -max, max);
}

void CheckPose(const char* what, const Isometry3d& X) {
  CheckVector(what, X.translation(), kMaxLength);
  const Matrix3d R = X.linear();
  const bool rotation =
      (R.transpose() * R - Matrix3d::Identity()).cwiseAbs().maxCoeff() < kUnitSlack &&
      R.determinant() > 0;
  if (!rotation) throw JournalError(std::string(what) + " holds no rotation");
}

void CheckUnit(const char* what, const Vector3d& axis) {
  CheckRange(what, axis.norm(), 1 - kUnitSlack, 1 + kUnitSlack);
}

/// An inertia that a body can have, but for the rounding of its file.
void CheckInertia(const char* what, const Matrix3d& I) {
  CheckVector(what, I, kMaxInertia);
  if ((I - I.transpose()).cwiseAbs().maxCoeff() > kUnitSlack * I.cwiseAbs().maxCoeff() ||
      !(I.diagonal().minCoeff() > 0) || !(I.determinant() > 0))
    throw JournalError(std::string(what) + " is no inertia of a body");
}

/// Every number of a structure, whatever it is called: none is negative or beyond reason.
struct Plausible {
  void operator()(const char* key, double value) const { CheckRange(key, value, 0, 1e7); }
  void operator()(const char* key, int value) const {
    CheckRange(key, value, std::string_view(key) == "iterations" ? 1 : 0, 10'000);
  }
  void operator()(const char*, bool) const {}
  void operator()(const char* key, Stepper value) const {
    CheckRange(key, static_cast<double>(value), 0, static_cast<double>(kLastStepper));
  }
};

void CheckShape(const Shape& s) {
  CheckRange("kind of a shape", static_cast<double>(s.kind), 0,
             static_cast<double>(Shape::Kind::kBox));
  CheckVector("a_L", s.a_L, kMaxLength);
  CheckVector("b_L", s.b_L, kMaxLength);
  CheckRange("radius of a shape", s.radius, s.kind == Shape::Kind::kCapsule ? 1e-6 : 0, kMaxLength);
  CheckPose("X_LB", s.X_LB);
  for (int i = 0; i < 3; ++i)
    CheckRange("half_extents of a shape", s.half_extents[i], s.kind == Shape::Kind::kBox ? 1e-6 : 0,
               kMaxLength);
}

void CheckLinks(const HandModel& hand) {
  const int joints = static_cast<int>(hand.joints.size());
  for (std::size_t i = 0; i < hand.links.size(); ++i) {
    const Link& link = hand.links[i];
    CheckName("link", link.name);
    const bool palm = i == 0;
    CheckRange("parent_joint", link.parent_joint, palm ? -1 : 0, palm ? -1 : joints - 1);
    if (!palm &&
        hand.joints[static_cast<std::size_t>(link.parent_joint)].child_link != static_cast<int>(i))
      throw JournalError("the parent_joint of link " + link.name + " moves another link");
    CheckRange("mass of a link", link.mass, palm ? 0 : 1e-12, kMaxMass);
    CheckVector("p_LCom", link.p_LCom, kMaxLength);
    if (palm)
      CheckVector("I_LCom", link.I_LCom, kMaxInertia);
    else
      CheckInertia("I_LCom", link.I_LCom);
    CheckSize("number of shapes", link.shapes.size(), 0, 64);
    for (const Shape& shape : link.shapes) CheckShape(shape);
  }
}

/// Driven joints come first; a coupled one follows one of them.
void CheckCoupling(const Joint& joint, bool coupled, int driven) {
  CheckRange("driver", joint.driver, coupled ? 0 : -1, coupled ? driven - 1 : -1);
  CheckRange("size of ratio", std::abs(joint.ratio), coupled ? 1e-3 : 1, coupled ? kMaxRatio : 1);
  if (!coupled) CheckRange("ratio", joint.ratio, 1, 1);
  CheckRange("offset", joint.offset, coupled ? -kMaxOffset : 0, coupled ? kMaxOffset : 0);
}

void CheckJoints(const HandModel& hand) {
  const int links = static_cast<int>(hand.links.size());
  std::set<int> children;
  for (std::size_t i = 0; i < hand.joints.size(); ++i) {
    const Joint& joint = hand.joints[i];
    CheckName("joint", joint.name);
    CheckRange("child_link", joint.child_link, 1, links - 1);
    CheckRange("parent_link", joint.parent_link, 0, joint.child_link - 1);
    if (!children.insert(joint.child_link).second)
      throw JournalError("two joints move link " + std::to_string(joint.child_link));
    CheckPose("X_PJ", joint.X_PJ);
    CheckUnit("length of axis_J", joint.axis_J);
    CheckRange("lower", joint.lower, -kMaxAngle, kMaxAngle);
    CheckRange("upper", joint.upper, joint.lower, kMaxAngle);
    CheckRange("effort", joint.effort, 0, kMaxTorque);
    CheckRange("damping", joint.damping, 0, kMaxTorque);
    CheckRange("armature", joint.armature, 0, kMaxInertia);
    CheckCoupling(joint, static_cast<int>(i) >= hand.num_joints(), hand.num_joints());
  }
}

void CheckHand(const HandModel& hand) {
  CheckName("hand", hand.name);
  CheckSize("number of joints", hand.joints.size(), 1, kMaxJoints);
  CheckRange("num_coupled", hand.num_coupled, 0, static_cast<double>(hand.joints.size()) - 1);
  CheckSize("number of links", hand.links.size(), hand.joints.size() + 1, hand.joints.size() + 1);
  CheckJoints(hand);
  CheckLinks(hand);
  CheckSize("number of fingers", hand.fingers.size(), 1, kMaxFingers);
  for (const Finger& finger : hand.fingers) {
    CheckName("finger", finger.name);
    CheckSize("number of a finger's joints", finger.joints.size(), 1, kMaxFingerJoints);
    for (const int joint : finger.joints)
      CheckRange("joints of a finger", joint, 0, hand.num_joints() - 1);
    if (std::set(finger.joints.begin(), finger.joints.end()).size() != finger.joints.size())
      throw JournalError("finger " + finger.name + " has a joint twice");
    CheckRange("tip_link", finger.tip_link, 1, static_cast<double>(hand.links.size()) - 1);
    CheckVector("p_LF", finger.p_LF, kMaxLength);
    CheckRange("tip_radius", finger.tip_radius, 1e-6, kMaxLength);
    const auto& shapes = hand.links[static_cast<std::size_t>(finger.tip_link)].shapes;
    CheckRange("tip_shapes", finger.tip_shapes, 1,
               std::max<double>(1, static_cast<double>(shapes.size())));
  }
}

void CheckObject(const ObjectModel& object) {
  using Kind = ObjectModel::Kind;
  CheckName("object", object.name);
  CheckRange("kind of the object", static_cast<double>(object.kind), 0,
             static_cast<double>(Kind::kMesh));
  constexpr int kFormerCapsule = 2;
  if (static_cast<int>(object.kind) == kFormerCapsule)
    throw JournalError("the object is a capsule, which only former versions had");
  CheckRange("radius of the object", object.radius, object.kind == Kind::kSphere ? 1e-6 : 0,
             kMaxLength);
  for (int i = 0; i < 3; ++i)
    CheckRange("half_extents of the object", object.half_extents[i],
               object.kind == Kind::kBox ? 1e-6 : 0, kMaxLength);
  const bool mesh = object.kind == Kind::kMesh;
  CheckSize("number of vertices", object.vertices_O.size(), mesh ? 4 : 0, kMaxVertices);
  CheckSize("number of triangles", object.triangles.size(), mesh ? 4 : 0, 2 * kMaxVertices);
  for (const Vector3d& vertex : object.vertices_O) CheckVector("vertices_O", vertex, kMaxLength);
  const double last = static_cast<double>(object.vertices_O.size()) - 1;
  for (const Eigen::Vector3i& triangle : object.triangles)
    for (int i = 0; i < 3; ++i) CheckRange("triangles", triangle[i], 0, last);
  CheckRange("mass of the object", object.mass, kLeastObjectMass, kMostObjectMass);
  CheckInertia("I_OCom", object.I_OCom);
  CheckRange("friction", object.friction, kLeastFriction, kMostFriction);
  CheckRange("bounding_radius", object.bounding_radius, 1e-6, 2 * kMaxLength);
}

void CheckParameters(const Parameters& parameters) {
  for (const ParameterInfo& info : ParameterTable()) {
    const Vector3d value = info.get(parameters);
    for (int i = 0; i < info.size(); ++i)
      CheckRange(std::string(info.name).c_str(), value[i], info.min, info.max);
  }
}

}  // namespace

void CheckRange(const char* what, double value, double min, double max) {
  if (value >= min && value <= max) return;
  char text[200];
  std::snprintf(text, sizeof text, "%.60s = %.9g; allowed %.9g ... %.9g", what, value, min, max);
  throw JournalError(text);
}

namespace {

void CheckNoise(const NoiseLevels& noise) {
  CheckRange("dropout_fraction", noise.dropout, 0, 0.9);
  CheckRange("dropout_gap_s", noise.dropout_gap_s, 0, 1);
  CheckRange("latency_s", noise.latency_s, 0, 0.02);
}

}  // namespace

void CheckConfig(const SessionConfig& config) {
  CheckRange("dt_s", config.world.dt, 1e-5, 1e-2);
  const Plausible plausible;
  WorldConfig world = config.world;
  NoiseLevels noise = config.noise;
  Fields(plausible, world);
  Fields(plausible, noise);
  CheckNoise(noise);
  CheckParameters(config.parameters);
  CheckHand(config.model.hand);
  CheckObject(config.model.object);
  const Scenario& scenario = config.model.scenario;
  CheckName("scenario", scenario.name);
  const auto joints = static_cast<std::size_t>(config.model.hand.num_joints());
  CheckSize("number of q_preshape", static_cast<std::size_t>(scenario.q_preshape.size()), joints,
            joints);
  CheckSize("number of q_closed", static_cast<std::size_t>(scenario.q_closed.size()), joints,
            joints);
  CheckVector("q_preshape", scenario.q_preshape, kMaxAngle);
  CheckVector("q_closed", scenario.q_closed, kMaxAngle);
  CheckPose("X_WO", scenario.X_WO);
  CheckVector("gravity_W", scenario.gravity_W, 1000);
}

void CheckEntry(const JournalEntry& entry, const SessionConfig& config) {
  CheckRange("tick", static_cast<double>(entry.tick), 0, static_cast<double>(kMaxTick));
  const Command& c = entry.command;
  CheckRange("job", static_cast<double>(c.job), 0, 9007199254740992.0);
  CheckRange("criterion", static_cast<double>(c.criterion), 0, static_cast<double>(kLastCriterion));
  CheckRange("estimator", static_cast<double>(c.estimator), 0, static_cast<double>(kLastEstimator));
  if (c.type == CommandType::kExplore)
    CheckRange("finger", c.finger, 0, config.model.hand.num_fingers() - 1);
  CheckRange("max_cycles", c.max_cycles, 0, 1e6);
  CheckRange("angle_rad", c.angle_rad, -1e6, 1e6);
  CheckUnit("length of axis_W", c.axis_W);
  CheckRange("speed_rad_s", c.speed_rad_s, 0, 100);
  CheckVector("offset_m", c.offset_W, 0.05 * (1 + kUnitSlack));
  CheckVector("rotation_rad", c.rotation_W, std::numbers::pi * (1 + kUnitSlack));
  CheckVector("force_W_n", c.force_W, 1000);
  CheckRange("duration_s", c.duration_s, 0, 1000);
  const Plausible plausible;
  NoiseLevels noise = c.noise;
  Fields(plausible, noise);
  CheckNoise(noise);
  if (c.type != CommandType::kParameter) return;
  const ParameterInfo& info = ParameterTable()[static_cast<std::size_t>(c.parameter)];
  for (int i = 0; i < info.size(); ++i)
    CheckRange(std::string(info.name).c_str(), c.value[i], info.min, info.max);
}

}  // namespace regrasp
