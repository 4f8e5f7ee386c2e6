#pragma once

/// The object's surface as felt, its distance from the true one as colour. Internal to snapshots/.

#include <vector>

#include "core/hand/object_model.h"
#include "core/session/shape_judge.h"
#include "core/shape/felt_mesh.h"
#include "core/shape/felt_surface.h"
#include "snapshots/axes.h"
#include "snapshots/object_view.h"

namespace regrasp {

/// The felt surface beside the truth.
struct FeltPicture {
  FeltMesh mesh;
  std::vector<double>
      errors;  ///< of each vertex: its distance from the true surface, 0 where not drawn [m]
  double scale = 1e-3;  ///< the error that has the full colour [m]
  ShapeErrors judged;
};
FeltPicture JudgeFelt(const FeltSurface& felt, const ObjectModel& object);

/// Farther from what was felt the surface is not drawn [rad].
inline constexpr double kFeltReach = 0.2;

/// Where it was felt, the part that faces the viewer.
void DrawFelt(Canvas* canvas, const ObjectView& view, const FeltPicture& picture);

/// Blue inside the true surface, white on it, vermilion outside; `share` of the full colour, -1 to
/// 1.
Colour ErrorColour(double share);

/// Scale of the colours, the share that was touched, and the figures below.
std::vector<LegendEntry> FeltFacts(const FeltPicture& picture);
/// How well the surface was felt, in the directions touched for long; empty where there are none.
std::vector<LegendEntry> FeltFigures(const FeltPicture& picture);

}  // namespace regrasp
