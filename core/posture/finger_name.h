#pragma once

/// Which finger a name is of.

#include <string>
#include <string_view>

namespace regrasp {

/// "thumb", "first", "middle", "ring" or "little" by the name of a link or joint ("rh_FFJ1",
/// "Index_Finger_Distal"); empty where it tells none. The first word of the name that tells
/// counts: "ffmiddle" and "index_middle" are of the first finger.
std::string FingerNameIn(std::string_view name);

}  // namespace regrasp
