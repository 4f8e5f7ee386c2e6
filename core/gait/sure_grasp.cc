#include "core/gait/sure_grasp.h"

#include <algorithm>
#include <cmath>

namespace regrasp {

double FrictionUnderTilt(double mu, double tilt) {
  constexpr double kLeast = 0.05;
  return std::max(kLeast, std::tan(std::max(0.0, std::atan(mu) - tilt)));
}

Grasp SureGraspOf(const Estimate& estimate, FingerSet fingers, double mu, const FeltSurface& felt,
                  double doubt) {
  Grasp grasp = GraspOf(estimate, fingers, mu);
  if (doubt <= 0) return grasp;
  const Quaterniond q_OW = estimate.q_WO.conjugate();
  for (GraspContact& contact : grasp)
    contact.mu = FrictionUnderTilt(mu, doubt * felt.BendAt(q_OW * contact.position));
  return grasp;
}

}  // namespace regrasp
