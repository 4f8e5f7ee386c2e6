#pragma once

/// The object's surface as the fingers have felt it, in the object's frame: what touching reveals
/// of an unknown object (the paper's figure 3a), kept so that the gait can plan on it.
///
/// A cube map about the object's centre: each cell keeps the running mean of the contacts felt in
/// its directions. Between cells log r is interpolated, with each cell's slope from its normal:
///
///   log r(d) = Σ w_i (log r_i + g_i . t_i e^(−θ_i²/θ_s²)) / Σ w_i,   w_i = c_i / (θ_i² + θ_0²)²
///   g_i = −(tangential part of n_i) / (n_i . u_i),   t_i: the way from u_i to d on the unit sphere
///
/// with u_i the cell's mean direction, θ_i the angle from it to d, c_i its confidence. Far from all
/// that was felt the mean of log r takes over. One radius per direction: star-shaped bodies only.

#include <array>
#include <cstdint>

#include "core/common/fields.h"
#include "core/common/frames.h"
#include "core/shape/shape_parameters.h"

namespace regrasp {

/// What is known of the surface in one direction from the object's centre.
struct SurfacePoint {
  Vector3d p_O = Vector3d::Zero();        ///< [m]
  Vector3d normal_O = Vector3d::UnitZ();  ///< outward, unit
  double unknown = 0;  ///< angle to the nearest felt direction [rad]; pi where nothing was felt
  double bend = 0;     ///< spread of the normals felt about it: large near an edge [rad]
};

class FeltSurface {
 public:
  static constexpr int kGrid = 12;  ///< cells along an edge of the cube: 7.5 deg each
  static constexpr int kCells = 6 * kGrid * kGrid;
  static constexpr int kMostSamples = 100000;  ///< shape.memory at most

  struct Cell {
    Vector3d direction_sum = Vector3d::Zero();  ///< of unit vectors: its direction is u_i
    Vector3d normal_sum = Vector3d::Zero();
    double log_radius = 0;
    int count = 0;  ///< samples, at most shape.memory

    bool operator==(const Cell&) const = default;
    template <typename V>
    void Fields(V& v) {
      v("direction_sum", direction_sum);
      v("normal_sum", normal_sum);
      v("log_radius", log_radius);
      v("count", count, FieldRange{1, kMostSamples});
    }
  };

  /// What it goes by from now on; what was felt stays.
  void Use(const ShapeParameters& parameters) { parameters_ = parameters; }
  const ShapeParameters& parameters() const { return parameters_; }
  /// A contact: point [m] and outward unit normal, in O. Left out where the point is nearer than
  /// 1 mm to the centre, or the normal does not point away from it: no star-shaped body has such.
  /// `samples` (>= 1): it counts as so many alike, however little is remembered.
  void Add(const Vector3d& p_O, const Vector3d& normal_O, int samples = 1);
  /// The surface in direction `d` (any length > 0). Some microseconds; no allocation.
  SurfacePoint At(const Vector3d& d_O) const;
  /// SurfacePoint::bend alone, at a tenth of the cost; 0 where nothing was felt nearby.
  double BendAt(const Vector3d& d_O) const;
  void Reset() {
    const ShapeParameters parameters = parameters_;
    *this = FeltSurface();
    parameters_ = parameters;
  }

  int touched_cells() const { return num_touched_; }
  /// Share of all directions whose cell has been felt, 0 to 1.
  double touched_share() const { return static_cast<double>(num_touched_) / kCells; }
  double mean_radius() const;  ///< geometric mean over the felt cells [m]
  const Cell& cell(int i) const { return cells_[i]; }
  /// The middle of a cell's directions, unit.
  static Vector3d CellDirection(int i);
  static int CellOf(const Vector3d& d_O);
  template <typename V>
  void Fields(V& v) {
    if constexpr (V::kLoads) Reset();  // cells that are not listed have not been felt
    v("num_touched", num_touched_, FieldRange{0, kCells});
    for (int i = 0; i < num_touched_; ++i) {
      v("touched", touched_[i], FieldRange{0, kCells - 1});
      if constexpr (V::kLoads)
        if (cells_[touched_[i]].count > 0) v.Refuse("touched", "names a cell twice");
      v("cell", cells_[touched_[i]]);
    }
    v("log_radius_sum", log_radius_sum_);
  }

 private:
  double Weight(double angle2) const;

  ShapeParameters parameters_;  // the session's, not part of its state
  std::array<Cell, kCells> cells_{};
  std::array<std::int16_t, kCells> touched_{};  // indices of felt cells, in order of their first
  int num_touched_ = 0;
  double log_radius_sum_ = 0;  // over the felt cells
};

}  // namespace regrasp
