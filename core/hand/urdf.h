#pragma once

/// Hands from URDF files. What is read, and what our reading adds to the format:
///   - revolute and continuous joints; fixed joints merge their child into its parent; <mimic>
///   makes
///     a coupled joint (HandModel); a scenario may lock joints;
///   - <sphere>, <box>, and <cylinder>, of a hand read as a CAPSULE: the cylinder's axis is the
///     segment, and round ends of the same radius are added (URDF has no capsule);
///   - <mesh>: fitted by a capsule, sphere or box, its error reported;
///   - <visual>, <transmission>, <gazebo> and the like are ignored.
/// Objects: object_loader.h.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/hand/hand_model.h"
#include "core/hand/model_error.h"
#include "core/hand/model_report.h"
#include "core/hand/object_loader.h"

namespace regrasp {

/// Damping of a joint whose <dynamics damping> is missing [N m s/rad]: what public models of small
/// hands use. Without any, a hand shakes off what it holds.
inline constexpr double kDefaultDamping = 0.05;

/// Effort of a joint whose <limit> effort is 0, as exporters of CAD programs leave it [N m]: what
/// public models of small hands have.
inline constexpr double kDefaultEffort = 1;

/// What a URDF cannot say about a hand.
struct HandLayout {
  struct Finger {
    std::string name;
    std::string
        tip_link;  ///< link (or frame fixed to one) whose capsule or sphere is the fingertip
  };
  std::vector<Finger> fingers;
  double armature = 0;  ///< of every joint's drive [kg m²]
  /// The URDF's root in H: turns the hand so that its fingers point to +z, its palm to -y and its
  /// thumb side to +x.
  Isometry3d X_HR = Isometry3d::Identity();
  /// Joints held at an angle [rad], by name: a wrist, say.
  std::map<std::string, double> locked;
  /// Couplings that the file does not tell, by name of the joint that follows: as <mimic>.
  struct Coupling {
    std::string driver;
    double ratio = 1, offset = 0;  ///< of the angle, [] and [rad]
  };
  std::map<std::string, Coupling> coupled;
  double damping = kDefaultDamping;  ///< where the file says none [N m s/rad]
  double least_damping = 0;          ///< smaller ones of the file are raised to it [N m s/rad]
};

/// Loads and checks a hand. Driven joints are numbered finger by finger in the layout's order, root
/// to tip, then any outside the fingers in the file's order; coupled joints follow. Without coupled
/// joints, joint j moves link j + 1; link 0 is the palm. The end of the tip's shape farther from
/// its joint (or nearer to a tip frame without shape) gives Finger::p_LF and tip_radius. Adds to
/// `report` where given. Throws ModelError with all that is wrong, each with its line.
HandModel LoadHand(const std::filesystem::path& urdf_file, const HandLayout& layout,
                   const LoadOptions& options = {}, ModelReport* report = nullptr);

}  // namespace regrasp
