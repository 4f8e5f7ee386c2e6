#pragma once

/// The noisy sensors: the one place where the simulator's truth becomes what the controller sees.
/// "Artificial white noise is superimposed on the feedback provided by the physics engine" (Sec. III).
/// One random stream per sensor, so that changing one level leaves the other sensors' noise unchanged.

#include "core/common/random.h"
#include "core/hand/hand_model.h"
#include "core/sensing/noise.h"
#include "core/sensing/sensor_reading.h"
#include "core/world/world.h"

namespace regrasp {

class Sensors {
 public:
  Sensors(const HandModel& hand, double dt, std::uint64_t seed);

  /// Takes effect at the next Read().
  void SetNoise(const NoiseLevels& levels) { levels_ = levels; }
  const NoiseLevels& noise() const { return levels_; }

  /// One reading per tick. A fingertip is in contact when its tip link touches the object with more
  /// than 0.01 N; with several contacts, the force-weighted mean is reported. Every stream advances by
  /// the same number of draws each tick, whatever touches.
  const SensorReading& Read(std::int64_t tick, const WorldState& truth);

  /// Feeds streams, delay line and held values to the hasher.
  void AddTo(StateHasher* hasher) const;

 private:
  struct DelayedPose { Vector3d p = Vector3d::Zero(); Quaterniond q = Quaterniond::Identity(); };
  const HandModel* hand_;
  double dt_;
  NoiseLevels levels_;
  RandomStream position_stream_, normal_stream_, force_stream_, joint_stream_, pose_position_stream_,
      pose_rotation_stream_;
  FixedVector<DelayedPose, 8> delay_line_;
  std::int64_t last_pose_frame_ = -1;
  SensorReading reading_;
};

}  // namespace regrasp
