#pragma once

/// What a hand's URDF tells about its fingers and its palm, for a scenario that is not written yet.

#include <filesystem>
#include <string>
#include <vector>

#include "core/hand/urdf.h"

namespace regrasp {

struct HandGuess {
  HandLayout layout;  ///< fingers, palm frame, wrist joints locked at 0 or the limit nearest to it
  std::vector<std::string> notes;  ///< one line each: what was taken for what
};

/// Reads the file and finds
///   - fingers: the chains that end in a link that moves nothing more, if it has a <collision>;
///     joints that move all of them are a wrist and are locked;
///   - tips: the link of that body whose shapes reach farthest from its joint;
///   - names: thumb, first, middle, ring, little where the file's names tell, else finger1, ... and
///     thumb for the one of four or more that points elsewhere;
///   - damping, where the file says none or too little for a hold: by the fingers' length;
///   - the palm frame H: z along the stretched fingers, -y where they bend to (towards the larger
///     end of the outer joints' ranges), origin amid their first joints.
/// Throws ModelError where the file cannot be read or has fewer than 2 or more than 8 fingers.
HandGuess GuessHand(const std::filesystem::path& urdf_file);

}  // namespace regrasp
