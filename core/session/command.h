#pragma once

/// Commands to a session. Fixed size, no text beyond names: made by the daemon's command table
/// after validation, applied by the session at a tick boundary.

#include <cstdint>

#include "core/common/frames.h"
#include "core/exploration/gradient_estimator.h"
#include "core/exploration/objective.h"
#include "core/sensing/noise.h"
#include "core/session/job_table.h"

namespace regrasp {

struct Command {
  CommandType type = CommandType::kStop;
  std::int64_t job = 0;  ///< id of the new job, chosen by the caller; or the job to cancel; branch:
                         ///< new id of the running job, 0 = keep
  int finger = -1;       ///< explore
  Criterion criterion = Criterion::kManipulability;
  Estimator estimator = kDefaultEstimator;
  std::uint64_t seed = 0;                  ///< explore: direction of the start gradient; branch
  bool reseed = false;                     ///< branch: the sensors' noise goes on from `seed`
  int max_cycles = 0;                      ///< explore: 0 = parameter exploration.max_cycles
  bool continuous = false;                 ///< rotate
  double angle_rad = 0;                    ///< rotate, signed
  Vector3d axis_W = Vector3d::UnitZ();     ///< rotate, unit
  double speed_rad_s = 0;                  ///< rotate: 0 = parameter gait.speed_rad_s
  Vector3d offset_W = Vector3d::Zero();    ///< move: of the object's centre [m]
  Vector3d rotation_W = Vector3d::Zero();  ///< move: rotation vector [rad]; not both zero
  NoiseLevels noise;
  Vector3d force_W = Vector3d::Zero();  ///< push [N]
  double duration_s = 0;                ///< push
  int parameter = -1;                   ///< index into ParameterTable()
  Vector3d value = Vector3d::Zero();
};

}  // namespace regrasp
