#pragma once

/// What a hand of two or three fingers, or with fingers of one or two driven joints, cannot do.

#include "core/hand/hand_model.h"
#include "core/session/command.h"
#include "core/session/parameters.h"
#include "core/session/session.h"

namespace regrasp {

/// Whether the hand can turn an object on and on: four fingers or more, each of which places its
/// tip.
bool CanRegrasp(const HandModel& hand);

/// Refuses what needs a finger to leave where the others would be fewer than three: two contacts
/// do not hold an object that turns about the line between them. That is every exploration, and a
/// rotation by more than one motion of the gait (gait.step_rad). A fingertip that fewer than three
/// driven joints move can neither slide nor land where it shall: that finger does not explore, and
/// its hand turns no farther than that one motion either, within which it stays where it is.
Verdict CheckFingers(const HandModel& hand, const Parameters& parameters, const Command& command);

/// Refuses parameters `after` that would take from a job that runs with `before` what the rule
/// above has granted: a turn within one motion, when gait.step_rad is lowered.
Verdict CheckFingers(const HandModel& hand, const Parameters& before, const Parameters& after,
                     JobMethod running);

}  // namespace regrasp
