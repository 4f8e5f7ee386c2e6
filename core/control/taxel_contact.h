#pragma once

/// Where a fingertip of taxels is touched. A taxel tells a cell, 6.6 mm wide on a tip of 7 mm
/// radius, not a point: its centre is off by up to half a cell and the normal by some 25 degrees.
/// Within the cell the contact is followed instead, like a position between two beacons:
///
///   - it begins where a fingertip would touch a ball about the object's centre;
///   - it moves as a fingertip rolls or slides over such a ball: the normal turns by the tip's way
///     over the surface divided by the distance of its centre from the object's;
///   - it is taken back to the border of the cell of the taxel that reports.

#include "core/common/frames.h"
#include "core/hand/taxels.h"

namespace regrasp {

class TaxelContact {
 public:
  TaxelContact() = default;
  /// The taxels of a fingertip, `pitch` [m] apart.
  TaxelContact(const TipAxes& tip, double pitch)
      : tip_(tip), pitch_(pitch), taxels_(MakeTaxels(tip, pitch)) {}
  double pitch() const { return pitch_; }  ///< 0: of no fingertip
  /// The object's outward normal (unit, in the frame of the tip link) next to `normal_L` for which
  /// the tip is touched in the cell of the taxel whose centre is nearest to `p_LC` [m].
  Vector3d IntoCell(const Vector3d& p_LC, const Vector3d& normal_L) const;

 private:
  Vector3d PointOf(const Vector3d& normal_L, const Vector3d& near_L) const;
  TipAxes tip_;
  double pitch_ = 0;
  Taxels taxels_;
};

}  // namespace regrasp
