#include "core/posture/hand_guess.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/hand/urdf_file.h"
#include "core/posture/finger_name.h"

namespace regrasp {
namespace {

constexpr double kOneSided = 0.2;  // of a range: so much more to one side is where a joint bends to

struct Chain {
  std::vector<int> joints;                                       // that move, root to tip
  int tip = -1;                                                  // link
  Vector3d p_base = Vector3d::Zero(), p_tip = Vector3d::Zero();  // stretched, in the root [m]
};

class Guess {
 public:
  explicit Guess(const std::filesystem::path& path) : problems_(path.string()) {
    file_ = ReadUrdf(path, &problems_);
    problems_.ThrowIfAny();
    pose_.resize(file_.links.size());
    Place(file_.root, Isometry3d::Identity());
  }

  HandGuess Make() {
    FindChains();
    LockWrist();
    for (Chain& chain : chains_) Measure(&chain);
    FindPalm();
    Name();
    SuggestDamping();
    return guess_;
  }

 private:
  const UrdfJoint& joint(int j) const { return file_.joints[static_cast<std::size_t>(j)]; }
  const UrdfLink& link(int l) const { return file_.links[static_cast<std::size_t>(l)]; }
  const Isometry3d& pose(int l) const { return pose_[static_cast<std::size_t>(l)]; }
  bool Moves(int j) const {
    const UrdfJoint::Type type = joint(j).type;
    return type == UrdfJoint::Type::kRevolute || type == UrdfJoint::Type::kContinuous;
  }
  static double Rest(const UrdfJoint& j) {
    return j.lower < j.upper ? std::clamp(0.0, j.lower, j.upper) : 0.0;
  }

  void Place(int l, const Isometry3d& X) {
    pose_[static_cast<std::size_t>(l)] = X;
    for (const int j : link(l).child_joints) {
      Isometry3d child = X * joint(j).X_PJ;
      if (Moves(j)) child.rotate(Eigen::AngleAxisd(Rest(joint(j)), joint(j).axis));
      Place(joint(j).child, child);
    }
  }

  bool MovesMore(int l) const {
    return std::ranges::any_of(link(l).child_joints,
                               [&](int j) { return Moves(j) || MovesMore(joint(j).child); });
  }

  /// The link fixed to `l` whose rounded shapes, or with `boxes` any, reach farthest from `p` [m];
  /// -1 without any.
  int FarthestTip(int l, const Vector3d& p, bool boxes, double* reach) const {
    int best = -1;
    for (const UrdfCollision& c : link(l).collisions) {
      if (c.geometry.kind == UrdfGeometry::Kind::kBox && !boxes) continue;
      const double far = (pose(l) * c.X_LG.translation() - p).norm();
      if (best >= 0 && far <= *reach) continue;
      best = l;
      *reach = std::max(far, *reach);
    }
    for (const int j : link(l).child_joints) {
      const double before = *reach;
      const int other = FarthestTip(joint(j).child, p, boxes, reach);
      if (other >= 0 && (best < 0 || *reach > before)) best = other;
    }
    return best;
  }

  void FindChains() {
    std::vector<std::string> bare;
    for (std::size_t k = 0; k < file_.joints.size(); ++k) {
      const int j = static_cast<int>(k);
      const int end = joint(j).child;
      if (!Moves(j) || MovesMore(end)) continue;
      double reach = 0;
      Chain chain;
      for (const bool boxes : {false, true})
        if (chain.tip < 0) chain.tip = FarthestTip(end, pose(end).translation(), boxes, &reach);
      if (chain.tip < 0) {
        bare.push_back(link(end).name);
        continue;
      }
      for (int up = j; up >= 0; up = link(joint(up).parent).parent_joint)
        if (Moves(up)) chain.joints.insert(chain.joints.begin(), up);
      chains_.push_back(chain);
    }
    if (!bare.empty())
      guess_.notes.push_back(
          fmt::format("no finger ends in {}: no <collision>", fmt::join(bare, ", ")));
    if (chains_.size() < 2 || chains_.size() > std::size_t{kMaxFingers})
      problems_.Add(0,
                    "{} chains end in a link with a <collision>: the fingers; a hand has 2 .. {}{}",
                    chains_.size(), kMaxFingers,
                    bare.empty() ? "" : fmt::format("; without one: {}", fmt::join(bare, ", ")));
    problems_.ThrowIfAny();
  }

