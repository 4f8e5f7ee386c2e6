#include "core/hand/joint_numbers.h"

#include <algorithm>
#include <map>
#include <utility>

namespace regrasp {
namespace {

void Narrow(const Joint& coupled, Joint* driver, Problems* problems) {
  if (!(coupled.lower < coupled.upper)) return;
  double low = (coupled.lower - coupled.offset) / coupled.ratio;
  double high = (coupled.upper - coupled.offset) / coupled.ratio;
  if (low > high) std::swap(low, high);
  low = std::max(low, driver->lower);
  high = std::min(high, driver->upper);
  if (!(low < high)) {
    problems->Add(0, "{}: its limits and those of {}, which it follows, have nothing in common",
                  JointElement(coupled.name), JointElement(driver->name));
    return;
  }
  constexpr double kSaid = 0.01;  // [rad]
  if (low > driver->lower + kSaid || high < driver->upper - kSaid)
    problems->Warn(0, JointElement(driver->name),
                   fmt::format("limits narrowed to {:.4g} .. {:.4g} rad by {}", low, high,
                               JointElement(coupled.name)));
  driver->lower = low;
  driver->upper = high;
}

}  // namespace

void NumberJoints(const HandTree& tree, const std::vector<int>& order, HandModel* hand,
                  Problems* problems) {
  std::map<int, int> final;  // by URDF joint
  std::vector<Joint> joints;
  for (const bool coupled : {false, true})
    for (std::size_t i = 0; i < order.size(); ++i) {
      const HandTree::Coupling c = tree.CouplingOf(order[i]);
      if ((c.driver != order[i]) != coupled) continue;
      final[order[i]] = static_cast<int>(joints.size());
      joints.push_back(hand->joints[i]);
      if (!coupled) continue;
      ++hand->num_coupled;
      joints.back().driver = final.at(c.driver);
      joints.back().ratio = c.ratio;
      joints.back().offset = c.offset;
      Narrow(joints.back(), &joints[static_cast<std::size_t>(joints.back().driver)], problems);
    }
  hand->joints = std::move(joints);
  for (Link& link : hand->links)
    if (link.parent_joint >= 0) link.parent_joint = final.at(link.parent_joint);
  for (Finger& finger : hand->fingers)
    for (int& joint : finger.joints) joint = final.at(joint);
}

}  // namespace regrasp
