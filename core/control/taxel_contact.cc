#include "core/control/taxel_contact.h"

#include <algorithm>

namespace regrasp {
namespace {

constexpr int kHalvings = 8;  // of the way to the taxel's centre: to a tenth of a degree

}  // namespace

Vector3d TaxelContact::PointOf(const Vector3d& normal_L, const Vector3d& near_L) const {
  const double back = std::clamp((tip_.p_LF - near_L).dot(tip_.along_L), 0.0, tip_.segment);
  return tip_.p_LF - back * tip_.along_L - tip_.radius * normal_L;
}

Vector3d TaxelContact::IntoCell(const Vector3d& p_LC, const Vector3d& normal_L) const {
  const Taxel& taxel = NearestTaxel(taxels_, p_LC);
  const auto in_cell = [&](const Vector3d& n_L) {
    return &NearestTaxel(taxels_, PointOf(n_L, taxel.p_LT)) == &taxel;
  };
  if (in_cell(normal_L)) return normal_L;
  double outside = 0, inside = 1;  // share of the way to the centre
  const auto at = [&](double share) {
    return ((1 - share) * normal_L - share * taxel.outward_L).normalized();
  };
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (outside + inside);
    (in_cell(at(middle)) ? inside : outside) = middle;
  }
  return at(inside);
}

}  // namespace regrasp
