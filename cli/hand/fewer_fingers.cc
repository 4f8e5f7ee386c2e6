#include "cli/hand/fewer_fingers.h"

#include <algorithm>

namespace regrasp::hand {

HandLayout Without(const HandModel& hand, HandLayout layout, FingerSet out) {
  for (int f = hand.num_fingers() - 1; f >= 0; --f) {
    if (!out.contains(f)) continue;
    layout.fingers.erase(layout.fingers.begin() + f);
    for (const int j : hand.fingers[static_cast<std::size_t>(f)].joints) {
      bool shared = false;
      for (int other = 0; other < hand.num_fingers(); ++other)
        if (!out.contains(other))
          shared = shared ||
                   std::ranges::count(hand.fingers[static_cast<std::size_t>(other)].joints, j) > 0;
      const Joint& joint = hand.joints[static_cast<std::size_t>(j)];
      if (!shared) layout.locked[joint.name] = std::clamp(0.0, joint.lower, joint.upper);
    }
  }
  return layout;
}

}  // namespace regrasp::hand
