#pragma once

/// The best contact a finger has met: phi and the contact point, low-passed alike, so that noise
/// does not count as a maximum. In W: a finger that sticks drags the object along, and a point of
/// the object would run away from it.

#include "core/common/frames.h"

namespace regrasp {

class BestContact {
 public:
  /// Begins at `p_WC` [m] with objective `phi`.
  void Start(const Vector3d& p_WC, double phi) {
    p_WC_ = p_WC_best_ = p_WC;
    phi_ = phi_best_ = phi;
  }
  /// One tick of `dt` [s]. `filter_s`: time constant of the low pass [s].
  void Add(const Vector3d& p_WC, double phi, double filter_s, double dt) {
    const double gain = dt / (filter_s + dt);
    phi_ += gain * (phi - phi_);
    p_WC_ += gain * (p_WC - p_WC_);
    if (phi_ <= phi_best_) return;
    phi_best_ = phi_;
    p_WC_best_ = p_WC_;
  }
  const Vector3d& p_WC() const { return p_WC_best_; }  ///< [m]
  double phi() const { return phi_best_; }
  /// Whether the way back pays: the best phi is more than `gain` times the present one.
  bool worth_returning(double gain) const { return phi_best_ > gain * phi_; }
  template <typename V>
  void Fields(V& v) {
    v("p_WC", p_WC_);
    v("p_WC_best", p_WC_best_);
    v("phi", phi_);
    v("phi_best", phi_best_);
  }

 private:
  Vector3d p_WC_ = Vector3d::Zero(), p_WC_best_ = Vector3d::Zero();
  double phi_ = 0, phi_best_ = 0;
};

}  // namespace regrasp
