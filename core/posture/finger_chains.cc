#include "core/posture/finger_chains.h"

#include <algorithm>
#include <iterator>

namespace regrasp {
namespace {

/// Whether a joint moves beyond link `l`.
bool MovesMore(const HandAtRest& hand, int l) {
  return std::ranges::any_of(hand.link(l).child_joints, [&](int j) {
    return hand.Moves(j) || MovesMore(hand, hand.joint(j).child);
  });
}

/// The link fixed to `l` whose rounded shapes, or with `boxes` any, reach farthest from `p` [m];
/// -1 without any.
int FarthestTip(const HandAtRest& hand, int l, const Vector3d& p, bool boxes, double* reach) {
  int best = -1;
  for (const UrdfCollision& c : hand.link(l).collisions) {
    if (c.geometry.kind == UrdfGeometry::Kind::kBox && !boxes) continue;
    const double far = (hand.pose(l) * c.X_LG.translation() - p).norm();
    if (best >= 0 && far <= *reach) continue;
    best = l;
    *reach = std::max(far, *reach);
  }
  for (const int j : hand.link(l).child_joints) {
    const double before = *reach;
    const int other = FarthestTip(hand, hand.joint(j).child, p, boxes, reach);
    if (other >= 0 && (best < 0 || *reach > before)) best = other;
  }
  return best;
}

}  // namespace

HandAtRest::HandAtRest(const UrdfFile& file) : file_(file), pose_(file.links.size()) {
  Place(file.root, Isometry3d::Identity());
}

bool HandAtRest::Moves(int j) const {
  const UrdfJoint::Type type = joint(j).type;
  return type == UrdfJoint::Type::kRevolute || type == UrdfJoint::Type::kContinuous;
}

double HandAtRest::Angle(int j) const {
  const UrdfJoint& in = joint(j);
  return in.lower < in.upper ? std::clamp(0.0, in.lower, in.upper) : 0.0;
}

void HandAtRest::Place(int l, const Isometry3d& X) {
  pose_[static_cast<std::size_t>(l)] = X;
  for (const int j : link(l).child_joints) {
    Isometry3d child = X * joint(j).X_PJ;
    if (Moves(j)) child.rotate(Eigen::AngleAxisd(Angle(j), joint(j).axis));
    Place(joint(j).child, child);
  }
}

std::vector<FingerChain> FindFingerChains(const HandAtRest& hand, std::vector<std::string>* bare) {
  std::vector<FingerChain> chains;
  for (int j = 0; j < hand.num_joints(); ++j) {
    const int end = hand.joint(j).child;
    if (!hand.Moves(j) || MovesMore(hand, end)) continue;
    double reach = 0;
    FingerChain chain;
    for (const bool boxes : {false, true})
      if (chain.tip < 0)
        chain.tip = FarthestTip(hand, end, hand.pose(end).translation(), boxes, &reach);
    if (chain.tip < 0) {
      bare->push_back(hand.link(end).name);
      continue;
    }
    for (int up = j; up >= 0; up = hand.link(hand.joint(up).parent).parent_joint)
      if (hand.Moves(up)) chain.joints.insert(chain.joints.begin(), up);
    chains.push_back(chain);
  }
  return chains;
}

std::vector<int> TakeWrist(std::vector<FingerChain>* chains) {
  std::vector<int> wrist;
  const auto moves_all = [&] {
    return std::ranges::all_of(*chains, [&](const FingerChain& c) {
      return c.joints.size() > 1 && c.joints.front() == chains->front().joints.front();
    });
  };
  while (!chains->empty() && moves_all()) {
    wrist.push_back(chains->front().joints.front());
    for (FingerChain& c : *chains) c.joints.erase(c.joints.begin());
  }
  return wrist;
}

std::vector<FingerGroup> FindGroups(const HandAtRest& hand,
                                    const std::vector<FingerChain>& chains) {
  std::vector<FingerGroup> groups;
  std::vector<int> firsts;
  for (const FingerChain& chain : chains) {
    const int first = chain.joints.front();
    if (std::ranges::find(firsts, first) != firsts.end()) continue;
    firsts.push_back(first);
    FingerGroup group;
    std::ranges::copy_if(chains, std::back_inserter(group.chains),
                         [&](const FingerChain& c) { return c.joints.front() == first; });
    if (group.chains.size() < 2) continue;
    std::vector<FingerChain> apart = group.chains;
    group.palm = hand.joint(TakeWrist(&apart).back()).child;
    groups.push_back(std::move(group));
  }
  return groups;
}

void Measure(const HandAtRest& hand, FingerChain* chain) {
  chain->p_base = hand.pose(hand.joint(chain->joints.front()).child).translation();
  const int body = hand.joint(chain->joints.back()).child;
  chain->p_tip = hand.pose(chain->tip).translation();
  // A tip whose frame is its joint: its farthest shape tells.
  for (const UrdfCollision& c : hand.link(chain->tip).collisions) {
    const Vector3d p = hand.pose(chain->tip) * c.X_LG.translation();
    if ((p - hand.pose(body).translation()).norm() >
        (chain->p_tip - hand.pose(body).translation()).norm())
      chain->p_tip = p;
  }
}

}  // namespace regrasp
