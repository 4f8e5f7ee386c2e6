#include <algorithm>
#include <map>
#include <optional>

#include "core/hand/body_check.h"
#include "core/hand/fingertips.h"
#include "core/hand/hand_shapes.h"
#include "core/hand/hand_tree.h"
#include "core/hand/joint_numbers.h"
#include "core/hand/joint_values.h"
#include "core/hand/link_body.h"
#include "core/hand/problems.h"
#include "core/hand/urdf.h"
#include "core/hand/urdf_file.h"

namespace regrasp {
namespace {

/// Walks the URDF's tree. Bodies joined by fixed joints become one link.
class HandReader {
 public:
  HandReader(const std::filesystem::path& path, const HandLayout& layout,
             const LoadOptions& options, ModelReport* report)
      : problems_(path.string(), report),
        file_(ReadUrdf(path, &problems_)),
        tree_(file_, layout),
        layout_(layout),
        options_(options),
        shapes_(file_, options, &problems_, report),
        values_(layout, &problems_) {}

  HandModel Read() {
    problems_.ThrowIfAny();
    hand_.name = file_.name;
    for (const auto& [name, coupling] : layout_.coupled)
      if (const int j = file_.FindJoint(name); j >= 0)
        file_.joints[static_cast<std::size_t>(j)].mimic = {coupling.driver, coupling.ratio,
                                                           coupling.offset};
    tree_.Check(&problems_);
    problems_.ThrowIfAny();
    CheckLengths();
    fingertips_.emplace(tree_, layout_);
    palm_ = tree_.Palm();
    StartLink(file_.root, -1, layout_.X_HR);
    for (const auto& finger : layout_.fingers) ReadFinger(finger);
    ReadRest(file_.root);
    CheckCounts();
    CheckBodies(file_, lacking_, options_, &hand_, &problems_);
    problems_.ThrowIfAny();
    NumberJoints(tree_, order_, &hand_, &problems_);
    for (std::size_t f = 0; f < layout_.fingers.size(); ++f) FindFingertip(f);
    problems_.ThrowIfAny();
    values_.TellDefaults();
    return std::move(hand_);
  }

 private:
  struct Frame {
    int link = -1;
    Isometry3d X_LG = Isometry3d::Identity();
  };

  const UrdfJoint& JointAt(int j) const { return tree_.joint(j); }
  const UrdfLink& LinkAt(int l) const { return tree_.link(l); }

  /// Makes a new link of `in` and all that is fixed to it.
  void StartLink(int in, int parent_joint, const Isometry3d& X_LG) {
    Link link;
    link.name = LinkAt(in).name;
    link.parent_joint = parent_joint;
    hand_.links.push_back(link);
    shape_origin_.emplace_back();
    Merge(in, X_LG, static_cast<int>(hand_.links.size()) - 1);
  }

  void Merge(int in, const Isometry3d& X_LG, int link) {
    AddBody(LinkAt(in), X_LG, &hand_.links[static_cast<std::size_t>(link)]);
    if (LinkAt(in).inertial && !WhatLacks(*LinkAt(in).inertial).empty())
      lacking_.emplace(link, &LinkAt(in));
    for (const Shape& shape : shapes_.Read(LinkAt(in), X_LG, RoleOf(in))) {
      hand_.links[static_cast<std::size_t>(link)].shapes.push_back(shape);
      shape_origin_[static_cast<std::size_t>(link)].push_back(in);
    }
    frames_[in] = {link, X_LG};
    for (const int j : LinkAt(in).child_joints)
      if (const auto angle = tree_.LockedAt(j))
        Merge(JointAt(j).child, X_LG * tree_.PoseAt(j, *angle), link);
  }

  LinkRole RoleOf(int in) const {
    if (fingertips_->MayBe(in)) return LinkRole::kFingertip;
    return tree_.IsBelow(in, palm_) ? LinkRole::kOther : LinkRole::kStand;
  }

  void AddBody(const UrdfLink& in, const Isometry3d& X_LG, Link* link) {
    if (in.inertial && in.inertial->mass < 0)
      problems_.Add(in.inertial->line, "{}: <mass> = {:.6g}; must be > 0", LinkElement(in.name),
                    in.inertial->mass);
    else if (in.inertial)
      AddBodyTo(link, *in.inertial, X_LG);
  }

