#include "core/posture/hand_guess.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/hand/urdf_file.h"
#include "core/posture/finger_chains.h"
#include "core/posture/finger_name.h"
#include "core/posture/palm_frame.h"

namespace regrasp {
namespace {

class Guess {
 public:
  explicit Guess(const std::filesystem::path& path)
      : problems_(path.string()), file_(Checked(path)), hand_(file_) {}

  HandGuess Make() {
    FindFingers();
    LockWrist();
    for (FingerChain& chain : chains_) Measure(hand_, &chain);
    FindPalm();
    Name();
    SuggestDamping();
    return guess_;
  }

 private:
  UrdfFile Checked(const std::filesystem::path& path) {
    UrdfFile file = ReadUrdf(path, &problems_);
    problems_.ThrowIfAny();
    return file;
  }
  const UrdfJoint& joint(int j) const { return hand_.joint(j); }
  const UrdfLink& link(int l) const { return hand_.link(l); }

  void FindFingers() {
    std::vector<std::string> bare;
    chains_ = FindFingerChains(hand_, &bare);
    if (!bare.empty())
      guess_.notes.push_back(
          fmt::format("no finger ends in {}: no <collision>", fmt::join(bare, ", ")));
    std::vector<std::string> sliding;
    for (int j = 0; j < hand_.num_joints() && chains_.size() < 2; ++j)
      if (!hand_.Moves(j) && joint(j).type != UrdfJoint::Type::kFixed)
        sliding.push_back(fmt::format("{} ({})", joint(j).name, joint(j).type_name.substr(0, 40)));
    if (!sliding.empty())
      problems_.Add(0, "joints that are not revolute move nothing here: {}; a finger must turn",
                    fmt::join(sliding, ", "));
    if (chains_.size() < 2)
      problems_.Add(0,
                    "{} chains end in a link with a <collision>: the fingers; a hand has 2 .. {}{}",
                    chains_.size(), kMaxFingers,
                    bare.empty() ? ""
                                 : fmt::format("; without one: {} (a <visual> is not read: copy it "
                                               "into a <collision>)",
                                               fmt::join(bare, ", ")));
    problems_.ThrowIfAny();
    CheckOneHand();
  }

  std::string TipsOf(const std::vector<FingerChain>& chains) const {
    std::vector<std::string> tips;
    for (const FingerChain& chain : chains) tips.push_back(link(chain.tip).name);
    return fmt::format("{}", fmt::join(tips, ", "));
  }

  /// A robot with two hands is no hand with the fingers of both; nor is one with legs.
  void CheckOneHand() {
    std::vector<FingerChain> chains = chains_;
    TakeWrist(&chains);
    const std::vector<FingerGroup> groups = FindGroups(hand_, chains);
    const bool many = chains_.size() > std::size_t{kMaxFingers};
    if (!many && groups.size() < 2) return;
    std::string hands;
    for (const FingerGroup& group : groups)
      hands += fmt::format("{}{} (fingers end in {})", hands.empty() ? "" : "; ",
                           LinkElement(link(group.palm).name), TipsOf(group.chains));
    const std::string count =
        many ? fmt::format(
                   "{} chains end in a link with a <collision>: the fingers; a hand has "
                   "2 .. {}; ",
                   chains_.size(), kMaxFingers)
             : "";
    if (groups.empty())
      problems_.Add(0, "{}they end in {}; take out of the file what is not of the hand", count,
                    TipsOf(chains_));
    else
      problems_.Add(0,
                    "{}{}: {}; write a file of one hand: {} as its root, with all that hangs "
                    "from it",
                    count, groups.size() > 1 ? "more than one hand" : "what may be the hand", hands,
                    groups.size() > 1 ? "one of these links" : "this link");
    problems_.ThrowIfAny();
  }

  void LockWrist() {
    for (const int j : TakeWrist(&chains_)) {
      guess_.layout.locked[joint(j).name] = hand_.Angle(j);
      guess_.notes.push_back(fmt::format("wrist: {} moves every finger and is locked at {:.1f} deg",
                                         joint(j).name, hand_.Angle(j) * 180 / M_PI));
    }
  }

  void FindPalm() {
    bool guessed = false;
    guess_.layout.X_HR = PalmFrame(hand_, chains_, &guessed);
    if (guessed)
      guess_.notes.emplace_back(
          "palm: its side is guessed from where the fingers stand: no joint's limits tell where "
          "they bend to; hand new writes it to [palm], where it can be changed");
  }

  /// What the names of a chain agree on.
  std::string KnownName(const FingerChain& chain) const {
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
        if (k != f) others += chains_[k].reach().normalized();
      const double along = chains_[f].reach().normalized().dot(others.normalized());
      if (along >= least) continue;
      least = along;
      apart = static_cast<int>(f);
    }
    return apart;
  }

  void Name() {
    std::vector<std::string> names;
    for (const FingerChain& c : chains_) names.push_back(KnownName(c));
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
    for (const FingerChain& c : chains_) reach = std::max(reach, c.reach().norm());
    HandLayout& layout = guess_.layout;
    layout.damping = std::max(kDefaultDamping, 1e-3 * std::ceil(1e3 * kTipDamping * reach * reach));
    bool missing = false;
    std::vector<std::string> weak;
    for (const FingerChain& c : chains_)
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
  HandAtRest hand_;
  std::vector<FingerChain> chains_;
  HandGuess guess_;
};

}  // namespace

HandGuess GuessHand(const std::filesystem::path& urdf_file) { return Guess(urdf_file).Make(); }

}  // namespace regrasp
