#pragma once

/// What a URDF document says and nobody simulates, though its writer may count on it. Used only by
/// urdf_check.cc.

#include <tinyxml2.h>

#include "core/hand/problems.h"

namespace regrasp {

/// Warns of <contact> (PyBullet's), of <dynamics friction> other than 0 and of the soft limits of
/// <safety_controller>: once for each, by the first link or joint that has it.
void WarnOfUnused(const tinyxml2::XMLElement& robot, Problems* problems);

}  // namespace regrasp
