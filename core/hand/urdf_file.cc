#include "core/hand/urdf_file.h"

#include <console_bridge/console.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <mutex>
#include <sstream>
#include <system_error>

#include "core/files/names.h"
#include "core/hand/model_xml.h"
#include "core/hand/urdf_check.h"

namespace regrasp {
namespace {

namespace fs = std::filesystem;
using tinyxml2::XMLElement;

std::string ReadText(const fs::path& path) {
  std::error_code error;
  const auto size = fs::file_size(path, error);
  if (!fs::is_regular_file(path, error) || error)
    throw ModelError(fmt::format("{}: is not a regular file", path.string()));
  if (size > kMaxXmlBytes)
    throw ModelError(
        fmt::format("{}: {} bytes; allowed are at most {}", path.string(), size, kMaxXmlBytes));
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  if (!in || (size > 0 && !(text << in.rdbuf())))
    throw ModelError(fmt::format("{}: cannot read the file", path.string()));
  return text.str();
}

/// Collects what urdfdom would print. One at a time: the handler is the process's.
class CollectedLog : public console_bridge::OutputHandler {
 public:
  CollectedLog() : lock_(mutex_), previous_(console_bridge::getOutputHandler()) {
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
  static inline std::mutex mutex_;
  std::lock_guard<std::mutex> lock_;
  console_bridge::OutputHandler* previous_;
  std::string text_;
};

/// The model of a document that CheckUrdf found right. urdfdom goes on after an error and loses
/// what it was about, so that any word of it refuses the file.
urdf::ModelInterfaceSharedPtr BuildModel(const fs::path& path, const XMLElement& robot) {
  tinyxml2::XMLPrinter printer(nullptr, true);
  robot.Accept(&printer);
  CollectedLog log;
  urdf::ModelInterfaceSharedPtr model;
  std::string why;
  try {
    model = urdf::parseURDF(printer.CStr());
  } catch (const std::exception& error) {
    why = error.what();
  }
  if (why.empty()) why = log.text();
  if (!model || !why.empty())
    throw ModelError(fmt::format("{}: not a valid URDF: {}", path.string(),
                                 why.empty() ? "unknown reason" : ShownText(why)));
  return model;
}

Vector3d ToVector(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

Isometry3d ToIsometry(const urdf::Pose& pose) {
  const urdf::Rotation& q = pose.rotation;
  Isometry3d X = Isometry3d::Identity();
  X.translation() = ToVector(pose.position);
  X.linear() = Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
  return X;
}

UrdfInertial ToInertial(const XMLElement& node, const urdf::Inertial& in) {
  UrdfInertial out;
  out.line = node.GetLineNum();
  const XMLElement& inertia = *node.FirstChildElement("inertia");
  out.has_mass = node.FirstChildElement("mass")->Attribute(kLacking) == nullptr;
  out.has_inertia = inertia.Attribute(kLacking) == nullptr;
  out.inertia_line = out.has_inertia ? inertia.GetLineNum() : out.line;
  out.mass = in.mass;
  out.X_LI = ToIsometry(in.origin);
  out.inertia << in.ixx, in.ixy, in.ixz, in.ixy, in.iyy, in.iyz, in.ixz, in.iyz, in.izz;
  return out;
}

UrdfGeometry ToGeometry(const XMLElement& node, const urdf::Geometry& in) {
  using Kind = UrdfGeometry::Kind;
  UrdfGeometry out;
  out.line = node.GetLineNum();
  if (const auto* sphere = dynamic_cast<const urdf::Sphere*>(&in)) {
    out.radius = sphere->radius;
  } else if (const auto* cylinder = dynamic_cast<const urdf::Cylinder*>(&in)) {
    out.kind = Kind::kCylinder;
    out.radius = cylinder->radius;
    out.length = cylinder->length;
  } else if (const auto* box = dynamic_cast<const urdf::Box*>(&in)) {
    out.kind = Kind::kBox;
    out.size = ToVector(box->dim);
  } else if (const auto* mesh = dynamic_cast<const urdf::Mesh*>(&in)) {
    out.kind = Kind::kMesh;
    out.mesh = mesh->filename;
    out.mesh_name = node.Attribute("written");
    out.scale = ToVector(mesh->scale);
  }
  return out;
}

UrdfLink ToLink(const XMLElement& node, const urdf::Link& in) {
  UrdfLink out;
  out.name = in.name;
  out.line = node.GetLineNum();
  if (in.inertial) out.inertial = ToInertial(*node.FirstChildElement("inertial"), *in.inertial);
  const XMLElement* collision = node.FirstChildElement("collision");
  for (const urdf::CollisionSharedPtr& shape : in.collision_array) {
    const XMLElement& geometry = *collision->FirstChildElement("geometry")->FirstChildElement();
    out.collisions.push_back({collision->GetLineNum(), ToIsometry(shape->origin),
                              ToGeometry(geometry, *shape->geometry)});
    collision = collision->NextSiblingElement("collision");
  }
  return out;
}

/// Half a turn as files round it, -3.1416 or 3.142, is half a turn.
double HalfTurnAtMost(double angle) {
  constexpr double kRounded = 1e-3;
  const bool rounded = std::abs(angle) > M_PI && std::abs(angle) <= M_PI + kRounded;
  return rounded ? std::copysign(M_PI, angle) : angle;
}

UrdfJoint ToJoint(const XMLElement& node, const urdf::Joint& in) {
  using Type = UrdfJoint::Type;
  UrdfJoint out;
  out.name = in.name;
  out.line = node.GetLineNum();
  out.type_name = node.Attribute("type");
  out.type = in.type == urdf::Joint::REVOLUTE     ? Type::kRevolute
             : in.type == urdf::Joint::CONTINUOUS ? Type::kContinuous
             : in.type == urdf::Joint::FIXED      ? Type::kFixed
             : in.type == urdf::Joint::PRISMATIC  ? Type::kPrismatic
                                                  : Type::kOther;
  out.X_PJ = ToIsometry(in.parent_to_joint_origin_transform);
  if (const Vector3d axis = ToVector(in.axis); axis.norm() > 0) out.axis = axis / axis.norm();
  if (in.limits) {
    const XMLElement& limit = *node.FirstChildElement("limit");
    out.limit_line = limit.GetLineNum();
    out.has_effort = limit.Attribute(kLacking) == nullptr;
    out.lower = HalfTurnAtMost(in.limits->lower);
    out.upper = HalfTurnAtMost(in.limits->upper);
    out.effort = in.limits->effort;
  }
  if (in.dynamics) out.damping = in.dynamics->damping;
  if (in.mimic) out.mimic = {in.mimic->joint_name, in.mimic->multiplier, in.mimic->offset};
  return out;
}

/// urdfdom sorts by name; here links and joints stand in the order of the file.
UrdfFile ToFile(const XMLElement& robot, const urdf::ModelInterface& model) {
  UrdfFile file;
  file.name = model.getName();
  std::map<std::string, int> link_index;
  for (const XMLElement* node = robot.FirstChildElement("link"); node != nullptr;
       node = node->NextSiblingElement("link")) {
    file.links.push_back(ToLink(*node, *model.getLink(node->Attribute("name"))));
    link_index[file.links.back().name] = static_cast<int>(file.links.size()) - 1;
  }
  for (const XMLElement* node = robot.FirstChildElement("joint"); node != nullptr;
       node = node->NextSiblingElement("joint")) {
    const urdf::Joint& in = *model.getJoint(node->Attribute("name"));
    UrdfJoint joint = ToJoint(*node, in);
    joint.parent = link_index.at(in.parent_link_name);
    joint.child = link_index.at(in.child_link_name);
    const int j = static_cast<int>(file.joints.size());
    file.links[static_cast<std::size_t>(joint.parent)].child_joints.push_back(j);
    file.links[static_cast<std::size_t>(joint.child)].parent_joint = j;
    file.joints.push_back(std::move(joint));
  }
  file.root = link_index.at(model.getRoot()->name);
  return file;
}

}  // namespace

int UrdfFile::FindLink(const std::string& link) const {
  const auto it = std::ranges::find(links, link, &UrdfLink::name);
  return it == links.end() ? -1 : static_cast<int>(it - links.begin());
}

int UrdfFile::FindJoint(const std::string& joint) const {
  const auto it = std::ranges::find(joints, joint, &UrdfJoint::name);
  return it == joints.end() ? -1 : static_cast<int>(it - joints.begin());
}

UrdfFile ReadUrdf(const fs::path& path, Problems* problems) {
  const std::string text = ReadText(path);
  tinyxml2::XMLDocument document;
  XMLElement* robot = nullptr;
  try {
    robot = ParseXml(text, &document);
  } catch (const XmlError& error) {
    throw ModelError(fmt::format("{}:{}: not a valid URDF: {}", path.string(), error.line(),
                                 ShownText(error.what())));
  }
  if (robot->Name() != std::string_view("robot"))
    throw ModelError(
        fmt::format("{}:{}: not a valid URDF: the root element is <{}>; must be <robot>",
                    path.string(), robot->GetLineNum(), ShownText(robot->Name())));
  CheckUrdf(path, robot, problems);
  if (!problems->empty()) return {};
  return ToFile(*robot, *BuildModel(path, *robot));
}

}  // namespace regrasp
