#pragma once

/// Systematic errors of one fingertip's sensor, beside its white noise: bias, drift, dropout and
/// latency, as real tactile sensors have them. All in the fingertip's own frame L, where a sensor
/// that is mounted wrongly stays wrong however the finger moves.

#include "core/common/fields.h"
#include "core/common/fixed_vector.h"
#include "core/common/random.h"
#include "core/sensing/noise.h"
#include "core/sensing/sensor_reading.h"

namespace regrasp {

/// Largest NoiseLevels::latency_s in samples.
inline constexpr int kMaxLatencySamples = 20;

class FingertipErrors {
 public:
  /// Draws what does not change in a run: directions and sizes of the biases.
  void Reseed(std::uint64_t seed, int finger);
  /// One sample: `reading` as felt, white noise included, becomes what the sensor reports. `X_WL`:
  /// pose of the tip link now, used where levels.systematic(); `sample_s`: between samples [s].
  void Apply(const NoiseLevels& levels, const Isometry3d& X_WL, double sample_s,
             FingertipReading* reading);

  template <typename V>
  void Fields(V& v) {
    v("stream", stream_);
    v("bias_L", bias_L_);
    v("force_bias", force_bias_, kUnbounded);
    v("drift_L", drift_L_);
    v("force_drift", force_drift_, kUnbounded);
    v("out", out_);
    v("late_L", late_L_);
  }

 private:
  RandomStream stream_;
  Vector3d bias_L_ = Vector3d::Zero();                            // in standard deviations
  double force_bias_ = 0;                                         // the same
  Vector3d drift_L_ = Vector3d::Zero();                           // [m]
  double force_drift_ = 0;                                        // [N]
  bool out_ = false;                                              // in a gap
  FixedVector<FingertipReading, kMaxLatencySamples + 1> late_L_;  // in L, oldest first
};

}  // namespace regrasp
