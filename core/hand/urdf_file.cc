#include "core/hand/urdf_file.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>
#include <system_error>

#include "core/hand/urdf_values.h"
#include "core/hand/xml.h"

namespace regrasp {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxElements = 300;  // links or joints: ten times what a hand may have

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

class Reader {
 public:
  Reader(const fs::path& path, Problems* problems) : path_(path), problems_(problems) {}

  UrdfFile Read(const XmlNode& robot) {
    const std::string* name = robot.Find("name");
    if (name == nullptr) problems_->Add(robot.line, "<robot> name is missing");
    if (name != nullptr) file_.name = *name;
    for (const XmlNode& node : robot.children)
      if (node.name == "link") ReadLink(node);
    for (const XmlNode& node : robot.children)
      if (node.name == "joint") ReadJoint(node);
    if (file_.links.empty()) problems_->Add(robot.line, "<robot> has no <link>");
    for (const std::size_t count : {file_.links.size(), file_.joints.size()})
      if (count > kMaxElements)
        problems_->Add(robot.line, "<robot> has {} links or joints; allowed are at most {}", count,
                       kMaxElements);
    if (problems_->empty()) CheckTree();
    return std::move(file_);
  }

 private:
  std::string NameOf(const XmlNode& node, std::map<std::string, int>* index) {
    const std::string* name = node.Find("name");
    if (name == nullptr || name->empty()) {
      problems_->Add(node.line, "<{}> name is missing", node.name);
      return "";
    }
    const auto [it, is_new] = index->try_emplace(*name, static_cast<int>(index->size()));
    if (!is_new) problems_->Add(node.line, "the name of {} \"{}\" is used twice", node.name, *name);
    return *name;
  }

  void ReadLink(const XmlNode& node) {
    UrdfLink link;
    link.line = node.line;
    link.name = NameOf(node, &link_index_);
    const UrdfValues values(LinkElement(link.name), problems_);
    for (const XmlNode& child : node.children) {
      if (child.name == "inertial") ReadInertial(child, values, &link);
      if (child.name == "collision") ReadCollision(child, values, &link);
    }
    link_index_[link.name] = static_cast<int>(file_.links.size());
    file_.links.push_back(std::move(link));
  }

  void ReadInertial(const XmlNode& node, const UrdfValues& values, UrdfLink* link) {
    if (link->inertial) return values.Add(node.line, "a second <inertial>; allowed is one");
    UrdfInertial in;
    in.line = node.line;
    in.X_LI = values.Origin(node);
    const XmlNode* mass = node.Child("mass");
    const XmlNode* inertia = node.Child("inertia");
    if (mass == nullptr) values.Add(node.line, "<inertial> has no <mass>");
    if (inertia == nullptr) values.Add(node.line, "<inertial> has no <inertia>");
    if (mass != nullptr) in.mass = values.Number(*mass, "value");
    if (inertia != nullptr) {
      in.inertia_line = inertia->line;
      const double xx = values.Number(*inertia, "ixx"), xy = values.Number(*inertia, "ixy"),
                   xz = values.Number(*inertia, "ixz"), yy = values.Number(*inertia, "iyy"),
                   yz = values.Number(*inertia, "iyz"), zz = values.Number(*inertia, "izz");
      in.inertia << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    }
    link->inertial = in;
  }

  void ReadCollision(const XmlNode& node, const UrdfValues& values, UrdfLink* link) {
    UrdfCollision collision;
    collision.line = node.line;
    collision.X_LG = values.Origin(node);
    const XmlNode* geometry = node.Child("geometry");
    if (geometry == nullptr || geometry->children.empty())
      return values.Add(node.line,
                        "<collision> has no <geometry> with a shape; allowed are sphere, box, "
                        "cylinder, mesh");
    ReadGeometry(geometry->children.front(), values, &collision.geometry);
    link->collisions.push_back(std::move(collision));
  }

  void ReadGeometry(const XmlNode& node, const UrdfValues& values, UrdfGeometry* out) {
    out->line = node.line;
    if (node.name == "sphere") {
      out->kind = UrdfGeometry::Kind::kSphere;
      out->radius = values.Positive(node, "radius");
    } else if (node.name == "cylinder") {
      out->kind = UrdfGeometry::Kind::kCylinder;
      out->radius = values.Positive(node, "radius");
      out->length = values.Positive(node, "length");
    } else if (node.name == "box") {
      out->kind = UrdfGeometry::Kind::kBox;
      const std::size_t before = problems_->count();
      out->size = values.Vector(node, "size");
      if (problems_->count() == before && !(out->size.minCoeff() > 0))
        values.Add(node.line, "<box> size = {:.6g}; must be > 0", out->size.minCoeff());
    } else if (node.name == "mesh") {
      ReadMesh(node, values, out);
    } else {
      values.Add(node.line,
                 "<collision> <geometry> <{}> is unknown; allowed are sphere, box, cylinder (read "
                 "as a capsule), mesh",
                 node.name);
    }
  }

