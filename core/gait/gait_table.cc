#include "core/gait/gait_table.h"

namespace regrasp {

int OpposingFinger(const Estimate& estimate, FingerSet fingers) {
  if (fingers.size() < 2) return -1;
  Vector3d sum = Vector3d::Zero();
  for (int i : fingers) sum += estimate.fingers[i].normal_W;
  int opposing = -1;
  double least = 0;
  for (int i : fingers) {
    const Vector3d& n = estimate.fingers[i].normal_W;
    const double along = n.dot(sum - n);
    if (opposing >= 0 && along >= least) continue;
    opposing = i;
    least = along;
  }
  return opposing;
}

GaitOrder MakeGaitOrder(const HandModel& hand, const Estimate& estimate, FingerSet fingers) {
  GaitOrder order;
  const int last = OpposingFinger(estimate, fingers);
  FingerSet left = fingers.without(last);
  const auto Add = [&](int finger) {
    if (!left.contains(finger)) return;
    left.remove(finger);
    order.push_back({finger, GaitObjective::kManipulability});
  };
  for (const GaitRow& row : kGaitTable)
    for (int i = 0; i < hand.num_fingers(); ++i)
      if (hand.fingers[i].name == row.finger) Add(i);
  for (int i = 0; i < hand.num_fingers(); ++i) Add(i);
  if (last >= 0) {
    if (!order.empty()) order.back().objective = GaitObjective::kStabilityWithoutNext;
    order.push_back({last, GaitObjective::kManipulability});
  }
  return order;
}

}  // namespace regrasp
