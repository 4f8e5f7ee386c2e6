#pragma once

/// Distribution of a wanted object wrench over the holding fingers.
///
///   minimise  |sum f_i - F|² + |sum r_i x f_i - T|² / R² + w sum |f_i - g_i n_i|²
///   subject   f_i in the round friction cone about the inward normal n_i (coefficient mu),
///   to        lower <= f_i . n_i <= cap_i
///
/// Its cost is quadratic; with the round cone it is, strictly, a second-order cone program (SOCP).
/// Solved by warm-started FISTA [Beck, Teboulle 2009] with the exact projection onto each truncated
/// cone.

#include <array>

#include "core/common/fields.h"
#include "core/common/fixed_vector.h"
#include "core/common/frames.h"
#include "core/common/limits.h"

namespace regrasp {

struct ForceContact {
  int finger = -1;                ///< keeps the warm start across calls
  Vector3d r = Vector3d::Zero();  ///< contact point from the object's centre [m]
  Vector3d inward_normal = Vector3d::UnitZ();
  double cap = 4.0;   ///< upper bound of the normal force [N]
  double grip = 1.0;  ///< preferred normal force g_i [N]
};

struct ForceProblem {
  FixedVector<ForceContact, kMaxFingers> contacts;
  Vector3d force = Vector3d::Zero();   ///< F, on the object [N]
  Vector3d torque = Vector3d::Zero();  ///< T, on the object about its centre [N m]
  double torque_scale = 0.02;          ///< R [m], > 0
  double grip_weight = 0.02;           ///< w
  double mu = 0.5;
  double lower = 0.1;  ///< [N]
};

/// Projection of `f` onto { |t| <= mu n, lower <= n <= cap }, n along `axis` (unit).
Vector3d ProjectOntoTruncatedCone(const Vector3d& f, const Vector3d& axis, double mu, double lower,
                                  double cap);

class ContactForceQp {
 public:
  static constexpr int kIterations = 30;
  /// Forces on the object, one per contact of the problem, in its order [N].
  const FixedVector<Vector3d, kMaxFingers>& Solve(const ForceProblem& problem);
  /// |(sum f - F, (sum r x f - T)/R)| of the last solution [N].
  double residual() const { return residual_; }
  /// Forgets the warm start.
  void Reset() { *this = ContactForceQp(); }
  template <typename V>
  void Fields(V& v) {
    v("warm", warm_);
    v("has_warm", has_warm_);
    v("residual", residual_);
  }

 private:
  std::array<Vector3d, kMaxFingers> warm_ = ZeroVectors<kMaxFingers>();  // by finger
  std::array<bool, kMaxFingers> has_warm_{};
  FixedVector<Vector3d, kMaxFingers> forces_;
  double residual_ = 0;
};

}  // namespace regrasp