  void LockWrist() {
    while (std::ranges::all_of(chains_, [&](const Chain& c) {
      return c.joints.size() > 1 && c.joints.front() == chains_.front().joints.front();
    })) {
      const UrdfJoint& wrist = joint(chains_.front().joints.front());
      guess_.layout.locked[wrist.name] = Rest(wrist);
      guess_.notes.push_back(fmt::format("wrist: {} moves every finger and is locked at {:.1f} deg",
                                         wrist.name, Rest(wrist) * 180 / M_PI));
      for (Chain& c : chains_) c.joints.erase(c.joints.begin());
    }
  }

  void Measure(Chain* chain) const {
    chain->p_base = pose(joint(chain->joints.front()).child).translation();
    const int body = joint(chain->joints.back()).child;
    chain->p_tip = pose(chain->tip).translation();
    // A tip whose frame is its joint: its farthest shape tells.
    for (const UrdfCollision& c : link(chain->tip).collisions) {
      const Vector3d p = pose(chain->tip) * c.X_LG.translation();
      if ((p - pose(body).translation()).norm() > (chain->p_tip - pose(body).translation()).norm())
        chain->p_tip = p;
    }
  }

  /// Where the tip goes as the two outer joints bend, each towards the larger end of its range.
  Vector3d Bending(const Chain& chain) const {
    Vector3d way = Vector3d::Zero();
    const std::size_t n = chain.joints.size();
    for (std::size_t k = n > 2 ? n - 2 : 0; k < n; ++k) {
      const UrdfJoint& j = joint(chain.joints[k]);
      const double more = std::abs(j.upper) - std::abs(j.lower);
      if (std::abs(more) < kOneSided * (j.upper - j.lower) || !(j.lower < j.upper)) continue;
      const Isometry3d& X = pose(j.child);
      Vector3d arm = chain.p_tip - X.translation();
      if (arm.norm() < 5e-3) arm = X.translation() - chain.p_base;
      way += (more > 0 ? 1.0 : -1.0) * (X.linear() * j.axis).cross(arm);
    }
    return way;
  }

  void FindPalm() {
    Vector3d along = Vector3d::Zero(), base = Vector3d::Zero(), tips = Vector3d::Zero();
    for (const Chain& c : chains_) {
      const Vector3d reach = c.p_tip - c.p_base;
      if (reach.norm() > 1e-6) along += reach.normalized();
      base += c.p_base / static_cast<double>(chains_.size());
      tips += c.p_tip / static_cast<double>(chains_.size());
    }
    if (along.norm() < 0.2 * static_cast<double>(chains_.size())) along = tips - base;
    if (along.norm() < 1e-6) along = Vector3d::UnitZ();
    const Vector3d z = along.normalized();
    Vector3d bend = Vector3d::Zero(), strongest = Vector3d::Zero();
    double sum = 0;
    for (const Chain& c : chains_) {
      const Vector3d way = TangentPart(Bending(c), z);
      bend += way;
      sum += way.norm();
      if (way.norm() > strongest.norm()) strongest = way;
    }
    if (bend.norm() < 0.2 * sum) bend = strongest;  // fingers around a centre
    if (bend.norm() < 1e-6) bend = RotationFromZ(z).col(0);
    const Vector3d y = -bend.normalized();
    Isometry3d& X_HR = guess_.layout.X_HR;
    X_HR.linear().row(0) = y.cross(z).transpose();
    X_HR.linear().row(1) = y.transpose();
    X_HR.linear().row(2) = z.transpose();
    X_HR.translation() = -(X_HR.linear() * base);
  }

