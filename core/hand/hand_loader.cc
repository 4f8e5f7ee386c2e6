#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/hand/hand_shapes.h"
#include "core/hand/hand_tree.h"
#include "core/hand/link_body.h"
#include "core/hand/problems.h"
#include "core/hand/solid.h"
#include "core/hand/urdf.h"
#include "core/hand/urdf_file.h"

namespace regrasp {
namespace {

/// Walks the URDF's tree. Bodies joined by fixed joints become one link.
class HandReader {
 public:
  HandReader(const std::filesystem::path& path, const HandLayout& layout,
             const LoadOptions& options, ModelReport* report)
      : problems_(path.string()),
        file_(ReadUrdf(path, &problems_)),
        tree_(file_, layout),
        layout_(layout),
        options_(options),
        report_(report),
        shapes_(file_, options, &problems_, report) {}

  HandModel Read() {
    problems_.ThrowIfAny();
    hand_.name = file_.name;
    for (const auto& [name, coupling] : layout_.coupled)
      if (const int j = file_.FindJoint(name); j >= 0)
        file_.joints[static_cast<std::size_t>(j)].mimic = {coupling.driver, coupling.ratio,
                                                           coupling.offset};
    tree_.Check(&problems_);
    problems_.ThrowIfAny();
    FindTips();
    StartLink(file_.root, -1, layout_.X_HR);
    for (const auto& finger : layout_.fingers) ReadFinger(finger);
    ReadRest(file_.root);
    CheckCounts();
    CheckBodies();
    problems_.ThrowIfAny();
    Number();
    for (std::size_t f = 0; f < layout_.fingers.size(); ++f) FindFingertip(f);
    problems_.ThrowIfAny();
    TellDefaults();
    return std::move(hand_);
  }

 private:
  using Type = UrdfJoint::Type;
  struct Frame {
    int link = -1;
    Isometry3d X_LG = Isometry3d::Identity();
  };

  const UrdfJoint& JointAt(int j) const { return tree_.joint(j); }
  const UrdfLink& LinkAt(int l) const { return tree_.link(l); }

  void Warn(int line, const std::string& element, std::string text) {
    if (report_) report_->warnings.push_back({problems_.file(), line, element, std::move(text)});
  }

  void TellDefaults() {
    const auto tell = [&](const std::vector<std::string>& joints, const char* what, double taken,
                          const char* unit) {
      if (!joints.empty())
        Warn(0, "",
             fmt::format("{} for {} joints ({}); {:g} {} is taken", what, joints.size(),
                         fmt::join(joints, ", "), taken, unit));
    };
    tell(undamped_, "<dynamics damping> is missing", layout_.damping, "N m s/rad");
    tell(raised_, "<dynamics damping> is less than the scenario's least", layout_.least_damping,
         "N m s/rad");
    tell(unpowered_, "<limit> effort is 0", kDefaultEffort, "N m");
  }

  bool HasRounded(int link) const {
    return std::ranges::any_of(LinkAt(link).collisions, [](const UrdfCollision& c) {
      return c.geometry.kind != UrdfGeometry::Kind::kBox;
    });
  }

  /// The URDF links whose shapes may be fingertips: each tip link, or where it is a frame without
  /// shape, all that it is fixed to. Boxes count where there is nothing rounded.
  void FindTips() {
    for (const auto& finger : layout_.fingers) {
      const int tip = file_.FindLink(finger.tip_link);
      std::set<int> group;
      if (!LinkAt(tip).collisions.empty())
        group.insert(tip);
      else
        tree_.AddBodyOf(tip, &group);
      tip_groups_.push_back(group);
      const bool rounded = std::ranges::any_of(group, [&](int l) { return HasRounded(l); });
      for (const int l : group)
        if (!rounded || HasRounded(l)) tips_.insert(l);
    }
  }

  /// Makes a new link of `in` and all that is fixed to it.
  void StartLink(int in, int parent_joint, const Isometry3d& X_LG) {
    Link link;
    link.name = LinkAt(in).name;
    link.parent_joint = parent_joint;
    hand_.links.push_back(link);
    line_of_link_.push_back(LinkAt(in).inertial ? LinkAt(in).inertial->inertia_line
                                                : LinkAt(in).line);
    shape_origin_.emplace_back();
    Merge(in, X_LG, static_cast<int>(hand_.links.size()) - 1);
  }

  void Merge(int in, const Isometry3d& X_LG, int link) {
    AddBody(LinkAt(in), X_LG, &hand_.links[static_cast<std::size_t>(link)]);
    for (const Shape& shape : shapes_.Read(LinkAt(in), X_LG, tips_.contains(in))) {
      hand_.links[static_cast<std::size_t>(link)].shapes.push_back(shape);
      shape_origin_[static_cast<std::size_t>(link)].push_back(in);
    }
    frames_[in] = {link, X_LG};
    for (const int j : LinkAt(in).child_joints)
      if (const auto angle = tree_.LockedAt(j))
        Merge(JointAt(j).child, X_LG * tree_.PoseAt(j, *angle), link);
  }

