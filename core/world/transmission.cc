#include "core/world/transmission.h"

#include <algorithm>

namespace regrasp {

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
  const auto inertia = [&](const Joint& joint) {
    const Matrix3d& I = hand.links[static_cast<std::size_t>(joint.child_link)].I_LCom;
    return joint.armature + joint.axis_J.dot(I * joint.axis_J);
  };
  for (std::size_t j = static_cast<std::size_t>(num_driven_); j < hand.joints.size(); ++j) {
    const Joint& joint = hand.joints[j];
    const Joint& driver = hand.joints[static_cast<std::size_t>(joint.driver)];
    const double both = 1 / (1 / inertia(joint) + joint.ratio * joint.ratio / inertia(driver));
    springs_.push_back({place_[j], place_[static_cast<std::size_t>(joint.driver)], joint.ratio,
                        joint.offset, std::min(stiffness, 0.2 * both / (dt * dt)),
                        std::min(damping, 0.5 * both / dt)});
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
