#include "core/gait/stance.h"

namespace regrasp {

StanceContact Shifted(const StanceContact& contact, const Vector3d& step) {
  const double radius = contact.p_OC_W.norm();
  const Vector3d centre = contact.p_OC_W - radius * contact.normal_W;
  const Quaterniond turn = FromRotationVector(contact.normal_W.cross(step) / radius);
  return {centre + turn * (contact.p_OC_W - centre), centre + turn * (contact.p_OF_W - centre),
          turn * contact.normal_W};
}

Home MakeHome(const Estimate& estimate, const ObjectWrench& wrench) {
  Home home;
  home.p_WO = wrench.p_ref();
  for (std::size_t i = 0; i < estimate.fingers.size(); ++i) {
    const FingerEstimate& f = estimate.fingers[i];
    home.stance.push_back({f.p_WC - home.p_WO, f.p_WF - home.p_WO, f.normal_W});
    home.manipulability[i] = f.manipulability;
  }
  return home;
}

}  // namespace regrasp