  void ReadMesh(const XmlNode& node, const UrdfValues& values, UrdfGeometry* out) {
    out->kind = UrdfGeometry::Kind::kMesh;
    out->scale = values.Vector(node, "scale", Vector3d::Ones());
    if (out->scale.cwiseAbs().minCoeff() == 0)
      values.Add(node.line, "<mesh> scale = {}; no number may be 0", Shown(*node.Find("scale")));
    const std::string* name = node.Find("filename");
    if (name == nullptr || name->empty())
      return values.Add(node.line, "<mesh> filename is missing");
    out->mesh_name = *name;
    const std::string_view text = *name;
    if (text.starts_with("file://")) {
      out->mesh = text.substr(7);
    } else if (text.starts_with("package://")) {
      out->mesh = InPackage(text.substr(10));
      if (out->mesh.empty())
        values.Add(node.line,
                   "<mesh> filename = {}: the package is in no directory above the file and not in "
                   "$ROS_PACKAGE_PATH",
                   Shown(*name));
    } else if (text.find("://") != std::string_view::npos) {
      values.Add(node.line,
                 "<mesh> filename = {}; allowed are a path relative to the URDF file, an absolute "
                 "path, file:// or package://",
                 Shown(*name));
    } else {
      out->mesh = path_.parent_path() / *name;
    }
  }

  /// package://NAME/REST: the nearest directory above the file that is called NAME or holds it,
  /// else a directory of $ROS_PACKAGE_PATH; a package directory given as such may have another
  /// name.
  fs::path InPackage(std::string_view rest) const {
    const std::size_t slash = rest.find('/');
    if (slash == std::string_view::npos || slash == 0) return {};
    const fs::path package = rest.substr(0, slash), inside = rest.substr(slash + 1);
    std::error_code ignored;
    fs::path directory = fs::absolute(path_, ignored).lexically_normal().parent_path();
    for (; !directory.empty(); directory = directory.parent_path()) {
      if (directory.filename() == package) return directory / inside;
      if (fs::is_directory(directory / package, ignored)) return directory / package / inside;
      if (fs::is_regular_file(directory / "package.xml", ignored) &&
          fs::is_regular_file(directory / inside, ignored))
        return directory / inside;
      if (directory == directory.root_path()) break;
    }
    const char* roots = std::getenv("ROS_PACKAGE_PATH");
    std::istringstream list(roots == nullptr ? "" : roots);
    for (std::string root; std::getline(list, root, ':');) {
      if (fs::path(root).filename() == package) return fs::path(root) / inside;
      if (fs::is_directory(fs::path(root) / package, ignored)) return root / package / inside;
    }
    return {};
  }

  int LinkOf(const XmlNode& joint, const char* end, const UrdfValues& values) {
    const XmlNode* node = joint.Child(end);
    const std::string* name = node == nullptr ? nullptr : node->Find("link");
    if (name == nullptr) {
      values.Add(joint.line, "<{}> link is missing", end);
      return -1;
    }
    const auto it = link_index_.find(*name);
    if (it == link_index_.end()) {
      values.Add(node->line, "<{}> link = {}: there is no such link", end, Shown(*name));
      return -1;
    }
    return it->second;
  }

  void ReadJoint(const XmlNode& node) {
    UrdfJoint joint;
    joint.line = node.line;
    joint.name = NameOf(node, &joint_index_);
    const UrdfValues values(JointElement(joint.name), problems_);
    const std::string* type = node.Find("type");
    if (type == nullptr) values.Add(node.line, "type is missing");
    joint.type_name = type == nullptr ? "fixed" : *type;
    using Type = UrdfJoint::Type;
    joint.type = joint.type_name == "revolute"     ? Type::kRevolute
                 : joint.type_name == "continuous" ? Type::kContinuous
                 : joint.type_name == "fixed"      ? Type::kFixed
                 : joint.type_name == "prismatic"  ? Type::kPrismatic
                                                   : Type::kOther;
    joint.parent = LinkOf(node, "parent", values);
    joint.child = LinkOf(node, "child", values);
    joint.X_PJ = values.Origin(node);
    if (joint.type != Type::kFixed) ReadMotion(node, values, &joint);
    file_.joints.push_back(std::move(joint));
  }

