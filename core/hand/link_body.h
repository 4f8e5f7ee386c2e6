#pragma once

/// Mass, centre and inertia of a link that is put together from bodies, or has none.

#include <string>

#include "core/hand/hand_model.h"
#include "core/hand/urdf_file.h"

namespace regrasp {

/// Adds a body that is fixed to the link at X_LG. Whether the sum can be a body is for later:
/// frames without mass are common.
void AddBodyTo(Link* link, const UrdfInertial& body, const Isometry3d& X_LG);

/// Why a link that moves cannot be like that; empty where it can: no mass, an inertia of no body,
/// or a centre of mass farther from its shapes and its joint than they are large. `told`: the file
/// gives it a body.
std::string WhyNoBody(const Link& link, bool told);

/// Why a link that moves is hardly like that, or "": a moment above m R², R: from its centre of
/// mass to the farthest corner of the box about its shapes and its joint. Shapes need not cover all
/// of a link, so that this is no error.
std::string WhyUnlikely(const Link& link);

/// Why no material is as dense as a link of this mass and these shapes, or "". No error either.
std::string WhyTooHeavy(const Link& link);

/// Mass (where there is none), centre and inertia of a homogeneous link of its shape.
void InventBody(Link* link);

}  // namespace regrasp
