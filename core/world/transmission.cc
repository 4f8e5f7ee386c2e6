#include "core/world/transmission.h"

#include <algorithm>
#include <map>

namespace regrasp {
namespace {

/// What resists a torque of the transmission of `coupled`: 1 / I = sum of c² / I_L over the links L
/// whose rate of turn w_L stretches it by c w_L. A joint turns at the rate of its child less that
/// of its parent, so that a driver which carries the coupled link counts (1 + r)² times. The links'
/// own inertias, armature included, are a lower bound: what they carry adds to it.
double ReducedInertia(const HandModel& hand, const Joint& coupled) {
  const Joint& driver = hand.joints[static_cast<std::size_t>(coupled.driver)];
  std::map<int, double> stretch;  // by link
  stretch[coupled.child_link] += 1;
  stretch[coupled.parent_link] -= 1;
  stretch[driver.child_link] -= coupled.ratio;
  stretch[driver.parent_link] += coupled.ratio;
  double inverse = 0;
  for (const auto& [l, c] : stretch) {
    const Link& link = hand.links[static_cast<std::size_t>(l)];
    if (link.parent_joint < 0) continue;
    const Joint& joint = hand.joints[static_cast<std::size_t>(link.parent_joint)];
    inverse += c * c / (joint.armature + joint.axis_J.dot(link.I_LCom * joint.axis_J));
  }
  return 1 / inverse;
}

}  // namespace

Transmissions::Transmissions(const HandModel& hand, double stiffness, double damping, double dt)
    : plant_(hand), place_(hand.joints.size()), num_driven_(hand.num_joints()) {
  plant_.joints.clear();
  plant_.num_coupled = 0;
  for (std::size_t l = 1; l < hand.links.size(); ++l) {
    const int j = hand.links[l].parent_joint;
    place_[static_cast<std::size_t>(j)] = static_cast<int>(plant_.joints.size());
    plant_.links[l].parent_joint = static_cast<int>(plant_.joints.size());
    plant_.joints.push_back(hand.joints[static_cast<std::size_t>(j)]);
    if (plant_.joints.back().driver >= 0) plant_.joints.back().effort = 0;
    plant_.joints.back().driver = -1;
  }
  for (Finger& finger : plant_.fingers) finger.joints.clear();
  std::vector<int> followers(hand.joints.size(), 0);
  for (const Joint& joint : hand.joints)
    if (joint.driver >= 0) ++followers[static_cast<std::size_t>(joint.driver)];
  for (std::size_t j = static_cast<std::size_t>(num_driven_); j < hand.joints.size(); ++j) {
    const Joint& joint = hand.joints[j];
    const auto driver = static_cast<std::size_t>(joint.driver);
    const double share = ReducedInertia(hand, joint) / followers[driver];
    springs_.push_back({place_[j], place_[driver], joint.ratio, joint.offset,
                        std::min(stiffness, 0.8 * share / (dt * dt)),
                        std::min(damping, 0.5 * share / dt)});
  }
  if (springs_.empty()) return;
  following_.resize(place_.size());
  for (int i = 0; i < num_driven_; ++i)
    following_[static_cast<std::size_t>(place_[static_cast<std::size_t>(i)])].driven = i;
  for (std::size_t j = static_cast<std::size_t>(num_driven_); j < hand.joints.size(); ++j)
    following_[static_cast<std::size_t>(place_[j])] = {hand.joints[j].driver, hand.joints[j].ratio,
                                                       hand.joints[j].offset};
}

JointVector Transmissions::ToPlant(const JointVector& driven) const {
  JointVector plant = JointVector::Zero(static_cast<Eigen::Index>(place_.size()));
  for (int i = 0; i < num_driven_; ++i) plant[place_[static_cast<std::size_t>(i)]] = driven[i];
  return plant;
}

JointVector Transmissions::AnglesToPlant(const JointVector& driven) const {
  JointVector plant = ToPlant(driven);
  for (const Spring& s : springs_) plant[s.joint] = s.ratio * plant[s.driver] + s.offset;
  return plant;
}

JointVector Transmissions::FromPlant(const JointVector& plant) const {
  JointVector driven(num_driven_);
  for (int i = 0; i < num_driven_; ++i) driven[i] = plant[place_[static_cast<std::size_t>(i)]];
  return driven;
}

void Transmissions::AddTorques(const JointVector& q, const JointVector& qdot,
                               JointVector* torque) const {
  for (const Spring& s : springs_) {
    const double stretch = q[s.joint] - s.ratio * q[s.driver] - s.offset;
    const double rate = qdot[s.joint] - s.ratio * qdot[s.driver];
    const double back = -s.stiffness * stretch - s.damping * rate;
    (*torque)[s.joint] += back;
    (*torque)[s.driver] -= s.ratio * back;
  }
}

}  // namespace regrasp
