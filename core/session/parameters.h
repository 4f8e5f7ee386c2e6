#pragma once

/// Every number that may be changed while running, with unit, range and source: the table behind
/// `param list|get|set`, the configuration file and the documentation.

#include <span>
#include <string_view>

#include "core/common/frames.h"
#include "core/control/control_parameters.h"
#include "core/exploration/exploration_parameters.h"
#include "core/gait/gait_parameters.h"

namespace regrasp {

struct ObjectParameters {
  double friction = 0.8;  ///< object.friction
  double mass_kg = 0.08;  ///< object.mass_kg
};

struct StartParameters {
  double joint_sigma_rad = 0.0523598775598;  ///< spread of the preshape over seeds (3 deg)
  double displacement_m =
      0;  ///< every fingertip arrives so far from its place, in a random direction
  double object_sigma_m = 0.002;  ///< spread of the object's start position over seeds
};

struct Parameters {
  ObjectParameters object;
  StartParameters start;
  Vector3d gravity_W = Vector3d(0, 0, -9.81);  ///< gravity [m/s²]
  ControlParameters control;
  ExplorationParameters exploration;
  GaitParameters gait;
};

struct ParameterInfo {
  std::string_view name;           ///< "exploration.lambda"
  std::string_view unit;           ///< "" when dimensionless
  double min, max;                 ///< per component, inclusive
  int size;                        ///< 1, or 3 for a vector in W
  std::string_view description;    ///< one sentence
  std::string_view source;         ///< "paper", "PHYSICS: measured", "ours: ..." and so on
  double* (*access)(Parameters&);  ///< first component
};

struct LoadedScenario;
/// The compiled-in defaults, with friction and mass of the object model and gravity of the
/// scenario.
Parameters DefaultParameters(const LoadedScenario& model);

/// Sorted by name.
std::span<const ParameterInfo> ParameterTable();
/// Index into the table, or -1.
int FindParameter(std::string_view name);

}  // namespace regrasp
