#include "core/hand/urdf_check.h"

#include <algorithm>
#include <initializer_list>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/files/names.h"
#include "core/hand/mesh_path.h"
#include "core/hand/urdf_file.h"
#include "core/hand/urdf_unused.h"
#include "core/hand/urdf_values.h"

namespace regrasp {
namespace {

namespace fs = std::filesystem;
using tinyxml2::XMLElement;

constexpr std::size_t kMaxElements = 300;  // links or joints: ten times what a hand may have

class Checker {
 public:
  Checker(const fs::path& path, Problems* problems) : path_(path), problems_(problems) {}

  void Check(XMLElement* robot) {
    const int line = robot->GetLineNum();
    const char* name = robot->Attribute("name");
    if (name == nullptr) problems_->Add(line, "<robot> name is missing");
    if (const std::string fault = name && *name ? NameFault(name) : ""; !fault.empty())
      problems_->Add(line, "<robot> name = {} {}", Quoted(name), fault);
    if (const char* version = robot->Attribute("version");
        version != nullptr && std::string_view(version) != "1.0")
      problems_->Add(line, "<robot> version = {}; must be \"1.0\"", Quoted(version));
    KeepOnly(robot, {"link", "joint"});
    for (XMLElement* node = robot->FirstChildElement("link"); node != nullptr;
         node = node->NextSiblingElement("link"))
      CheckLink(node);
    for (XMLElement* node = robot->FirstChildElement("joint"); node != nullptr;
         node = node->NextSiblingElement("joint"))
      CheckJoint(node);
    if (links_.empty()) problems_->Add(line, "<robot> has no <link>");
    for (const std::size_t count : {links_.size(), joints_.size()})
      if (count > kMaxElements)
        problems_->Add(line, "<robot> has {} links or joints; allowed are at most {}", count,
                       kMaxElements);
    if (problems_->empty()) CheckTree();
  }

 private:
  struct LinkPlace {
    std::string name;
    int line = 0, parent_joint = -1;
    std::vector<int> children;  // links
  };
  struct JointPlace {
    std::string name;
    int line = 0, parent = -1, child = -1;
  };

  /// Deletes every child but the elements of these names. What xacro would have replaced is told.
  void KeepOnly(XMLElement* node, std::initializer_list<std::string_view> names) {
    for (tinyxml2::XMLNode* child = node->FirstChild(); child != nullptr;) {
      tinyxml2::XMLNode* next = child->NextSibling();
      if (child->ToElement() && std::string_view(child->Value()).starts_with("xacro:"))
        problems_->Add(child->GetLineNum(),
                       "<{}> in <{}> is not URDF; run xacro over the file first", child->Value(),
                       node->Name());
      if (!child->ToElement() ||
          std::find(names.begin(), names.end(), child->Value()) == names.end())
        node->DeleteChild(child);
      child = next;
    }
  }

  std::string NameOf(const XMLElement& node, std::map<std::string, int>* index) {
    const char* name = node.Attribute("name");
    if (name == nullptr || *name == '\0') {
      problems_->Add(node.GetLineNum(), "<{}> name is missing", node.Name());
      return "";
    }
    if (const std::string fault = NameFault(name); !fault.empty())
      problems_->Add(node.GetLineNum(), "the name of {} {} {}", node.Name(), Quoted(name), fault);
    const auto [it, is_new] = index->try_emplace(name, static_cast<int>(index->size()));
    if (!is_new)
      problems_->Add(node.GetLineNum(), "the name of {} \"{}\" is used twice", node.Name(), name);
    return name;
  }

  /// Where a reader may take the first and another the last.
  /// `name`: of which there may be one; null: of any.
  static void AllowOne(const XMLElement& node, const char* name, const UrdfValues& values) {
    const XMLElement* first = node.FirstChildElement(name);
    const XMLElement* second = first == nullptr ? nullptr : first->NextSiblingElement(name);
    if (second != nullptr)
      values.Add(second->GetLineNum(), "a second <{}> in <{}>; allowed is one", second->Name(),
                 node.Name());
  }

  void CheckLink(XMLElement* node) {
    const std::string name = NameOf(*node, &link_index_);
    const UrdfValues values(LinkElement(name), problems_);
    KeepOnly(node, {"inertial", "collision"});
    for (XMLElement* child = node->FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement())
      if (child->Name() == std::string_view("collision"))
        CheckCollision(child, values);
      else  // a second is published, too: the first counts, as elsewhere, and the other is told
        CheckInertial(child, values);
    const XMLElement* first = node->FirstChildElement("inertial");
    if (const XMLElement* second = first ? first->NextSiblingElement("inertial") : nullptr)
      problems_->Warn(second->GetLineNum(), LinkElement(name), "a second <inertial> is not read");
    link_index_[name] = static_cast<int>(links_.size());
    links_.push_back({name, node->GetLineNum(), -1, {}});
  }

