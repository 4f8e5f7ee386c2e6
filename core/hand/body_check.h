#pragma once

/// Whether the links of a hand that move can be bodies, and whether its file means what it says of
/// them. Used only by the hand's loader.

#include <map>

#include "core/hand/hand_model.h"
#include "core/hand/model_report.h"
#include "core/hand/problems.h"
#include "core/hand/urdf_file.h"

namespace regrasp {

/// What an <inertial> has not, or "".
std::string WhatLacks(const UrdfInertial& body);

/// The line that tells the body of a link: its <inertia>, or the link where it has none.
int BodyLine(const UrdfLink& link);

/// Looks at every link of `hand` but the palm; `file` has a link of each one's name, whose
/// <inertial> is the first part of the body; `lacking`: by number, the part whose
/// <inertial> is not whole. Findings: a body that cannot be (WhyNoBody) is added
/// to `problems`; one that hardly can be (WhyUnlikely), and a moment that three links or more have
/// in all axes, which exporters write for want of masses, are warned of. With
/// `options.inertia_from_shape` such a link gets the body of its shape instead (InventBody), and
/// each is only warned of. A mass that no material has in its shapes (WhyTooHeavy) is warned of in
/// any case and kept; a negative one has been told where it was read.
void CheckBodies(const UrdfFile& file, const std::map<int, const UrdfLink*>& lacking,
                 const LoadOptions& options, HandModel* hand, Problems* problems);

}  // namespace regrasp
