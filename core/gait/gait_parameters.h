#pragma once

namespace regrasp {

struct GaitParameters {
  double speed_rad_s = 0.2094395102;  ///< object speed during its motion phase (12 deg/s)
};

}  // namespace regrasp
