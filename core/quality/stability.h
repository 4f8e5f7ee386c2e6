#pragma once

/// Grasp stability from the hard-finger grasp matrix [Murray, Li, Sastry 1994, Ch. 5].

#include <span>

#include "core/quality/grasp.h"

namespace regrasp {

/// Measures that come from the singular values of G.
struct SingularMeasures {
  double min_singular_value = 0;  ///< sigma_min(G)
  double sqrt_det = 0;            ///< sqrt(det(G Gᵀ)) = product of the six singular values
  double isotropy = 0;            ///< sigma_min / sigma_max
};

/// G is 6 x 3n: for each contact the unit forces along t1, t2, n; lower three rows are the torques
/// r x f / torque_scale. With fewer than two contacts everything is 0. From the eigenvalues of the
/// 6 x 6 matrix G Gᵀ: singular values are good to 1e-7 of the largest one, and smaller ones come
/// out as 0. About 2 us; no allocation. torque_scale: [m], > 0.
SingularMeasures ComputeSingularMeasures(std::span<const GraspContact> contacts,
                                         double torque_scale);

}  // namespace regrasp
