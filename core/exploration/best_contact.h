#pragma once

/// The best contact a finger has met: phi and the contact point, low-passed alike, so that noise
/// does not count as a maximum. In W: a finger that sticks drags the object along, and a point of
/// the object would run away from it.

#include <algorithm>
#include <cmath>

#include "core/common/frames.h"

namespace regrasp {

/// By how much of its size `phi` is above `before`; below 0 it has fallen.
inline double RelativeGain(double phi, double before) {
  const double size = std::max(1e-6, std::abs(before));
  return phi / size - before / size;
}

/// Whether `phi` is above `before` by more than gain - 1 of its size.
inline bool Gains(double phi, double before, double gain) {
  return phi - before > (gain - 1) * std::abs(before);
}

class BestContact {
 public:
  /// Begins at `p_WC` [m] with objective `phi`.
  void Start(const Vector3d& p_WC, double phi) {
    p_WC_ = p_WC_best_ = p_WC;
    phi_ = phi_best_ = phi;
    StartWaiting();
  }
  /// no_gain_s() counts from here.
  void StartWaiting() {
    phi_waited_ = phi_best_;
    no_gain_s_ = 0;
  }
  /// One tick of `dt` [s]. `filter_s`: time constant of the low pass [s]; `gain`: see Gains().
  void Add(const Vector3d& p_WC, double phi, double filter_s, double gain, double dt) {
    const double share = dt / (filter_s + dt);
    phi_ += share * (phi - phi_);
    p_WC_ += share * (p_WC - p_WC_);
    no_gain_s_ += dt;
    if (phi_ <= phi_best_) return;
    phi_best_ = phi_;
    p_WC_best_ = p_WC_;
    if (Gains(phi_best_, phi_waited_, gain)) StartWaiting();
  }
  const Vector3d& p_WC() const { return p_WC_best_; }  ///< [m]
  double phi() const { return phi_best_; }
  double no_gain_s() const { return no_gain_s_; }  ///< since the best phi last gained [s]
  /// Whether the way back pays: the best phi is a gain over the present one.
  bool worth_returning(double gain) const { return Gains(phi_best_, phi_, gain); }
  template <typename V>
  void Fields(V& v) {
    v("p_WC", p_WC_);
    v("p_WC_best", p_WC_best_);
    v("phi", phi_);
    v("phi_best", phi_best_);
    v("phi_waited", phi_waited_);
    v("no_gain_s", no_gain_s_);
  }

 private:
  Vector3d p_WC_ = Vector3d::Zero(), p_WC_best_ = Vector3d::Zero();
  double phi_ = 0, phi_best_ = 0;
  double phi_waited_ = 0;  // the best at the last gain
  double no_gain_s_ = 0;
};

}  // namespace regrasp
