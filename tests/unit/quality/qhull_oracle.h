#pragma once

#include <vector>

#include "core/quality/wrench_hull.h"

namespace regrasp::test {

/// The whole hull by qhull: least signed facet distance and volume.
struct QhullAnswer {
  bool ok = false;  ///< false where qhull refuses (flat or imprecise input)
  double least_offset = 0.0;
  double volume = 0.0;
};
QhullAnswer RunQhull(const std::vector<Wrench>& points);

}  // namespace regrasp::test
