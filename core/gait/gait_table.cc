#include "core/gait/gait_table.h"

namespace regrasp {

int OpposingFinger(const Estimate& estimate, unsigned fingers) {
  Vector3d sum = Vector3d::Zero();
  int count = 0;
  for (std::size_t i = 0; i < estimate.fingers.size(); ++i) {
    if (!(fingers >> i & 1u)) continue;
    sum += estimate.fingers[i].normal_W;
    ++count;
  }
  if (count < 2) return -1;
  int opposing = -1;
  double least = 0;
  for (std::size_t i = 0; i < estimate.fingers.size(); ++i) {
    if (!(fingers >> i & 1u)) continue;
    const Vector3d& n = estimate.fingers[i].normal_W;
    const double along = n.dot(sum - n);
    if (opposing >= 0 && along >= least) continue;
    opposing = static_cast<int>(i);
    least = along;
  }
  return opposing;
}

GaitOrder MakeGaitOrder(const HandModel& hand, const Estimate& estimate, unsigned fingers) {
  GaitOrder order;
  const int last = OpposingFinger(estimate, fingers);
  unsigned left = fingers;
  if (last >= 0) left &= ~(1u << last);
  const auto Add = [&](int finger) {
    if (finger < 0 || !(left >> finger & 1u)) return;
    left &= ~(1u << finger);
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
