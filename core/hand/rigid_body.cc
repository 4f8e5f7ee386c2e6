#include "core/hand/rigid_body.h"

#include "core/hand/link_body.h"

namespace regrasp {

UrdfLink OneBody(const UrdfFile& file, Problems* problems) {
  UrdfLink whole = file.links[static_cast<std::size_t>(file.root)];
  if (file.links.size() == 1) return whole;
  for (const UrdfJoint& joint : file.joints)
    if (joint.type != UrdfJoint::Type::kFixed)
      problems->Add(joint.line, "{}: type \"{}\": an object is one rigid body; allowed is fixed",
                    JointElement(joint.name), joint.type_name.substr(0, 40));
  Link sum;
  std::optional<UrdfInertial> first;
  bool has_inertia = true;
  const auto add = [&](const auto& self, int l, const Isometry3d& X) -> void {
    const UrdfLink& link = file.links[static_cast<std::size_t>(l)];
    if (l != file.root)
      for (UrdfCollision collision : link.collisions) {
        collision.X_LG = X * collision.X_LG;
        whole.collisions.push_back(collision);
      }
    if (link.inertial && !(link.inertial->mass >= 0))
      problems->Add(link.inertial->line, "{}: <mass> = {:.6g}; must be >= 0",
                    LinkElement(link.name), link.inertial->mass);
    else if (link.inertial && !link.inertial->has_mass)
      problems->Add(link.inertial->line, "{}: <inertial> has no <mass>", LinkElement(link.name));
    else if (link.inertial)
      AddBodyTo(&sum, *link.inertial, X);
    if (link.inertial) has_inertia &= link.inertial->has_inertia;
    if (!first || !(first->mass > 0)) first = link.inertial ? link.inertial : first;
    for (const int j : link.child_joints) {
      const UrdfJoint& joint = file.joints[static_cast<std::size_t>(j)];
      self(self, joint.child, X * joint.X_PJ);
    }
  };
  add(add, file.root, Isometry3d::Identity());
  whole.inertial = first;  // for its lines
  if (!first) return whole;
  whole.inertial->has_mass = true;  // told above
  whole.inertial->has_inertia = has_inertia;
  whole.inertial->mass = sum.mass;
  whole.inertial->inertia = sum.I_LCom;
  whole.inertial->X_LI = Isometry3d(Eigen::Translation3d(sum.p_LCom));
  return whole;
}

}  // namespace regrasp
