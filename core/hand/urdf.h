#pragma once

/// Hands and objects from URDF files. What is read, and what our reading adds to the format:
///   - revolute joints with finite, ordered limits; fixed joints merge their child into its parent;
///   - <sphere>, <box>, and <cylinder> read as a CAPSULE: the cylinder's axis is the segment, and
///   round
///     ends of the same radius are added (URDF has no capsule);
///   - <mesh> for objects only: closed, facing outwards, its file beside the URDF;
///   - <visual>, <transmission>, <gazebo> and the like are ignored.

#include <filesystem>
#include <string>
#include <vector>

#include "core/hand/hand_model.h"
#include "core/hand/model_error.h"
#include "core/hand/object_model.h"

namespace regrasp {

/// What a URDF cannot say about a hand.
struct HandLayout {
  struct Finger {
    std::string name;
    std::string
        tip_link;  ///< link (or frame fixed to one) whose capsule or sphere is the fingertip
  };
  std::vector<Finger> fingers;
  double armature = 0;  ///< of every joint's drive [kg m²]
};

/// Loads and checks a hand. Joints are numbered finger by finger in the layout's order, root to
/// tip, then any joints outside the fingers by name; joint j moves link j + 1, link 0 is the palm.
/// The end of the tip link's shape farther from its joint gives Finger::p_LF and tip_radius. Throws
/// ModelError.
HandModel LoadHand(const std::filesystem::path& urdf_file, const HandLayout& layout);

/// Loads and checks an object: one link with one <collision>. Its origin is moved to the centre of
/// mass; a sphere, box or cylinder must be centred there, unrotated. Throws ModelError.
ObjectModel LoadObjectUrdf(const std::filesystem::path& urdf_file);

}  // namespace regrasp
