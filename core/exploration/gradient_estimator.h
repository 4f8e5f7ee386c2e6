#pragma once

/// Two estimates of the gradient of phi on the surface from the finger's own motion.

#include <cstdint>
#include <string_view>

#include "core/common/frames.h"
#include "core/exploration/exploration_parameters.h"

namespace regrasp {

/// The paper's printed rule (lines 5 and 6): component-wise secants between two updates.
///
/// Departures from the print:
///  - line 5 reads T_c^r (c' - c); T maps C to W, so a displacement in W needs its inverse, R_WCᵀ.
///  - line 6 divides by each component of the displacement, singular as one goes to 0. Guard: a
///  component
///    shorter than `min_displacement / 4` contributes no gradient in that direction.
/// It keeps one flaw by design: each axis is credited with the whole change of phi.
class SecantEstimator {
 public:
  /// Gradient in C [1/m], third component 0, from the previous update (`p_WC_prev`, `phi_prev`) to
  /// now.
  static Vector3d Gradient(const Vector3d& p_WC_prev, double phi_prev, const Vector3d& p_WC,
                           double phi, const Matrix3d& R_WC, double min_displacement);
};

/// Least squares over the recent past: fits phi = phi0 + g . (p - p0) with exponential forgetting
/// and solves in the tangent plane. A circular dither keeps both tangent directions excited.
class LeastSquaresEstimator {
 public:
  /// Adds one sample. `keep` in (0, 1): weight of the past per sample.
  void Add(const Vector3d& p_WC, double phi, double keep);
  /// Gradient in C [1/m], third component 0. `ridge` [m²]: variance of position below which a
  /// direction counts as not excited and its gradient shrinks to 0.
  Vector3d Gradient(const Matrix3d& R_WC, double ridge) const;
  template <typename V>
  void Fields(V& v) {
    v("weight", weight_);
    v("mean_p", mean_p_);
    v("mean_phi", mean_phi_);
    v("scatter", scatter_);
    v("cross", cross_);
  }

 private:
  double weight_ = 0;
  Vector3d mean_p_ = Vector3d::Zero();
  double mean_phi_ = 0;
  Matrix3d scatter_ = Matrix3d::Zero();  // sum w (p - mean)(p - mean)ᵀ [m²]
  Vector3d cross_ = Vector3d::Zero();    // sum w (p - mean)(phi - mean) [m]
};

}  // namespace regrasp
