#pragma once

/// How the palm of a hand lies that nobody has described. Used only by hand_guess.cc.

#include "core/posture/finger_chains.h"

namespace regrasp {

/// X_HR: the file's root in the hand's frame H (HandLayout). The fingers, stretched, point to +z,
/// and bend away from +y; the origin is the middle of their bases. Where they point or bend in
/// every direction, the way from bases to tips and the finger that bends most tell. A finger bends
/// to the larger end of its outer joints' ranges, or of the next joint's about the same axis.
/// `guessed`: no finger has such a joint, and each was taken to bend towards the others.
Isometry3d PalmFrame(const HandAtRest& hand, const std::vector<FingerChain>& chains, bool* guessed);

}  // namespace regrasp
