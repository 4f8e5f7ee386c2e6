#pragma once

/// What a loader did beyond reading: for `hand check`, `object show` and the log.

#include <string>
#include <vector>

namespace regrasp {

/// How far the loaders may go for a file that is not right. Each is named by the message that
/// refuses the file without it.
struct LoadOptions {
  bool force = false;  ///< take bodies that cannot exist (moment, centre of mass, density)
  bool inertia_from_shape = false;   ///< mass kept; centre and inertia of a homogeneous body
  bool inertia_as_told = false;      ///< an object's, to show a file that is refused: one of no
                                     ///< body is taken, one that is missing is 0
  bool fill_missing_meshes = false;  ///< a hand's mesh file that is not there: a capsule along the
                                     ///< link
};

struct ModelWarning {
  std::string file;
  int line = 0;         ///< 0: of the whole file
  std::string element;  ///< `link "a1"`, `joint "A"`, or empty
  std::string text;     ///< cause and value, lower case, no full stop

  /// "FILE:LINE: element: text".
  std::string Line() const;
};

/// A mesh of a hand's link that became a shape.
struct ShapeFit {
  std::string link;        ///< URDF link
  std::string mesh;        ///< file
  std::string shape;       ///< "sphere", "capsule" or "box"
  double error_m = 0;      ///< largest distance of a point of the mesh from the shape's surface
  double rms_m = 0;        ///< root mean square of the same
  bool fingertip = false;  ///< over the round end that touches, or all where none fits
};

struct ModelReport {
  std::vector<ModelWarning> warnings;
  std::vector<ShapeFit> fits;
};

}  // namespace regrasp
