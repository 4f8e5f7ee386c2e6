#include "core/exploration/surface_exploration.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace regrasp {
namespace {

// Position variance below which the least-squares rule distrusts a direction: contact noise that is
// left after filtering is about 0.13 mm.
constexpr double kRidge = 2e-8;    // m²
constexpr double kSameWall = 0.7;  // cosine between two walls that are taken for the same one

}  // namespace

Vector3d SurfaceExploration::Free(const Vector3d& vector_W, const Input& input,
                                  const ExplorationParameters& parameters) const {
  Vector3d free = TangentPart(vector_W, input.normal_W);
  const Vector3d excursion = TangentPart(input.p_WC - p_WC_start_, input.normal_W);
  const double distance = excursion.norm();
  if (distance > parameters.max_excursion)
    free -= std::max(0.0, free.dot(excursion) / distance) * excursion / distance;
  for (const Wall& wall : input.walls)
    if (Depth(wall) >= 0) free -= std::max(0.0, free.dot(wall.direction_W)) * wall.direction_W;
  return free;
}

double SurfaceExploration::Depth(const Wall& wall) const {
  double allowed = 0;
  for (const Wall& start : walls_start_)
    if (wall.kind == Wall::Kind::kMayStay && start.kind == Wall::Kind::kMayStay &&
        start.direction_W.dot(wall.direction_W) > kSameWall)
      allowed = std::max(allowed, start.depth);
  return wall.depth - allowed;
}

void SurfaceExploration::Start(const Input& input, Estimator estimator, std::uint64_t seed,
                               int max_cycles, const ExplorationParameters& parameters) {
  *this = SurfaceExploration();
  estimator_ = estimator;
  random_ = RandomStream(seed, 0);
  max_cycles_ = MaxCycles(max_cycles, parameters);
  p_WC_start_ = p_WC_prev_ = input.p_WC;
  walls_start_ = input.walls;
  phi_prev_ = input.phi;
  const Matrix3d R_WC = RotationFromZ(input.normal_W);
  const double sigma = parameters.sigma * parameters.gradient_max;
  const double gx = sigma * random_.Normal(), gy = sigma * random_.Normal();
  gradient_W_ = R_WC * Vector3d(gx, gy, 0);  // line 2
  gradient_norm_ = std::hypot(gx, gy);
}

bool SurfaceExploration::LeaveBlind(const Input& input, const ExplorationParameters& parameters) {
  const auto* const wall = std::ranges::find_if(input.walls, &Wall::blind);
  blind_cycles_ = wall == input.walls.end() ? 0 : blind_cycles_ + 1;
  if (blind_cycles_ == 0) return false;
  const double speed = std::min(
      std::max(parameters.wall_return * wall->depth, parameters.speed_min), parameters.speed_max);
  velocity_W_ = Free(-speed * wall->direction_W, input, parameters);
  p_WC_prev_ = input.p_WC;
  phi_prev_ = input.phi;
  return true;
}

void SurfaceExploration::Add(const Input& input, const ExplorationParameters& parameters) {
  switch (estimator_) {
    case Estimator::kSecant:
      return;  // two points are enough: the last update's, and the present one
    case Estimator::kLeastSquares: {
      const int n = std::max(1, parameters.update_cycles);
      return least_squares_.Add(input.p_WC, input.phi, std::pow(parameters.forgetting, 1.0 / n));
    }
  }
}

Vector3d SurfaceExploration::GradientOf(const Input& input, const Matrix3d& R_WC,
                                        const ExplorationParameters& parameters) const {
  switch (estimator_) {
    case Estimator::kSecant:
      return SecantEstimator::Gradient(p_WC_prev_, phi_prev_, input.p_WC, input.phi, R_WC,
                                       parameters.min_displacement);
    case Estimator::kLeastSquares:
      return least_squares_.Gradient(R_WC, kRidge);
  }
  return Vector3d::Zero();
}

SurfaceExploration::Status SurfaceExploration::Update(const Input& input,
                                                      const ExplorationParameters& parameters,
                                                      double dt) {
  if (cycle_ == max_cycles_) return Status::kMaxCycles;  // line 3
  ++cycle_;
  if (LeaveBlind(input, parameters))
    return blind_cycles_ * dt < parameters.onto_tip_s ? Status::kRunning : Status::kBlind;
  const Matrix3d R_WC = RotationFromZ(input.normal_W);
  const int n = std::max(1, parameters.update_cycles);
  const bool dithers = InfoOf(estimator_).dithers;
  Add(input, parameters);

  const double moved = TangentPart(input.p_WC - p_WC_prev_, input.normal_W).norm();
  if (cycle_ % n == 0 && moved >= parameters.min_displacement) {  // line 4
    const Vector3d gradient_C =
        LimitNorm(GradientOf(input, R_WC, parameters), parameters.gradient_max);  // line 7
    gradient_W_ = parameters.lambda * gradient_W_ +
                  (1.0 - parameters.lambda) * (R_WC * gradient_C);  // line 8
    p_WC_prev_ = input.p_WC;                                        // line 9
    phi_prev_ = input.phi;
    ++updates_;
    gradient_norm_ = Free(gradient_W_, input, parameters).norm();
    small_updates_ = gradient_norm_ <= parameters.epsilon ? small_updates_ + 1 : 0;
    if (small_updates_ >= parameters.converged_updates) return Status::kConverged;
  }

  const Vector3d tangent = Free(gradient_W_, input, parameters);
  const double norm = tangent.norm();
  velocity_W_.setZero();
  if (norm > 1e-9) {  // line 11
    // The dither keeps the finger moving anyway: what is left of a gradient that counts as
    // converged is mostly noise, and is followed the less the smaller it is.
    const double least = dithers ? parameters.speed_min * std::min(1.0, norm / parameters.epsilon)
                                 : parameters.speed_min;
    const double speed = std::min(std::max(parameters.eta * norm, least), parameters.speed_max);
    velocity_W_ = tangent * (speed / norm);
  }
  for (const Wall& wall : input.walls)
    velocity_W_ -=
        std::clamp(parameters.wall_return * Depth(wall), 0.0, 0.5 * parameters.speed_min) *
        wall.direction_W;
  if (dithers) {
    const double phase = 2.0 * std::numbers::pi * parameters.dither_hz * cycle_ * dt;
    velocity_W_ +=
        parameters.dither_speed * (std::cos(phase) * R_WC.col(0) + std::sin(phase) * R_WC.col(1));
  }
  return Status::kRunning;
}

}  // namespace regrasp