  /// Adds the body of `in`, which is fixed to `link` at X_LG. Whether the sum can be a body is
  /// checked when it is complete: frames without mass are common.
  void AddBody(const UrdfLink& in, const Isometry3d& X_LG, Link* link) {
    if (!in.inertial) return;
    if (in.second_inertial_line > 0)
      Warn(in.second_inertial_line, LinkElement(in.name), "a second <inertial> is not read");
    const UrdfInertial& body = *in.inertial;
    if (body.mass < 0) {
      problems_.Add(body.line, "{}: <mass> = {:.6g}; must be > 0", LinkElement(in.name), body.mass);
      return;
    }
    AddBodyTo(link, body, X_LG);
  }

  void AddJoint(int j) {
    const UrdfJoint& in = JointAt(j);
    const std::string element = JointElement(in.name);
    const Frame parent = frames_.at(in.parent);
    Joint joint;
    joint.name = in.name;
    joint.parent_link = parent.link;
    joint.child_link = static_cast<int>(hand_.links.size());
    joint.X_PJ = parent.X_LG * in.X_PJ;
    joint.axis_J = in.axis;
    const bool whole_turn = in.type == Type::kContinuous;
    joint.lower = whole_turn ? -M_PI : in.lower;
    joint.upper = whole_turn ? M_PI : in.upper;
    if (in.mimic && !(in.lower < in.upper)) {  // its driver's limits are its own
      joint.lower = -2 * M_PI;
      joint.upper = 2 * M_PI;
    }
    joint.effort = in.effort;
    if (in.effort == 0 && !in.mimic) {
      joint.effort = kDefaultEffort;
      unpowered_.push_back(in.name);
    }
    joint.armature = layout_.armature;
    joint.damping = in.damping.value_or(layout_.damping);
    if (joint.damping < layout_.least_damping) {
      joint.damping = layout_.least_damping;
      raised_.push_back(in.name);
    }
    if (whole_turn)
      Warn(in.line, element, "a continuous joint is kept within half a turn to either side");
    if (!in.damping) undamped_.push_back(in.name);
    order_.push_back(j);
    joint_index_[j] = static_cast<int>(hand_.joints.size());
    hand_.joints.push_back(joint);
    StartLink(in.child, j, Isometry3d::Identity());
  }

  void ReadFinger(const HandLayout::Finger& layout) {
    Finger finger;
    finger.name = layout.name;
    std::vector<int> chain;
    const int tip = file_.FindLink(layout.tip_link);
    for (int joint = LinkAt(tip).parent_joint; joint >= 0;
         joint = LinkAt(JointAt(joint).parent).parent_joint)
      if (!tree_.LockedAt(joint)) chain.push_back(joint);
    std::reverse(chain.begin(), chain.end());
    for (const int j : chain) {
      const int driver = tree_.CouplingOf(j).driver;
      if (std::ranges::find(finger.joints, driver) == finger.joints.end())
        finger.joints.push_back(driver);  // of the URDF until Number()
    }
    if (finger.joints.empty() || finger.joints.size() > std::size_t{kMaxFingerJoints}) {
      problems_.Add(0, "finger \"{}\": {} revolute joints between root and \"{}\"; allowed 1 .. {}",
                    layout.name, finger.joints.size(), layout.tip_link, kMaxFingerJoints);
      problems_.ThrowIfAny();
    }
    for (const int j : chain)
      if (!joint_index_.contains(j)) AddJoint(j);
    finger.tip_link = frames_.at(tip).link;
    hand_.fingers.push_back(finger);
  }

  /// Joints that belong to no finger.
  void ReadRest(int link) {
    for (const int j : LinkAt(link).child_joints) {
      if (!tree_.LockedAt(j) && !joint_index_.contains(j)) AddJoint(j);
      ReadRest(JointAt(j).child);
    }
  }

  void CheckCounts() {
    if (hand_.joints.empty()) problems_.Add(0, "the hand has no revolute joint");
    if (hand_.joints.size() > std::size_t{kMaxJoints})
      problems_.Add(0, "more than {} revolute joints", kMaxJoints);
  }

  void CheckBodies() {
    for (std::size_t l = 1; l < hand_.links.size(); ++l) {
      Link& link = hand_.links[l];
      const int line = line_of_link_[l];
      const bool told = LinkAt(file_.FindLink(link.name)).inertial.has_value();
      const std::string why = WhyNoBody(link, told);
      const std::string element = LinkElement(link.name);
      if (why.empty()) {
        if (const std::string doubt = WhyUnlikely(link); !doubt.empty()) Warn(line, element, doubt);
        continue;
      }
      if (!options_.inertia_from_shape) {
        problems_.Add(line, "{}: {}; --inertia-from-shape computes what is missing", element, why);
        continue;
      }
      InventBody(&link);
      Warn(line, element,
           fmt::format("{}; {:.3g} g with the inertia of its shape taken", why, 1e3 * link.mass));
    }
  }

