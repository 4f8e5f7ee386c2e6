#pragma once

/// Noise levels of the sensors and their presets: white noise at 1 kHz, and what real sensors have
/// beside it (0 in every preset, but for what makes `taxel`: taxels, rate and delay of the pose).
/// The paper gives no numbers ("standard deviations following the real tactile sensor"): these
/// presets are ours.

#include <optional>
#include <span>
#include <string_view>

namespace regrasp {

struct NoiseLevels {
  double position_m = 0;           ///< contact position, per axis
  double normal_rad = 0;           ///< contact normal, per tangent axis
  double force_n = 0;              ///< normal force
  double joint_rad = 0;            ///< joint angle
  double object_position_m = 0;    ///< object position, per axis
  double object_rotation_rad = 0;  ///< object orientation, per axis
  double taxel_pitch_m = 0;     ///< > 0: contact position and normal snap to taxels this far apart
  double object_rate_hz = 0;    ///< > 0: the object pose is sampled and held at this rate
  int object_delay_frames = 0;  ///< frames at object_rate_hz by which the pose is late, 0 .. 7
  // Constant in a run, drawn from its seed: standard deviations over fingertips, joints, axes.
  double position_bias_m = 0;  ///< contact position, per axis of the fingertip
  double force_bias_n = 0;     ///< normal force
  double joint_bias_rad = 0;   ///< joint angle
  double object_bias_m = 0;    ///< object position, per axis of W
  // Random walks: standard deviation after one second.
  double position_drift_m = 0;  ///< contact position, per axis of the fingertip
  double force_drift_n = 0;     ///< normal force
  double object_drift_m = 0;    ///< object position, per axis of W
  double dropout = 0;           ///< share of the time in which a fingertip feels nothing, below 1
  double dropout_gap_s = 0;     ///< mean length of such a gap, at least a sample [s]
  double latency_s = 0;         ///< age of what a fingertip reports, at most 20 samples [s]

  /// Whether a fingertip has more than white noise and taxels.
  bool systematic() const {
    return position_bias_m > 0 || force_bias_n > 0 || position_drift_m > 0 || force_drift_n > 0 ||
           dropout > 0 || latency_s > 0;
  }
  bool operator==(const NoiseLevels&) const = default;
  template <typename V>
  void Fields(V& v) {
    v("position_m", position_m);
    v("normal_rad", normal_rad);
    v("force_n", force_n);
    v("joint_rad", joint_rad);
    v("object_position_m", object_position_m);
    v("object_rotation_rad", object_rotation_rad);
    v("taxel_pitch_m", taxel_pitch_m);
    v("object_rate_hz", object_rate_hz);
    v("object_delay_frames", object_delay_frames);
    v("position_bias_m", position_bias_m);
    v("force_bias_n", force_bias_n);
    v("joint_bias_rad", joint_bias_rad);
    v("object_bias_m", object_bias_m);
    v("position_drift_m", position_drift_m);
    v("force_drift_n", force_drift_n);
    v("object_drift_m", object_drift_m);
    v("dropout_fraction", dropout);
    v("dropout_gap_s", dropout_gap_s);
    v("latency_s", latency_s);
  }
};

/// Names in increasing order of noise: off, fine, paper, coarse, taxel.
std::span<const std::string_view> NoisePresetNames();
/// The preset with this name, or nothing.
std::optional<NoiseLevels> NoisePreset(std::string_view name);
/// Name of the preset equal to `levels`, or "custom".
std::string_view NoiseName(const NoiseLevels& levels);

}  // namespace regrasp
