#pragma once

/// Every number that may be changed while running, with unit, range and source: the table behind
/// `param list|get|set`, the configuration file and the documentation. A new parameter is a member
/// of one of the structures and a row of the table in parameters.cc.

#include <cstdint>
#include <span>
#include <string_view>

#include "core/common/fields.h"
#include "core/common/frames.h"
#include "core/control/control_parameters.h"
#include "core/exploration/exploration_parameters.h"
#include "core/gait/gait_parameters.h"
#include "core/shape/shape_parameters.h"

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
  ShapeParameters shape;
  template <typename V>
  void Fields(V& v);
};

/// How a parameter's value is written, and what it may be.
enum class ParameterType : std::uint8_t {
  kReal,     ///< one number
  kInteger,  ///< one number without fraction
  kBoolean,  ///< true or false
  kWord,     ///< one of a list of words
  kVector,   ///< three numbers: a vector in W
};
std::string_view Name(ParameterType type);  ///< "real", "integer", "boolean", "word", "vector"

/// One row of the table. A value of any type goes as three numbers: (x, 0, 0) for one number, 0 or
/// 1 for a boolean, the place in `words` for a word.
struct ParameterInfo {
  std::string_view name;  ///< "exploration.lambda"
  ParameterType type = ParameterType::kReal;
  std::string_view unit;                                ///< "" when dimensionless
  double min = 0, max = 0;                              ///< per component, inclusive
  std::span<const std::string_view> words = {};         ///< kWord: in the order of their numbers
  std::string_view meaning;                             ///< one sentence
  std::string_view source;                              ///< of the default: "paper", "ours", ...
  Vector3d (*get)(const Parameters&) = nullptr;         ///< components beyond size() are 0
  void (*set)(Parameters*, const Vector3d&) = nullptr;  ///< the value must be allowed

  int size() const { return type == ParameterType::kVector ? 3 : 1; }
  /// What stands before the point: "exploration".
  std::string_view group() const { return name.substr(0, name.find('.')); }
};

struct LoadedScenario;
/// The compiled-in defaults, with friction and mass of the object model and gravity of the
/// scenario.
Parameters DefaultParameters(const LoadedScenario& model);

/// Whether setting it sets others, too. In a batch it goes first, so that those keep the values
/// that the batch gives them.
bool IsPreset(const ParameterInfo& info);
bool IsSetByPreset(const ParameterInfo& info);

/// Sets one parameter as a user does: gait.preset sets those it stands for, too. The value must be
/// allowed.
void SetByUser(const ParameterInfo& info, const Vector3d& value, Parameters* parameters);

/// Sorted by name.
std::span<const ParameterInfo> ParameterTable();
/// Index into the table, or -1.
int FindParameter(std::string_view name);

template <typename V>
void Parameters::Fields(V& v) {
  for (const ParameterInfo& info : ParameterTable()) {
    Vector3d value = info.get(*this);
    for (int k = 0; k < info.size(); ++k)
      v(info.name.data(), value[k], FieldRange{info.min, info.max});
    if constexpr (V::kWrites) info.set(this, value);
  }
}

}  // namespace regrasp
