#pragma once

/// The explorations of a gait (gait.mode exploring; Sec. III b: the free finger maximises its
/// objective while it regrasps): which regrasps explore, within which disc, and what each finger's
/// last explorations have found, so that the next one goes on from there.

#include <array>

#include "core/exploration/guided_slide.h"
#include "core/gait/explored_gain.h"
#include "core/gait/gait_parameters.h"

namespace regrasp {

class Explorations {
 public:
  /// Whether Algorithm 1 shall run where the finger lands; `unknown`: on a surface not felt yet.
  bool Explores(const GaitParameters& parameters, int finger, bool unknown) const;
  /// How much of the exploring disc is free: all of it while the grasp without the opposing finger
  /// has the load margin that is wanted, nothing where it has hardly the one that is needed.
  static double DiscShare(const ControlTick& tick, int opposing);
  /// An exploration has ended, `shift_W` from the finger's home [m].
  void Add(const GaitParameters& parameters, const GuidedSlide& slide, const Vector3d& shift_W);
  /// Where Algorithm 1 ended the last times, from the finger's home, in W axes [m]. The next
  /// exploration of the finger goes there from its home, then Algorithm 1 takes over.
  const Vector3d& found_W(int finger) const { return found_[finger]; }
  /// With which its last exploration ended [1/m]; zero: none yet.
  const Vector3d& gradient_W(int finger) const { return gradient_[finger]; }
  template <typename V>
  void Fields(V& v) {
    v("found", found_);
    v("gradient", gradient_);
    v("gain", gain_);
  }

 private:
  std::array<Vector3d, kMaxFingers> found_ = ZeroVectors<kMaxFingers>();
  std::array<Vector3d, kMaxFingers> gradient_ = ZeroVectors<kMaxFingers>();
  std::array<ExploredGain, kMaxFingers> gain_{};
};

}  // namespace regrasp
