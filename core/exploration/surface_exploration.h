#pragma once

/// Algorithm 1 of the paper: "Object surface exploration, maximizing phi".
///
///    1  i = 0
///    2  gradient in W <- random, N(0, sigma)
///    3  while ++i <= N_max and |P R_WCᵀ gradient| > epsilon
///    4    every n cycles:
///    5      dc_C = P R_WCᵀ (p_WC_prev - p_WC)
///    6      gradient_C = component-wise secant, or least squares   (gradient_estimator.h)
///    7      limit its norm to gradient_max
///    8      gradient <- lambda gradient + (1 - lambda) R_WC gradient_C
///    9      phi_prev <- phi, p_WC_prev <- p_WC
///   11    commanded contact displacement = eta R_WC P R_WCᵀ gradient, to the hybrid controller
///
/// Departures from the print, each with its reason:
///  - line 2: the start is tangential, sigma scaled by gradient_max so that it is of phi's own
///    magnitude. The gait starts from the gradient of the finger's last exploration (StartFrom).
///  - line 3: the test must hold for `converged_updates` consecutive updates; an instantaneous one
///    ends runs whose estimate merely crosses zero.
///  - line 4: an update also waits until the contact has moved by `min_displacement`.
///  - line 4: behind a blind wall no gradient is felt, and the finger leaves it whatever phi does;
///    where that takes longer than `onto_tip_s` at a time the status is kBlind, and it
///    is for the caller to go on without that wall.
///  - line 5: R_WCᵀ where the print has T (see SecantEstimator).
///  - line 3 and 11: the search is bounded. Beyond `max_excursion` from the start, at a joint limit
///    and at another finger (walls) the part of the gradient that points on is removed, from the
///    motion and from the test: a constrained maximum counts as converged. Where the finger
///    starts beyond a wall that it may stay at, the wall stands where it started.
///  - line 11: the displacement is per second, limited to [speed_min, speed_max].
/// The class knows nothing of the hand: it turns contact points and values of phi into velocities.

#include <cstdint>

#include "core/common/fixed_vector.h"
#include "core/common/limits.h"
#include "core/common/random.h"
#include "core/exploration/gradient_estimator.h"

namespace regrasp {

/// A direction in which the finger must not go on.
struct Wall {
  /// What a finger does that starts beyond it.
  enum class Kind : std::uint8_t {
    kMayStay,
    kMustLeave,  ///< is pushed out while it explores
    kBlind,      ///< leaves before it explores: there the contact does not follow it, no gradient
  };
  Vector3d direction_W = Vector3d::Zero();  ///< unit tangent, into the wall
  double depth = 0;                         ///< how far the contact is beyond it, >= 0 [m]
  Kind kind = Kind::kMayStay;
  bool blind() const { return kind == Kind::kBlind; }
  template <typename V>
  void Fields(V& v) {
    v("direction_W", direction_W);
    v("depth", depth);
    v("kind", kind, Kind::kBlind);
  }
};

/// Room for every wall that a finger can have at once: two limits per joint, the end of its round
/// tip, the rest of its last link against the object, two links against two of every other finger,
/// and one for who bounds the search from outside.
inline constexpr std::size_t kMaxWalls = 2 * kMaxFingerJoints + 2 + 4 * (kMaxFingers - 1) + 1;
using Walls = FixedVector<Wall, kMaxWalls>;

class SurfaceExploration {
 public:
  enum class Status : std::uint8_t {
    kRunning,
    kConverged,
    kMaxCycles,
    kBlind,  ///< could not leave a blind wall
  };

  /// What line 5 to 11 need, every tick.
  struct Input {
    Vector3d p_WC = Vector3d::Zero();       ///< sensed contact point [m]
    Vector3d normal_W = Vector3d::UnitZ();  ///< sensed outward object normal
    double phi = 0;                         ///< objective, of order 1
    Walls walls;                            ///< what FindWalls() finds
  };

  /// Lines 1 and 2. `max_cycles`: N_max; 0 takes the parameter's.
  void Start(const Input& input, Estimator estimator, std::uint64_t seed, int max_cycles,
             const ExplorationParameters& parameters);
  /// Replaces the random start of line 2 by what is known of the gradient, in W [1/m].
  void StartFrom(const Vector3d& gradient_W) { gradient_W_ = gradient_W; }
  /// One pass of the loop. dt: [s] per cycle.
  Status Update(const Input& input, const ExplorationParameters& parameters, double dt);

  /// Line 11: wanted velocity of the contact over the surface, in W, tangential [m/s].
  const Vector3d& velocity_W() const { return velocity_W_; }
  /// The smoothed gradient, in W [1/m].
  const Vector3d& gradient_W() const { return gradient_W_; }
  /// |P R_WCᵀ gradient| of the last update, what points into walls removed [1/m].
  double gradient_norm() const { return gradient_norm_; }
  int cycle() const { return cycle_; }
  template <typename V>
  void Fields(V& v) {
    v("estimator", estimator_, kLastEstimator);
    v("random", random_);
    v("least_squares", least_squares_);
    v("cycle", cycle_);
    v("max_cycles", max_cycles_);
    v("updates", updates_);
    v("small_updates", small_updates_);
    v("blind_cycles", blind_cycles_);
    v("p_WC_start", p_WC_start_);
    v("p_WC_prev", p_WC_prev_);
    v("walls_start", walls_start_);
    v("phi_prev", phi_prev_);
    v("gradient_W", gradient_W_);
    v("gradient_norm", gradient_norm_);
    v("velocity_W", velocity_W_);
  }

 private:
  /// The part of a gradient or velocity along which the finger may move.
  Vector3d Free(const Vector3d& vector_W, const Input& input,
                const ExplorationParameters& parameters) const;
  /// What the estimator keeps of this tick, and lines 5 and 6: its gradient in C [1/m].
  void Add(const Input& input, const ExplorationParameters& parameters);
  Vector3d GradientOf(const Input& input, const Matrix3d& R_WC,
                      const ExplorationParameters& parameters) const;
  /// Moves out from behind a blind wall; false where there is none.
  bool LeaveBlind(const Input& input, const ExplorationParameters& parameters);
  /// How far the finger is beyond a wall, or beyond where it started if that was beyond the wall
  /// too; below 0 the wall is not reached [m].
  double Depth(const Wall& wall) const;

  Estimator estimator_ = kDefaultEstimator;
  RandomStream random_;
  LeastSquaresEstimator least_squares_;
  int cycle_ = 0;
  int max_cycles_ = 0;
  int updates_ = 0;
  int small_updates_ = 0;  // consecutive, with the gradient below epsilon
  int blind_cycles_ = 0;   // in a row behind a blind wall
  Vector3d p_WC_start_ = Vector3d::Zero(), p_WC_prev_ = Vector3d::Zero();
  Walls walls_start_;
  double phi_prev_ = 0;
  Vector3d gradient_W_ = Vector3d::Zero();
  double gradient_norm_ = 0;
  Vector3d velocity_W_ = Vector3d::Zero();
};

}  // namespace regrasp
