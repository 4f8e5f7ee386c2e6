#pragma once

/// A hand of which some fingers are not used.

#include "core/common/finger_set.h"
#include "core/hand/hand_model.h"
#include "core/hand/urdf.h"

namespace regrasp::hand {

/// The layout without some fingers; the joints that move nothing else are locked, stretched.
HandLayout Without(const HandModel& hand, HandLayout layout, FingerSet out);

}  // namespace regrasp::hand
