#include "core/gait/gait_table.h"

#include <algorithm>
#include <cctype>
#include <cstdio>

#include "core/hand/finger_reach.h"

namespace regrasp {
namespace {

using Neighbours = FixedVector<int, kMaxFingers>;

constexpr int kJointsBeyondKnuckle = 2;  // of a finger: its two outer hinges

/// Where the finger's knuckle is in the stretched hand: its third joint from the tip, or its first
/// [m]. The root of a finger whose metacarpal moves would be near the wrist instead.
Vector3d KnuckleOf(const HandModel& hand, int finger) {
  const JointChain chain = ChainOf(hand, finger);
  const int knuckle = std::max(0, static_cast<int>(chain.size()) - 1 - kJointsBeyondKnuckle);
  Isometry3d X = Isometry3d::Identity();
  for (int k = 0; k <= knuckle; ++k) X = X * hand.joints[chain[k]].X_PJ;
  return X.translation();
}

/// The others, the farthest from the opposing finger's knuckle first; of equals in the hand's
/// order.
Neighbours NeighboursOf(const HandModel& hand, int opposing, FingerSet fingers) {
  Neighbours neighbours;
  if (opposing < 0) {
    for (int i : fingers) neighbours.push_back(i);
    return neighbours;
  }
  const Vector3d knuckle = KnuckleOf(hand, opposing);
  const auto distance = [&](int finger) { return (KnuckleOf(hand, finger) - knuckle).norm(); };
  for (int i : fingers.without(opposing)) {
    neighbours.push_back(i);
    for (std::size_t k = neighbours.size() - 1;
         k > 0 && distance(neighbours[k]) > distance(neighbours[k - 1]); --k)
      std::swap(neighbours[k], neighbours[k - 1]);
  }
  return neighbours;
}

}  // namespace

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

GaitStateName GaitStateNameOf(const HandModel& hand, int finger) {
  GaitStateName name;
  if (finger < 0) {
    std::snprintf(name.text.data(), name.text.size(), "object motion");
    return name;
  }
  const std::string& own = hand.fingers[finger].name;
  const auto alike = [&](const Finger& other) {
    return !other.name.empty() && !own.empty() && other.name.front() == own.front();
  };
  if (std::count_if(hand.fingers.begin(), hand.fingers.end(), alike) == 1) {
    const int initial = std::toupper(static_cast<unsigned char>(own.front()));
    std::snprintf(name.text.data(), name.text.size(), "S_%c", initial);
  } else {
    std::snprintf(name.text.data(), name.text.size(), "S_%.21s", own.c_str());
  }
  return name;
}

GaitOrder MakeGaitOrder(const HandModel& hand, const Estimate& estimate, FingerSet fingers) {
  const int opposing = OpposingFinger(estimate, fingers);
  const Neighbours neighbours = NeighboursOf(hand, opposing, fingers);
  GaitOrder order;
  for (const GaitRow& row : kGaitTable) {
    for (std::size_t k = 0; k < neighbours.size(); ++k) {
      const bool last = opposing >= 0 && k + 1 == neighbours.size();
      if (row.free == (last ? GaitRole::kLastNeighbour : GaitRole::kNeighbours))
        order.push_back({neighbours[k], row.objective});
    }
    if (row.free == GaitRole::kOpposing && opposing >= 0)
      order.push_back({opposing, row.objective});
  }
  return order;
}

}  // namespace regrasp
