#pragma once

/// What a scenario says of links and joints, held against the hand's file: mistakes are the
/// scenario's, with its lines. Used only by its loader.

#include "core/hand/toml_file.h"
#include "core/hand/urdf_file.h"

namespace regrasp {

/// Adds to the problems of `file` what it names that `urdf` has not, a fingertip with too few or
/// too many joints before it, and couplings that lead in a ring or turn too little or too far.
/// Values of another kind than they must have are told elsewhere. `sees_all`: no key of the
/// scenario is misspelt; else joints before a fingertip are not counted.
void CheckScenarioNames(const TomlFile& file, UrdfFile urdf, bool sees_all);

}  // namespace regrasp