  /// Puts driven joints before coupled ones and turns every reference into the final numbers.
  void Number() {
    std::map<int, int> final;  // by URDF joint
    std::vector<Joint> joints;
    for (const bool coupled : {false, true})
      for (const int j : order_) {
        if ((tree_.CouplingOf(j).driver != j) != coupled) continue;
        final[j] = static_cast<int>(joints.size());
        joints.push_back(hand_.joints[static_cast<std::size_t>(joint_index_.at(j))]);
        if (!coupled) continue;
        ++hand_.num_coupled;
        const HandTree::Coupling c = tree_.CouplingOf(j);
        joints.back().driver = final.at(c.driver);
        joints.back().ratio = c.ratio;
        joints.back().offset = c.offset;
        Narrow(joints.back(), &joints[static_cast<std::size_t>(joints.back().driver)]);
      }
    hand_.joints = std::move(joints);
    for (Link& link : hand_.links)
      if (link.parent_joint >= 0) link.parent_joint = final.at(link.parent_joint);
    for (Finger& finger : hand_.fingers)
      for (int& joint : finger.joints) joint = final.at(joint);
  }

  /// A driver goes no farther than what follows it may.
  void Narrow(const Joint& coupled, Joint* driver) {
    if (!(coupled.lower < coupled.upper)) return;
    double low = (coupled.lower - coupled.offset) / coupled.ratio;
    double high = (coupled.upper - coupled.offset) / coupled.ratio;
    if (low > high) std::swap(low, high);
    low = std::max(low, driver->lower);
    high = std::min(high, driver->upper);
    if (!(low < high)) {
      problems_.Add(0, "{}: its limits and those of {}, which it follows, have nothing in common",
                    JointElement(coupled.name), JointElement(driver->name));
      return;
    }
    constexpr double kSaid = 0.01;  // [rad]
    if (low > driver->lower + kSaid || high < driver->upper - kSaid)
      Warn(0, JointElement(driver->name),
           fmt::format("limits narrowed to {:.4g} .. {:.4g} rad by {}", low, high,
                       JointElement(coupled.name)));
    driver->lower = low;
    driver->upper = high;
  }

  /// Puts the fingertip's shape first among its link's.
  void FindFingertip(std::size_t f) {
    const HandLayout::Finger& layout = layout_.fingers[f];
    Finger& finger = hand_.fingers[f];
    Link& link = hand_.links[static_cast<std::size_t>(finger.tip_link)];
    const Frame frame = frames_.at(file_.FindLink(layout.tip_link));
    const bool is_frame = LinkAt(file_.FindLink(layout.tip_link)).collisions.empty();
    const Vector3d p_tip = frame.X_LG.translation();
    const auto& origin = shape_origin_[static_cast<std::size_t>(finger.tip_link)];
    int best = -1;
    double best_score = 0;
    for (std::size_t s = 0; s < link.shapes.size(); ++s) {
      Shape& shape = link.shapes[s];
      if (shape.kind != Shape::Kind::kCapsule || !tip_groups_[f].contains(origin[s])) continue;
      const auto score = [&](const Vector3d& end) {
        return is_frame && p_tip.norm() > 1e-3 ? shape.radius - (end - p_tip).norm()
                                               : end.norm() + shape.radius;
      };
      if (score(shape.a_L) > score(shape.b_L)) std::swap(shape.a_L, shape.b_L);
      if (best >= 0 && score(shape.b_L) <= best_score) continue;
      best = static_cast<int>(s);
      best_score = score(shape.b_L);
    }
    if (best < 0) {
      problems_.Add(line_of_link_[static_cast<std::size_t>(finger.tip_link)],
                    "finger \"{}\": tip {} must have a <collision>", layout.name,
                    LinkElement(link.name));
      return;
    }
    std::rotate(link.shapes.begin(), link.shapes.begin() + best, link.shapes.begin() + best + 1);
    finger.p_LF = link.shapes.front().b_L;
    finger.tip_radius = link.shapes.front().radius;
  }

  Problems problems_;
  UrdfFile file_;
  HandTree tree_;
  const HandLayout& layout_;
  const LoadOptions& options_;
  ModelReport* report_;
  HandShapes shapes_;
  HandModel hand_;
  std::map<int, Frame> frames_;     // by URDF link: our link that carries it, and where
  std::map<int, int> joint_index_;  // URDF joint: place in hand_.joints
  std::vector<int> order_;          // of hand_.joints, as URDF joints
  std::vector<int> line_of_link_;
  std::vector<std::vector<int>> shape_origin_;  // by link and shape: URDF link
  std::vector<std::set<int>> tip_groups_;       // by finger: URDF links of its fingertip's shapes
  std::set<int> tips_;
  std::vector<std::string> undamped_, raised_, unpowered_;  // names of joints, for warnings
};

}  // namespace

HandModel LoadHand(const std::filesystem::path& urdf_file, const HandLayout& layout,
                   const LoadOptions& options, ModelReport* report) {
  return HandReader(urdf_file, layout, options, report).Read();
}

}  // namespace regrasp