  static void CheckInertial(XMLElement* node, const UrdfValues& values) {
    values.Origin(node);
    for (const char* once : {"origin", "mass", "inertia"}) AllowOne(*node, once, values);
    // What is missing is 0 to urdfdom; whether it is needed is for the loaders.
    const auto numbers = [&](const char* name, std::initializer_list<const char*> attributes) {
      XMLElement* child = node->FirstChildElement(name);
      const bool lacking = child == nullptr;
      if (lacking) (child = node->InsertNewChildElement(name))->SetAttribute(kLacking, "");
      for (const char* attribute : attributes)
        if (lacking)
          child->SetAttribute(attribute, "0");
        else
          values.Number(child, attribute);
    };
    numbers("mass", {"value"});
    numbers("inertia", {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"});
  }

  void CheckCollision(XMLElement* node, const UrdfValues& values) {
    values.Origin(node);
    KeepOnly(node, {"origin", "geometry"});
    for (const char* once : {"origin", "geometry"}) AllowOne(*node, once, values);
    XMLElement* geometry = node->FirstChildElement("geometry");
    XMLElement* shape = geometry == nullptr ? nullptr : geometry->FirstChildElement();
    if (shape == nullptr)
      return values.Add(node->GetLineNum(),
                        "<collision> has no <geometry> with a shape; allowed are sphere, box, "
                        "cylinder, mesh");
    CheckShape(shape, values);
    AllowOne(*geometry, nullptr, values);
  }

  void CheckShape(XMLElement* node, const UrdfValues& values) {
    const std::string_view kind = node->Name();
    if (kind == "sphere") {
      values.Positive(node, "radius");
    } else if (kind == "cylinder") {
      values.Positive(node, "radius");
      values.Positive(node, "length");
    } else if (kind == "box") {
      const std::size_t before = problems_->count();
      const double least = values.Vector(node, "size").minCoeff();
      if (problems_->count() == before && !(least > 0))
        values.Add(node->GetLineNum(), "<box> size = {:.6g}; must be > 0", least);
    } else if (kind == "mesh") {
      CheckMesh(node, values);
    } else {
      values.Add(node->GetLineNum(),
                 "<collision> <geometry> <{}> is unknown; allowed are sphere, box, cylinder, "
                 "mesh",
                 kind);
    }
  }

  void CheckMesh(XMLElement* node, const UrdfValues& values) {
    if (values.Vector(node, "scale", Vector3d::Ones()).cwiseAbs().minCoeff() == 0)
      values.Add(node->GetLineNum(), "<mesh> scale = {}; no number may be 0",
                 Quoted(node->Attribute("scale")));
    const std::string name = node->Attribute("filename") ? node->Attribute("filename") : "";
    if (name.empty()) return values.Add(node->GetLineNum(), "<mesh> filename is missing");
    std::string why;
    const auto [file, guess] = ResolveMesh(path_, name, &why);
    if (!why.empty())
      values.Add(node->GetLineNum(), "<mesh> filename = {}: {}", QuotedPath(name), why);
    if (!guess.empty() && guesses_.insert(guess).second)
      problems_->Warn(node->GetLineNum(), "",
                      "<mesh> filename = " + QuotedPath(name) + ": " + guess);
    node->SetAttribute("written", name.c_str());
    node->SetAttribute("filename", file.c_str());
  }

  int LinkOf(XMLElement* joint, const char* end, const UrdfValues& values) {
    const XMLElement* node = joint->FirstChildElement(end);
    const char* name = node == nullptr ? nullptr : node->Attribute("link");
    if (name == nullptr) {
      values.Add(joint->GetLineNum(), "<{}> link is missing", end);
      return -1;
    }
    const auto it = link_index_.find(name);
    if (it == link_index_.end()) {
      values.Add(node->GetLineNum(), "<{}> link = {}: there is no such link", end, Quoted(name));
      return -1;
    }
    return it->second;
  }

  void CheckJoint(XMLElement* node) {
    const std::string name = NameOf(*node, &joint_index_);
    const UrdfValues values(JointElement(name), problems_);
    const char* type = node->Attribute("type");
    if (type == nullptr) values.Add(node->GetLineNum(), "type is missing");
    const int parent = LinkOf(node, "parent", values);
    joints_.push_back({name, node->GetLineNum(), parent, LinkOf(node, "child", values)});
    values.Origin(node);
    for (const char* once : {"parent", "child", "origin"}) AllowOne(*node, once, values);
    constexpr std::string_view kTypes[] = {"revolute",  "continuous", "fixed",
                                           "prismatic", "floating",   "planar"};
    if (type != nullptr && std::ranges::find(kTypes, type) == std::end(kTypes))
      values.Add(node->GetLineNum(),
                 "type = {} is unknown; allowed are revolute and fixed, and continuous",
                 Quoted(type));
    if (type == nullptr || type == std::string_view("fixed"))
      return KeepOnly(node, {"parent", "child", "origin"});
    KeepOnly(node, {"parent", "child", "origin", "axis", "limit", "dynamics", "mimic"});
    CheckMotion(node, values);
  }

  void CheckMotion(XMLElement* node, const UrdfValues& values) {
    for (const char* once : {"axis", "limit", "dynamics", "mimic"}) AllowOne(*node, once, values);
    if (XMLElement* axis = node->FirstChildElement("axis")) {
      const std::size_t before = problems_->count();
      const Vector3d v = values.Vector(axis, "xyz");
      if (!(v.norm() > 1e-6) && problems_->count() == before)
        values.Add(axis->GetLineNum(), "<axis> = ({}, {}, {}); must not be zero", v.x(), v.y(),
                   v.z());
    }
    XMLElement* limit = node->FirstChildElement("limit");
    if (limit != nullptr) {
      values.Number(limit, "lower", 0.0);
      values.Number(limit, "upper", 0.0);
      if (limit->Attribute("effort") == nullptr) {
        limit->SetAttribute(kLacking, "");
        limit->SetAttribute("effort", "0");
      }
      values.Number(limit, "effort");
    } else {
      limit = node->InsertNewChildElement("limit");
      limit->SetAttribute("effort", "0");
    }
    limit->SetAttribute("velocity", "0");
    if (XMLElement* dynamics = node->FirstChildElement("dynamics")) {
      dynamics->DeleteAttribute("friction");
      if (dynamics->Attribute("damping") == nullptr)
        node->DeleteChild(dynamics);
      else if (const double damping = values.Number(dynamics, "damping"); !(damping >= 0))
        values.Add(dynamics->GetLineNum(), "<dynamics> damping = {:.6g}; must be >= 0", damping);
    }
    XMLElement* mimic = node->FirstChildElement("mimic");
    if (mimic == nullptr) return;
    if (mimic->Attribute("joint") == nullptr)
      return values.Add(mimic->GetLineNum(), "<mimic> joint is missing");
    values.Number(mimic, "multiplier", 1.0);
    values.Number(mimic, "offset", 0.0);
  }

  /// Every link is the child of at most one joint, and all hang from one root.
  void CheckTree() {
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      const JointPlace& joint = joints_[j];
      LinkPlace& child = links_[static_cast<std::size_t>(joint.child)];
      if (child.parent_joint >= 0) {
        problems_->Add(joint.line,
                       "{} is the child of the joints \"{}\" and \"{}\"; allowed is one",
                       LinkElement(child.name),
                       joints_[static_cast<std::size_t>(child.parent_joint)].name, joint.name);
        continue;
      }
      child.parent_joint = static_cast<int>(j);
      links_[static_cast<std::size_t>(joint.parent)].children.push_back(joint.child);
    }
    std::vector<int> open;
    for (std::size_t l = 0; l < links_.size(); ++l)
      if (links_[l].parent_joint < 0) open.push_back(static_cast<int>(l));
    if (open.empty()) return problems_->Add(0, "every link has a parent: there is no root");
    const int root = open.front();
    std::set<int> reached;
    while (!open.empty()) {
      const int l = open.back();
      open.pop_back();
      if (!reached.insert(l).second) continue;
      const std::vector<int>& children = links_[static_cast<std::size_t>(l)].children;
      open.insert(open.end(), children.begin(), children.end());
    }
    const std::string& root_name = links_[static_cast<std::size_t>(root)].name;
    for (std::size_t l = 0; l < links_.size(); ++l) {
      const LinkPlace& link = links_[l];
      if (static_cast<int>(l) != root && link.parent_joint < 0)
        problems_->Add(link.line, "{} is a second root beside \"{}\"; allowed is one root",
                       LinkElement(link.name), root_name);
      else if (!reached.contains(static_cast<int>(l)))
        problems_->Add(link.line, "{} is not connected to the root \"{}\"", LinkElement(link.name),
                       root_name);
    }
  }

  const fs::path& path_;
  Problems* problems_;
  std::vector<LinkPlace> links_;
  std::vector<JointPlace> joints_;
  std::map<std::string, int> link_index_, joint_index_;
  std::set<std::string> guesses_;  // that have been told
};

}  // namespace

void CheckUrdf(const fs::path& path, XMLElement* robot, Problems* problems) {
  WarnOfUnused(*robot, problems);
  Checker(path, problems).Check(robot);
}

}  // namespace regrasp
