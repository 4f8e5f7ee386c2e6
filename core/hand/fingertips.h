#pragma once

/// Which shapes of a hand are fingertips. Used only by the hand's loader.

#include <set>
#include <vector>

#include "core/hand/hand_tree.h"

namespace regrasp {

class Fingertips {
 public:
  /// Keeps `tree`, which has been checked, and `layout` by reference.
  Fingertips(const HandTree& tree, const HandLayout& layout);

  /// Whether the shapes of this URDF link may be a fingertip.
  bool MayBe(int link) const { return links_.contains(link); }

  /// Puts the fingertip's shape first among those of `link`, which carries the finger's tip link at
  /// X_LG, then the others of the same URDF link, which feel as it does, and gives the finger its
  /// tip. `origin`: the URDF link of each shape. False where no
  /// shape can be it.
  bool Find(std::size_t finger, const Isometry3d& X_LG, const std::vector<int>& origin, Link* link,
            Finger* out) const;

 private:
  bool HasRounded(int link) const;

  const HandTree& tree_;
  const HandLayout& layout_;
  std::vector<std::set<int>> groups_;  // by finger: URDF links of its fingertip's shapes
  std::set<int> links_;
};

}  // namespace regrasp
