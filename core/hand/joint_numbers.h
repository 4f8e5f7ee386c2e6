#pragma once

/// The numbers of a hand's joints: driven ones first, as HandModel has them. Used only by the
/// hand's loader.

#include <vector>

#include "core/hand/hand_tree.h"

namespace regrasp {

/// Joint i of `hand` is the URDF's joint order[i]; its links and fingers name joints by the URDF's
/// numbers. Puts driven joints before coupled ones, which follow them, and turns every reference
/// into the final numbers. A driver goes no farther than what follows it may.
void NumberJoints(const HandTree& tree, const std::vector<int>& order, HandModel* hand,
                  Problems* problems);

}  // namespace regrasp
