#include "core/hand/taxels.h"

#include <algorithm>
#include <cmath>

namespace regrasp {

TipAxes MakeTipAxes(const HandModel& hand, int finger) {
  const Finger& f = hand.fingers[finger];
  const Shape& shape = hand.links[f.tip_link].shapes.front();
  const Joint& last = hand.joints[f.joints.back()];
  TipAxes tip;
  tip.p_LF = f.p_LF;
  tip.radius = f.tip_radius;
  tip.segment = (shape.b_L - shape.a_L).norm();
  const Vector3d start =
      (shape.a_L - f.p_LF).norm() > (shape.b_L - f.p_LF).norm() ? shape.a_L : shape.b_L;
  // A sphere has no axis of its own: take the direction from the joint.
  const Vector3d along = tip.segment > 0 ? Vector3d(f.p_LF - start) : f.p_LF;
  if (along.norm() > 0) tip.along_L = along.normalized();
  const Vector3d pad = last.axis_J.cross(tip.along_L);
  tip.pad_L =
      pad.norm() > 1e-6 ? Vector3d(pad.normalized()) : Vector3d(RotationFromZ(tip.along_L).col(0));
  tip.side_L = tip.along_L.cross(tip.pad_L);
  return tip;
}

Taxels MakeTaxels(const TipAxes& tip, double pitch) {
  Taxels taxels;
  const double quarter = M_PI / 2 * tip.radius;  // from the apex to the end of the rounding
  for (int row = 0; row < kTaxelRows; ++row) {
    const double arc = (row + 0.5) * pitch;
    const double polar = std::min(arc / tip.radius, M_PI / 2);
    const double back = std::clamp(arc - quarter, 0.0, tip.segment);
    const double step = std::min(pitch / (tip.radius * std::sin(polar)), 2 * M_PI / kTaxelColumns);
    for (int column = 0; column < kTaxelColumns; ++column) {
      const double azimuth = (column - 1) * step;
      const Vector3d around = std::cos(azimuth) * tip.pad_L + std::sin(azimuth) * tip.side_L;
      Taxel& taxel = taxels[row * kTaxelColumns + column];
      taxel.outward_L = (std::sin(polar) * around + std::cos(polar) * tip.along_L).normalized();
      taxel.p_LT = tip.p_LF - back * tip.along_L + tip.radius * taxel.outward_L;
    }
  }
  return taxels;
}

const Taxel& NearestTaxel(const Taxels& taxels, const Vector3d& p_L) {
  return *std::min_element(taxels.begin(), taxels.end(), [&](const Taxel& a, const Taxel& b) {
    return (a.p_LT - p_L).squaredNorm() < (b.p_LT - p_L).squaredNorm();
  });
}

}  // namespace regrasp
