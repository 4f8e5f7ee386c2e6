#pragma once

/// How hard the object has been pushed lately, as the controller feels it: a push moves the object
/// faster than the wrench control brings it back. What its sensed place departs from its own
/// low-passed course, e [m], is remembered at its greatest and forgotten slowly,
///
///   dp/dt = (p_WO - p)/T + v,   e = |p_WO - p|,   peak = max(e, peak - dt peak/T_memory)
///
/// v: the wanted velocity. level() tells where the peak lies between what noise does and what a
/// push of some object's weight does.

#include "core/common/frames.h"
#include "core/control/control_parameters.h"

namespace regrasp {

class FeltPush {
 public:
  /// Forgets everything.
  void Reset() { *this = FeltPush(); }
  /// One tick of `dt` [s]: the sensed place of the object [m], its wanted velocity [m/s].
  void Update(const Vector3d& p_WO, const Vector3d& v_W, const ControlParameters& parameters,
              double dt);
  double peak() const { return peak_; }  ///< [m]
  /// 0 (nothing but noise) to 1 (pushed hard).
  double Level(const ControlParameters& parameters) const;
  template <typename V>
  void Fields(V& v) {
    v("started", started_);
    v("course", course_W_);
    v("peak", peak_);
  }

 private:
  bool started_ = false;
  Vector3d course_W_ = Vector3d::Zero();
  double peak_ = 0;
};

}  // namespace regrasp
