#pragma once

/// The noisy sensors: the one place where the simulator's truth becomes what the controller sees.
/// "Artificial white noise is superimposed on the feedback provided by the physics engine" (Sec.
/// III). One random stream per sensor, so that changing one level leaves the other sensors' noise
/// unchanged.
///
/// Sensors sample at kSensorRateHz whatever the physics step: a reading is held until the next
/// sample is due (at a step longer than a sample, every tick samples once).

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/common/fields.h"
#include "core/common/random.h"
#include "core/hand/hand_model.h"
#include "core/hand/kinematics.h"
#include "core/hand/taxels.h"
#include "core/sensing/fingertip_errors.h"
#include "core/sensing/noise.h"
#include "core/sensing/sensor_reading.h"
#include "core/world/world.h"

namespace regrasp {

inline constexpr double kSensorRateHz = 1000;
/// Time from one sample to the next, of a physics step of `dt` [s].
constexpr double SampleTime(double dt) { return std::max(dt, 1 / kSensorRateHz); }
/// Largest NoiseLevels::object_delay_frames; more is treated as this.
inline constexpr int kMaxPoseDelay = 7;

/// What a noise-free fingertip feels: the force-weighted mean of the finger's contacts that press
/// on the object. In contact when that is more than 0.01 N along the normal.
FingertipReading TrueFingertip(const WorldState& truth, int finger);

class Sensors {
 public:
  /// `hand` must outlive the sensors. `dt`: tick [s].
  Sensors(const HandModel& hand, double dt, std::uint64_t seed);

  /// Takes effect at the next sample. Changing the object's rate or delay empties the delay line.
  void SetNoise(const NoiseLevels& levels);
  const NoiseLevels& noise() const { return levels_; }
  /// The noise of later samples follows `seed`; levels, delay line and held reading stay.
  void Reseed(std::uint64_t seed);

  /// One reading per tick; `tick` never decreases. A fingertip feels TrueFingertip() and its noise.
  /// Streams of white noise advance by the same number of draws each sample, whatever touches;
  /// those of drift and dropout while their level is above 0.
  ///
  /// With taxels (taxel_pitch_m > 0) the contact position, after its noise, snaps to the nearest
  /// taxel centre, and the normal is opposite to that taxel's outward direction (see taxels.h).
  ///
  /// With object_rate_hz > 0 the object pose is sampled when frame floor(t rate) begins and
  /// reported object_delay_frames later, so that with a delay of 1 the reported pose is 1 to 2
  /// frames old. Until that many frames exist the oldest one is reported. The delay needs a rate.
  const SensorReading& Read(std::int64_t tick, const WorldState& truth);

  template <typename V>
  void Fields(V& v) {
    v("levels", levels_);
    v("position_stream", position_stream_);
    v("normal_stream", normal_stream_);
    v("force_stream", force_stream_);
    v("joint_stream", joint_stream_);
    v("pose_position_stream", pose_position_stream_);
    v("pose_rotation_stream", pose_rotation_stream_);
    v("joint_biases", joint_biases_);
    v("object_bias", object_bias_);
    v("object_drift", object_drift_);
    v("object_drift_stream", object_drift_stream_);
    v("errors", errors_);
    v("last_sample", last_sample_, kCountOrNone);
    v("pose_frames", pose_frames_);
    v("num_pose_frames", num_pose_frames_, FieldRange{0, kMaxPoseDelay + 1.0});
    v("last_pose_frame", last_pose_frame_, kCountOrNone);
    v("reading", reading_);
    if constexpr (V::kLoads)
      if (reading_.q.size() != hand_->num_joints() ||
          reading_.fingertips.size() != hand_->fingers.size())
        v.Refuse("reading", "is of another hand");
  }

 private:
  struct Pose {
    std::int64_t tick = 0;  // in which it was sampled
    Vector3d p = Vector3d::Zero();
    Quaterniond q = Quaterniond::Identity();
    template <typename V>
    void Fields(V& v) {
      v("tick", tick);
      v("p", p);
      v("q", q);
    }
  };
  void ReadFingertips(const WorldState& truth);
  void ReadObject(std::int64_t tick, const WorldState& truth);

  const HandModel* hand_;
  double dt_;
  NoiseLevels levels_;
  RandomStream position_stream_, normal_stream_, force_stream_, joint_stream_,
      pose_position_stream_, pose_rotation_stream_;
  JointVector joint_biases_;                  // in standard deviations
  Vector3d object_bias_ = Vector3d::Zero();   // the same, in W
  Vector3d object_drift_ = Vector3d::Zero();  // [m], in W
  RandomStream object_drift_stream_;
  std::array<FingertipErrors, kMaxFingers> errors_;
  std::int64_t last_sample_ = -1;
  std::array<Pose, kMaxPoseDelay + 1> pose_frames_;  ///< newest first
  int num_pose_frames_ = 0;
  std::int64_t last_pose_frame_ = -1;
  std::array<TipAxes, kMaxFingers> tips_;
  KinematicsData kinematics_;  ///< of the truth; used only with taxels and systematic errors
  SensorReading reading_;
};

}  // namespace regrasp
