#include "core/hand/hand_tree.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/common/count_text.h"
#include "core/common/limits.h"
#include "core/hand/urdf_values.h"

namespace regrasp {
namespace {

using Type = UrdfJoint::Type;

void CheckLimits(const UrdfJoint& joint, const std::string& element, Problems* problems) {
  if (joint.limit_line == 0) {
    // URDF asks it of revolute joints only; the effort of others is as if not filled in.
    if (joint.type == Type::kRevolute)
      problems->Add(joint.line, "{}: <limit> is missing; its effort is needed", element);
    return;
  }
  if (joint.type == Type::kRevolute) {
    for (const auto& [name, value] :
         {std::pair{"lower", joint.lower}, std::pair{"upper", joint.upper}})
      if (!(std::abs(value) <= M_PI))
        problems->Add(joint.limit_line, "{}: <limit> {} [rad] = {:.6g}; allowed {:.6g} .. {:.6g}",
                      element, name, value, -M_PI, M_PI);
    if (!(joint.lower < joint.upper))
      problems->Add(joint.limit_line, "{}: <limit> lower = {:.6g} must be less than upper = {:.6g}",
                    element, joint.lower, joint.upper);
  }
  if (!joint.has_effort) problems->Add(joint.limit_line, "{}: <limit> effort is missing", element);
  if (!(joint.effort >= 0))  // 0 is "not filled in": HandReader takes the default
    problems->Add(joint.limit_line, "{}: <limit> effort [N m] = {:.6g}; must be >= 0", element,
                  joint.effort);
}

}  // namespace

HandTree::Coupling HandTree::CouplingOf(int j) const {
  Coupling c{j, 1, 0};
  for (std::size_t step = 0; step <= file_.joints.size(); ++step) {
    const std::optional<UrdfMimic>& mimic = joint(c.driver).mimic;
    if (!mimic) return c;
    const int next = file_.FindJoint(mimic->joint);
    if (next < 0) break;
    c = {next, c.ratio * mimic->multiplier, c.ratio * mimic->offset + c.offset};
  }
  return {-1, 1, 0};
}

std::string HandTree::RatioFault(double ratio) {
  constexpr double kLeast = 1e-3, kMost = 100;
  if (std::abs(ratio) >= kLeast && std::abs(ratio) <= kMost) return "";
  return fmt::format("= {:.6g}; allowed are sizes of {} .. {}", ratio, kLeast, kMost);
}

std::vector<int> HandTree::JointsTo(int to) const {
  std::vector<int> chain;
  for (int j = link(to).parent_joint; j >= 0; j = link(joint(j).parent).parent_joint)
    if (!LockedAt(j)) chain.push_back(j);
  std::ranges::reverse(chain);
  return chain;
}

std::vector<int> HandTree::DriversTo(int to) const {
  std::vector<int> drivers;
  for (const int j : JointsTo(to)) {
    const int driver = CouplingOf(j).driver;
    if (std::ranges::find(drivers, driver) == drivers.end()) drivers.push_back(driver);
  }
  return drivers;
}

std::string HandTree::FingerFault(std::size_t drivers, const std::string& tip_link) {
  if (drivers > 0 && drivers <= std::size_t{kMaxFingerJoints}) return "";
  return fmt::format("{} between root and \"{}\", coupled ones not counted; allowed 1 .. {}",
                     CountText(drivers, "revolute joint"), tip_link, kMaxFingerJoints);
}

std::size_t HandTree::FingersBelow(int j) const {
  std::size_t count = 0;
  for (const HandLayout::Finger& finger : layout_.fingers) {
    int up = file_.FindLink(finger.tip_link);
    up = up < 0 ? -1 : link(up).parent_joint;
    while (up >= 0 && up != j) up = link(joint(up).parent).parent_joint;
    count += up == j;
  }
  return count;
}

bool HandTree::IsHeld(int j) const {
  if (joint(j).type != Type::kPrismatic && joint(j).type != Type::kOther) return false;
  const std::size_t moved = FingersBelow(j);
  return moved == 0 || (moved > 1 && moved == layout_.fingers.size());
}

std::optional<double> HandTree::LockedAt(int j) const {
  if (joint(j).type == Type::kFixed || IsHeld(j)) return 0.0;
  const auto own = layout_.locked.find(joint(j).name);
  if (own != layout_.locked.end()) return own->second;
  if (!joint(j).mimic) return {};
  const Coupling c = CouplingOf(j);
  if (c.driver < 0) return {};
  if (joint(c.driver).type == Type::kFixed || IsHeld(c.driver)) return c.offset;
  const auto driver = layout_.locked.find(joint(c.driver).name);
  if (driver == layout_.locked.end()) return {};
  return c.ratio * driver->second + c.offset;
}

Isometry3d HandTree::PoseAt(int j, double angle) const {
  Isometry3d X = joint(j).X_PJ;
  if (joint(j).type != Type::kFixed)
    X.linear() = X.linear() * Eigen::AngleAxisd(angle, joint(j).axis).toRotationMatrix();
  return X;
}

bool HandTree::IsBelow(int l, int above) const {
  while (l != above && link(l).parent_joint >= 0) l = joint(link(l).parent_joint).parent;
  return l == above;
}

int HandTree::Palm() const {
  int palm = -1;
  for (const HandLayout::Finger& finger : layout_.fingers) {
    const int tip = file_.FindLink(finger.tip_link);
    const std::vector<int> joints = tip < 0 ? std::vector<int>() : JointsTo(tip);
    if (joints.empty()) continue;
    int base = joint(joints.front()).parent;
    if (palm < 0) palm = base;
    while (!IsBelow(palm, base)) base = joint(link(base).parent_joint).parent;
    palm = base;
  }
  return palm < 0 ? file_.root : palm;
}

void HandTree::AddBodyOf(int link_index, std::set<int>* group) const {
  int up = link(link_index).parent_joint;
  while (up >= 0 && LockedAt(up)) {
    link_index = joint(up).parent;
    up = link(link_index).parent_joint;
  }
  AddFixed(link_index, group);
}

void HandTree::AddFixed(int link_index, std::set<int>* group) const {
  group->insert(link_index);
  for (const int j : link(link_index).child_joints)
    if (LockedAt(j)) AddFixed(joint(j).child, group);
}

void HandTree::CheckMimic(int j, Problems* problems) const {
  const UrdfJoint& in = joint(j);
  const std::string element = JointElement(in.name);
  if (file_.FindJoint(in.mimic->joint) < 0) {
    problems->Add(in.line, "{}: <mimic> joint = {}: there is no such joint", element,
                  Quoted(in.mimic->joint));
    return;
  }
  const Coupling c = CouplingOf(j);
  if (c.driver < 0)
    problems->Add(in.line, "{}: <mimic> leads in a ring or to a joint that is not there", element);
  else if (const std::string fault = RatioFault(c.ratio); !fault.empty())
    problems->Add(in.line, "{}: <mimic> multiplier {}", element, fault);
}

void HandTree::Check(Problems* problems) const {
  for (std::size_t k = 0; k < file_.joints.size(); ++k) {
    const UrdfJoint& in = file_.joints[k];
    const std::string element = JointElement(in.name);
    if (in.type == Type::kFixed) continue;
    if (in.type != Type::kRevolute && in.type != Type::kContinuous) {
      const std::string type = in.type_name.substr(0, 40);
      if (IsHeld(static_cast<int>(k)))
        problems->Warn(
            in.line, element,
            fmt::format("type \"{}\" is not simulated; it moves {} and is held at 0", type,
                        FingersBelow(static_cast<int>(k)) > 0 ? "every finger" : "no finger"));
      else
        problems->Add(
            in.line,
            "{}: type \"{}\" moves some fingers and is not supported; allowed are revolute "
            "and fixed, and continuous",
            element, type);
      continue;
    }
    if (in.mimic) {
      CheckMimic(static_cast<int>(k), problems);
      continue;
    }
    if (layout_.locked.contains(in.name)) continue;
    CheckLimits(in, element, problems);
  }
  for (const auto& [name, coupling] : layout_.coupled)
    if (file_.FindJoint(name) < 0)
      problems->Add(0, "the scenario couples {}: there is no such joint", JointElement(name));
  for (const auto& [name, angle] : layout_.locked)
    if (file_.FindJoint(name) < 0)
      problems->Add(0, "the scenario locks {}: there is no such joint", JointElement(name));
  for (const auto& finger : layout_.fingers) {
    if (file_.FindLink(finger.tip_link) >= 0) continue;
    std::set<std::string> names;
    for (const UrdfLink& link : file_.links) names.insert(link.name);
    std::string list;
    for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
    problems->Add(0, "finger \"{}\": there is no link \"{}\"; links are {}", finger.name,
                  finger.tip_link, list);
  }
}

}  // namespace regrasp