  /// What the names of a chain agree on.
  std::string KnownName(const Chain& chain) const {
    std::set<std::string> found = {FingerNameIn(link(chain.tip).name)};
    for (const int j : chain.joints) {
      found.insert(FingerNameIn(joint(j).name));
      found.insert(FingerNameIn(link(joint(j).child).name));
    }
    found.erase("");
    return found.size() == 1 ? *found.begin() : "";
  }

  /// The one of four or more fingers that stands apart: stretched it points elsewhere; -1 if none.
  int Apart() const {
    constexpr double kElsewhere = 0.85;  // cosine to the mean of the others
    int apart = -1;
    double least = kElsewhere;
    for (std::size_t f = 0; f < chains_.size() && chains_.size() > 3; ++f) {
      Vector3d others = Vector3d::Zero();
      for (std::size_t k = 0; k < chains_.size(); ++k)
        if (k != f) others += (chains_[k].p_tip - chains_[k].p_base).normalized();
      const double along =
          (chains_[f].p_tip - chains_[f].p_base).normalized().dot(others.normalized());
      if (along >= least) continue;
      least = along;
      apart = static_cast<int>(f);
    }
    return apart;
  }

  void Name() {
    std::vector<std::string> names;
    for (const Chain& c : chains_) names.push_back(KnownName(c));
    const std::set<std::string> distinct(names.begin(), names.end());
    const bool known = distinct.size() == names.size() && !distinct.contains("");
    const auto thumbs = std::ranges::count(names, std::string("thumb"));
    const int apart = Apart();
    int next = 1;
    for (std::size_t f = 0; f < chains_.size(); ++f) {
      const bool thumb = thumbs == 1 ? names[f] == "thumb" : static_cast<int>(f) == apart;
      const std::string name = known ? names[f] : thumb ? "thumb" : fmt::format("finger{}", next++);
      guess_.layout.fingers.push_back({name, link(chains_[f].tip).name});
      std::vector<std::string> joints;
      for (const int j : chains_[f].joints) joints.push_back(joint(j).name);
      guess_.notes.push_back(fmt::format("finger {}: joints {}; tip {}", name,
                                         fmt::join(joints, ", "), link(chains_[f].tip).name));
    }
  }

  /// Damping by the fingers' length. The object's pose is known late (control.pose_filter_s), so
  /// that holding it in place takes damping away, position_stiffness * pose_filter_s = 10 N s/m;
  /// three fingers must give back more, here twice as much, at their tips.
  void SuggestDamping() {
    constexpr double kTipDamping = 2 * 10.0 / 3;  // [N s/m]
    constexpr double kTooLittle = 0.01;           // [N m s/rad]: drops what it holds
    double reach = 0;
    for (const Chain& c : chains_) reach = std::max(reach, (c.p_tip - c.p_base).norm());
    HandLayout& layout = guess_.layout;
    layout.damping = std::max(kDefaultDamping, 1e-3 * std::ceil(1e3 * kTipDamping * reach * reach));
    bool missing = false;
    std::vector<std::string> weak;
    for (const Chain& c : chains_)
      for (const int j : c.joints) {
        missing = missing || !joint(j).damping;
        if (joint(j).damping && *joint(j).damping < kTooLittle) weak.push_back(joint(j).name);
      }
    if (!weak.empty()) layout.least_damping = layout.damping;
    if (missing || !weak.empty())
      guess_.notes.push_back(
          fmt::format("damping: {:g} N m s/rad {}, for fingers of {:.0f} mm", layout.damping,
                      weak.empty() ? "where the file says none" : "at least", 1e3 * reach));
  }

  Problems problems_;
  UrdfFile file_;
  std::vector<Isometry3d> pose_;  // of links in the root, every joint at 0 or its nearest limit
  std::vector<Chain> chains_;
  HandGuess guess_;
};

}  // namespace

HandGuess GuessHand(const std::filesystem::path& urdf_file) { return Guess(urdf_file).Make(); }

}  // namespace regrasp
