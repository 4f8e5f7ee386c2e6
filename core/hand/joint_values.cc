#include "core/hand/joint_values.h"

#include <fmt/ranges.h>

#include <cmath>

#include "core/common/count_text.h"

namespace regrasp {

void JointValues::Fill(const UrdfJoint& in, Joint* joint) {
  const bool whole_turn = in.type == UrdfJoint::Type::kContinuous;
  joint->lower = whole_turn ? -M_PI : in.lower;
  joint->upper = whole_turn ? M_PI : in.upper;
  if (in.mimic && !(in.lower < in.upper)) {  // its driver's limits are its own
    joint->lower = -2 * M_PI;
    joint->upper = 2 * M_PI;
  }
  joint->effort = in.effort;
  if (in.effort == 0 && !in.mimic) {
    joint->effort = kDefaultEffort;
    unpowered_.push_back(in.name);
  }
  joint->armature = layout_.armature;
  joint->damping = in.damping.value_or(layout_.damping);
  if (joint->damping < layout_.least_damping) {
    joint->damping = layout_.least_damping;
    raised_.push_back(in.name);
  }
  constexpr double kSlow = 0.1;  // [rad/s]
  if (!in.mimic && joint->effort < kSlow * joint->damping) slow_.push_back(in.name);
  if (whole_turn)
    problems_->Warn(in.line, JointElement(in.name),
                    "a continuous joint is kept within half a turn to either side");
  if (!in.damping) undamped_.push_back(in.name);
}

void JointValues::TellDefaults() const {
  const auto tell = [&](const std::vector<std::string>& joints, const char* what, double taken,
                        const char* unit) {
    if (!joints.empty())
      problems_->Warn(
          0, "",
          fmt::format("{} for {} ({}); {:g} {} is taken", what, CountText(joints.size(), "joint"),
                      fmt::join(joints, ", "), taken, unit));
  };
  tell(undamped_, "<dynamics damping> is missing", layout_.damping, "N m s/rad");
  tell(raised_, "<dynamics damping> is less than the scenario's least", layout_.least_damping,
       "N m s/rad");
  tell(unpowered_, "<limit> effort is 0", kDefaultEffort, "N m");
  if (!slow_.empty())
    problems_->Warn(0, "",
                    fmt::format("<dynamics damping> [N m s/rad] lets {} ({}) turn by less than 0.1 "
                                "rad/s with their whole effort: {}",
                                CountText(slow_.size(), "joint"), fmt::join(slow_, ", "),
                                slow_.size() == 1 ? "it hardly moves" : "they hardly move"));
}

}  // namespace regrasp
