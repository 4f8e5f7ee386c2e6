#include "core/session/few_fingers.h"

#include <cmath>

namespace regrasp {

Verdict CheckFingers(const HandModel& hand, const Parameters& parameters, const Command& command) {
  if (hand.num_fingers() >= kFewestToRegrasp) return {};
  if (command.type == CommandType::kExplore)
    return {Verdict::Kind::kBadState,
            "exploring needs a hand of four fingers or more: without the one that explores the "
            "others do not hold the object",
            "regrasp move --turn 0,0,-10 --wait"};
  if (command.type != CommandType::kRotate) return {};
  if (!command.continuous && std::abs(command.angle_rad) <= parameters.gait.step_rad) return {};
  return {Verdict::Kind::kBadState,
          "turning by more than gait.step_rad needs a hand of four fingers or more: without the "
          "one that regrasps the others do not hold the object",
          "regrasp rotate with an angle of at most gait.step_rad: a turn without a regrasp"};
}

Verdict CheckFingers(const HandModel& hand, const Parameters& before, const Parameters& after,
                     JobMethod running) {
  if (hand.num_fingers() >= kFewestToRegrasp || running != JobMethod::kRotate ||
      after.gait.step_rad >= before.gait.step_rad)
    return {};
  return {Verdict::Kind::kBadState,
          "gait.step_rad cannot be lowered while a hand of two or three fingers turns the object: "
          "the turn was taken as one motion, and none of the fingers can regrasp",
          "regrasp stop, or wait for the turn to end"};
}

}  // namespace regrasp