  void ReadMotion(const XmlNode& node, const UrdfValues& values, UrdfJoint* joint) {
    if (const XmlNode* axis = node.Child("axis")) {
      const std::size_t before = problems_->count();
      const Vector3d v = values.Vector(*axis, "xyz");
      if (v.norm() > 1e-6)
        joint->axis = v / v.norm();
      else if (problems_->count() == before)
        values.Add(axis->line, "<axis> = ({}, {}, {}); must not be zero", v.x(), v.y(), v.z());
    }
    if (const XmlNode* limit = node.Child("limit")) {
      joint->limit_line = limit->line;
      joint->lower = values.Number(*limit, "lower", 0.0);
      joint->upper = values.Number(*limit, "upper", 0.0);
      joint->effort = values.Number(*limit, "effort");
    }
    if (const XmlNode* dynamics = node.Child("dynamics"); dynamics && dynamics->Find("damping")) {
      joint->damping = values.Number(*dynamics, "damping");
      if (!(*joint->damping >= 0))
        values.Add(dynamics->line, "<dynamics> damping = {:.6g}; must be >= 0", *joint->damping);
    }
    const XmlNode* mimic = node.Child("mimic");
    if (mimic == nullptr) return;
    const std::string* name = mimic->Find("joint");
    if (name == nullptr) return values.Add(mimic->line, "<mimic> joint is missing");
    joint->mimic = {*name, values.Number(*mimic, "multiplier", 1.0),
                    values.Number(*mimic, "offset", 0.0)};
  }

  /// Every link is the child of at most one joint, and all hang from one root.
  void CheckTree() {
    for (std::size_t j = 0; j < file_.joints.size(); ++j) {
      const UrdfJoint& joint = file_.joints[j];
      UrdfLink& child = file_.links[static_cast<std::size_t>(joint.child)];
      if (child.parent_joint >= 0) {
        problems_->Add(joint.line,
                       "{} is the child of the joints \"{}\" and \"{}\"; allowed is one",
                       LinkElement(child.name),
                       file_.joints[static_cast<std::size_t>(child.parent_joint)].name, joint.name);
        continue;
      }
      child.parent_joint = static_cast<int>(j);
      file_.links[static_cast<std::size_t>(joint.parent)].child_joints.push_back(
          static_cast<int>(j));
    }
    std::vector<int> roots;
    for (std::size_t l = 0; l < file_.links.size(); ++l)
      if (file_.links[l].parent_joint < 0) roots.push_back(static_cast<int>(l));
    if (roots.empty()) return problems_->Add(0, "every link has a parent: there is no root");
    file_.root = roots.front();
    const std::string& root = file_.links[static_cast<std::size_t>(file_.root)].name;
    std::set<int> reached;
    std::vector<int> open = roots;
    while (!open.empty()) {
      const int l = open.back();
      open.pop_back();
      if (!reached.insert(l).second) continue;
      for (const int j : file_.links[static_cast<std::size_t>(l)].child_joints)
        open.push_back(file_.joints[static_cast<std::size_t>(j)].child);
    }
    for (std::size_t l = 0; l < file_.links.size(); ++l) {
      const UrdfLink& link = file_.links[l];
      if (static_cast<int>(l) != file_.root && link.parent_joint < 0)
        problems_->Add(link.line, "{} is a second root beside \"{}\"; allowed is one root",
                       LinkElement(link.name), root);
      else if (!reached.contains(static_cast<int>(l)))
        problems_->Add(link.line, "{} is not connected to the root \"{}\"", LinkElement(link.name),
                       root);
    }
  }

  const fs::path& path_;
  Problems* problems_;
  UrdfFile file_;
  std::map<std::string, int> link_index_, joint_index_;
};

}  // namespace

int UrdfFile::FindLink(const std::string& link) const {
  const auto it = std::ranges::find(links, link, &UrdfLink::name);
  return it == links.end() ? -1 : static_cast<int>(it - links.begin());
}

int UrdfFile::FindJoint(const std::string& joint) const {
  const auto it = std::ranges::find(joints, joint, &UrdfJoint::name);
  return it == joints.end() ? -1 : static_cast<int>(it - joints.begin());
}

UrdfFile ReadUrdf(const std::filesystem::path& path, Problems* problems) {
  const std::string text = ReadText(path);
  XmlNode root;
  try {
    root = ParseXml(text);
  } catch (const XmlError& error) {
    throw ModelError(
        fmt::format("{}:{}: not a valid URDF: {}", path.string(), error.line(), error.what()));
  }
  if (root.name != "robot")
    throw ModelError(
        fmt::format("{}:{}: not a valid URDF: the root element is <{}>; must be <robot>",
                    path.string(), root.line, root.name));
  return Reader(path, problems).Read(root);
}

}  // namespace regrasp
