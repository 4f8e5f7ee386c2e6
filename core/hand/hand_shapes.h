#pragma once

/// The collision shapes of one hand link from the <collision> elements of a URDF link. Used only by
/// the hand's loader.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/hand/hand_model.h"
#include "core/hand/mesh.h"
#include "core/hand/model_report.h"
#include "core/hand/problems.h"
#include "core/hand/urdf_file.h"

namespace regrasp {

/// What a URDF link is of a hand.
enum class LinkRole : std::uint8_t {
  kFingertip,  ///< may be one
  kOther,      ///< of the hand: the palm, a link of a finger
  kStand,      ///< what the hand stands on, an arm, a table, a floor: may be larger than a hand
};

class HandShapes {
 public:
  HandShapes(const UrdfFile& file, const LoadOptions& options, Problems* problems,
             ModelReport* report)
      : file_(file), options_(options), problems_(problems), report_(report) {}

  /// The shapes of `in`, posed in the frame of the link it is fixed to. A fingertip's mesh or
  /// disc, or where there are boxes only the farthest of them, is fitted by the capsule or sphere
  /// that its far end needs; else a mesh or a disc is fitted by what comes nearest to all of it.
  std::vector<Shape> Read(const UrdfLink& in, const Isometry3d& X_LG, LinkRole role);

 private:
  /// Whether a shape is no larger, and no farther from its link, than `most` [m]; else a problem.
  bool CheckSize(const UrdfLink& in, const UrdfCollision& collision, double most);
  /// Nothing where the file cannot be read, which is a problem.
  std::optional<Shape> OfMesh(const UrdfLink& in, const UrdfGeometry& geometry, const Isometry3d& X,
                              LinkRole role);
  Shape Fitted(const UrdfLink& in, const UrdfGeometry& geometry, const TriangleMesh& posed,
               const std::string& name, bool fingertip);
  /// The file named, or with fill_missing_meshes one of its name in a directory beside it; empty
  /// where there is none.
  std::filesystem::path Find(const UrdfLink& in, const UrdfGeometry& geometry);
  /// A capsule from the link's frame to the farthest frame of its children; where there is none, a
  /// ball as thick as the link before.
  Shape Filled(const UrdfLink& in, const UrdfGeometry& geometry);
  /// The link towards the root, but not the root, that has shapes; null where there is none.
  const UrdfLink* Before(const UrdfLink& in) const;
  const TriangleMesh* Mesh(const std::filesystem::path& file, const Vector3d& scale);

  const UrdfFile& file_;
  const LoadOptions& options_;
  Problems* problems_;
  ModelReport* report_;
  std::map<std::string, TriangleMesh> meshes_;  // by file and scale: hands repeat them
  std::map<std::string, double> half_widths_;   // of the thickest shape, by link [m]
};

}  // namespace regrasp
