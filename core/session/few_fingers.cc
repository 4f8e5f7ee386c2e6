#include "core/session/few_fingers.h"

#include <algorithm>
#include <cmath>

namespace regrasp {

bool CanRegrasp(const HandModel& hand) {
  return hand.num_fingers() >= kFewestToRegrasp && std::ranges::all_of(hand.fingers, PlacesItsTip);
}

Verdict CheckFingers(const HandModel& hand, const Parameters& parameters, const Command& command) {
  if (CanRegrasp(hand)) return {};
  const bool few = hand.num_fingers() < kFewestToRegrasp;
  if (command.type == CommandType::kExplore) {
    if (few)
      return {Verdict::Kind::kBadState,
              "exploring needs a hand of four fingers or more: without the one that explores the "
              "others do not hold the object",
              "regrasp move --turn 0,0,-10 --wait"};
    if (command.finger < 0 || command.finger >= hand.num_fingers() ||
        PlacesItsTip(hand.fingers[static_cast<std::size_t>(command.finger)]))
      return {};
    return {Verdict::Kind::kBadState,
            "this finger has fewer than three driven joints: its fingertip cannot slide where "
            "exploring asks",
            "regrasp hand check FILE tells the driven joints of each finger"};
  }
  if (command.type != CommandType::kRotate) return {};
  if (!command.continuous && std::abs(command.angle_rad) <= parameters.gait.step_rad) return {};
  constexpr const char* kHint =
      "regrasp rotate --angle 20 --wait    (at most gait.step_rad, 20 degrees unless it was set)";
  if (few)
    return {Verdict::Kind::kBadState,
            "turning by more than gait.step_rad needs a hand of four fingers or more: without the "
            "one that regrasps the others do not hold the object",
            kHint};
  return {Verdict::Kind::kBadState,
          "turning by more than gait.step_rad needs three driven joints or more in every finger: "
          "with fewer a fingertip cannot be put where the regrasp asks",
          kHint};
}

Verdict CheckFingers(const HandModel& hand, const Parameters& before, const Parameters& after,
                     JobMethod running) {
  if (CanRegrasp(hand) || running != JobMethod::kRotate ||
      after.gait.step_rad >= before.gait.step_rad)
    return {};
  return {Verdict::Kind::kBadState,
          "gait.step_rad cannot be lowered while a hand whose fingers cannot regrasp turns the "
          "object: the turn was taken as one motion",
          "regrasp stop, or wait for the turn to end"};
}

}  // namespace regrasp
