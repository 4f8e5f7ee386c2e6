#pragma once

/// The fingers of a hand that nobody has described: the chains of joints that its file has. Used
/// only by hand_guess.cc and palm_frame.cc.

#include <string>
#include <vector>

#include "core/hand/urdf_file.h"

namespace regrasp {

/// A hand's file with every joint at 0, or at its limit nearest to that.
class HandAtRest {
 public:
  /// Keeps `file` by reference.
  explicit HandAtRest(const UrdfFile& file);

  int num_joints() const { return static_cast<int>(file_.joints.size()); }
  const UrdfJoint& joint(int j) const { return file_.joints[static_cast<std::size_t>(j)]; }
  const UrdfLink& link(int l) const { return file_.links[static_cast<std::size_t>(l)]; }
  /// Of a link in the root.
  const Isometry3d& pose(int l) const { return pose_[static_cast<std::size_t>(l)]; }
  bool Moves(int j) const;
  /// [rad]
  double Angle(int j) const;

 private:
  void Place(int l, const Isometry3d& X);

  const UrdfFile& file_;
  std::vector<Isometry3d> pose_;
};

struct FingerChain {
  std::vector<int> joints;                                       ///< that move, root to tip
  int tip = -1;                                                  ///< link
  Vector3d p_base = Vector3d::Zero(), p_tip = Vector3d::Zero();  ///< stretched, in the root [m]
  Vector3d reach() const { return p_tip - p_base; }
};

/// Every chain that ends in a link with a <collision>. `bare`: the last links of the others.
std::vector<FingerChain> FindFingerChains(const HandAtRest& hand, std::vector<std::string>* bare);

/// Takes the joints that move every finger off the chains, as long as each keeps one. Returns them.
std::vector<int> TakeWrist(std::vector<FingerChain>* chains);

/// The link that carries several of the fingers, which a joint moves together, and not the others.
struct FingerGroup {
  int palm = -1;                    ///< link
  std::vector<FingerChain> chains;  ///< two or more
};

/// The groups of chains without wrist. One may be a palm that bends (ring and little finger, say);
/// two are two hands on one robot.
std::vector<FingerGroup> FindGroups(const HandAtRest& hand, const std::vector<FingerChain>& chains);

/// Fills in p_base and p_tip of a chain without wrist.
void Measure(const HandAtRest& hand, FingerChain* chain);

}  // namespace regrasp