  /// What joints are told in another unit.
  void CheckLengths() {
    constexpr double kFarthest = 2;        // [m]
    constexpr double kFarthestFixed = 10;  // [m]: a hand may stand in a room
    for (const UrdfJoint& joint : file_.joints) {
      const double most = joint.type == UrdfJoint::Type::kFixed ? kFarthestFixed : kFarthest;
      if (const double far = joint.X_PJ.translation().norm(); far > most)
        problems_.Add(joint.line,
                      "{}: <origin> is {:.4g} m from the parent link; allowed are at most {:g} m; "
                      "lengths are in metres",
                      JointElement(joint.name), far, most);
    }
  }

  bool Added(int joint) const { return std::ranges::find(order_, joint) != order_.end(); }

  void AddJoint(int j) {
    const UrdfJoint& in = JointAt(j);
    const Frame parent = frames_.at(in.parent);
    Joint joint;
    joint.name = in.name;
    joint.parent_link = parent.link;
    joint.child_link = static_cast<int>(hand_.links.size());
    joint.X_PJ = parent.X_LG * in.X_PJ;
    joint.axis_J = in.axis;
    values_.Fill(in, &joint);
    order_.push_back(j);
    hand_.joints.push_back(joint);
    StartLink(in.child, j, Isometry3d::Identity());
  }

  void ReadFinger(const HandLayout::Finger& layout) {
    Finger finger;
    finger.name = layout.name;
    const int tip = file_.FindLink(layout.tip_link);
    finger.joints = tree_.DriversTo(tip);  // of the URDF until NumberJoints()
    if (const std::string fault = HandTree::FingerFault(finger.joints.size(), layout.tip_link);
        !fault.empty()) {
      problems_.Add(0, "finger \"{}\": {}", layout.name, fault);
      problems_.ThrowIfAny();
    }
    for (const int j : tree_.JointsTo(tip))
      if (!Added(j)) AddJoint(j);
    finger.tip_link = frames_.at(tip).link;
    hand_.fingers.push_back(finger);
  }

  /// Joints that belong to no finger.
  void ReadRest(int link) {
    for (const int j : LinkAt(link).child_joints) {
      if (!tree_.LockedAt(j) && !Added(j)) AddJoint(j);
      ReadRest(JointAt(j).child);
    }
  }

  void CheckCounts() {
    if (hand_.joints.empty()) problems_.Add(0, "the hand has no revolute joint");
    if (hand_.joints.size() > std::size_t{kMaxJoints})
      problems_.Add(0,
                    "{} joints, coupled ones too: more than {} revolute joints that are not locked",
                    hand_.joints.size(), kMaxJoints);
  }

  void FindFingertip(std::size_t f) {
    const std::string& tip_link = layout_.fingers[f].tip_link;
    Finger& finger = hand_.fingers[f];
    const auto l = static_cast<std::size_t>(finger.tip_link);
    if (!fingertips_->Find(f, frames_.at(file_.FindLink(tip_link)).X_LG, shape_origin_[l],
                           &hand_.links[l], &finger))
      problems_.Add(BodyLine(LinkAt(file_.FindLink(hand_.links[l].name))),
                    "finger \"{}\": tip {} must have a <collision>", finger.name,
                    LinkElement(hand_.links[l].name));
  }

  Problems problems_;
  UrdfFile file_;
  HandTree tree_;
  const HandLayout& layout_;
  const LoadOptions& options_;
  HandShapes shapes_;
  int palm_ = 0;
  JointValues values_;
  std::optional<Fingertips> fingertips_;
  HandModel hand_;
  std::map<int, Frame> frames_;                 // by URDF link: our link that carries it, and where
  std::vector<int> order_;                      // of hand_.joints, as URDF joints
  std::map<int, const UrdfLink*> lacking_;      // by link: CheckBodies
  std::vector<std::vector<int>> shape_origin_;  // by link and shape: URDF link
};

}  // namespace

HandModel LoadHand(const std::filesystem::path& urdf_file, const HandLayout& layout,
                   const LoadOptions& options, ModelReport* report) {
  return HandReader(urdf_file, layout, options, report).Read();
}

}  // namespace regrasp
