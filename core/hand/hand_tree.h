#pragma once

/// What moves what in a hand's URDF: couplings by <mimic>, joints locked by the scenario, links
/// that are one body. Used only by the hand's loader.

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/hand/problems.h"
#include "core/hand/urdf.h"
#include "core/hand/urdf_file.h"

namespace regrasp {

class HandTree {
 public:
  /// Both are kept by reference.
  HandTree(const UrdfFile& file, const HandLayout& layout) : file_(file), layout_(layout) {}

  const UrdfJoint& joint(int j) const { return file_.joints[static_cast<std::size_t>(j)]; }
  const UrdfLink& link(int l) const { return file_.links[static_cast<std::size_t>(l)]; }

  int FindLink(const std::string& name) const { return file_.FindLink(name); }

  struct Coupling {
    int driver = -1;
    double ratio = 1, offset = 0;
  };
  /// The joint that finally drives joint j, through every <mimic>; j itself where it has a drive of
  /// its own; -1 where they lead in a ring or nowhere.
  Coupling CouplingOf(int j) const;

  /// The angle [rad] at which the joint is held, if it does not move: it is fixed, held or locked,
  /// or its driver is.
  std::optional<double> LockedAt(int j) const;

  /// What is wrong with the ratio of a coupling, or "".
  static std::string RatioFault(double ratio);

  /// The joints with a drive that move a link, from the root on.
  std::vector<int> DriversTo(int link) const;
  /// What is wrong with so many of them before a fingertip, or "".
  static std::string FingerFault(std::size_t drivers, const std::string& tip_link);

  /// Pose of the child link in the parent link with the joint at an angle.
  Isometry3d PoseAt(int j, double angle) const;

  /// The joints that move a link, from the root on.
  std::vector<int> JointsTo(int link) const;

  /// The last link above the first movable joints of all fingers; the root where no finger of the
  /// layout is found.
  int Palm() const;
  /// Whether `link` is `above`, or comes after it from the root on.
  bool IsBelow(int link, int above) const;

  /// Adds every link of the body that carries `link`.
  void AddBodyOf(int link, std::set<int>* group) const;

  /// Adds what is wrong with the joints and with what the layout names.
  void Check(Problems* problems) const;

 private:
  /// Neither fixed nor turning (a rail, a floating base), and moves every finger of several or
  /// none: held where the file has its zero.
  bool IsHeld(int j) const;
  /// How many fingers a joint moves.
  std::size_t FingersBelow(int j) const;
  void CheckMimic(int j, Problems* problems) const;
  void AddFixed(int link, std::set<int>* group) const;

  const UrdfFile& file_;
  const HandLayout& layout_;
};

}  // namespace regrasp
