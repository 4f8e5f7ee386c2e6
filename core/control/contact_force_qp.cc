#include "core/control/contact_force_qp.h"

#include <algorithm>
#include <cmath>

namespace regrasp {

Vector3d ProjectOntoTruncatedCone(const Vector3d& f, const Vector3d& axis, double mu, double lower,
                                  double cap) {
  double n = axis.dot(f);
  const Vector3d tangent = f - n * axis;
  const double t = tangent.norm();
  double new_t = t;
  if (t > mu * n) {
    // Outside the cone: onto its side, or onto its apex where even that is behind.
    n = std::max(0.0, (n + mu * t) / (1.0 + mu * mu));
    new_t = mu * n;
  }
  if (n < lower || n > cap) {
    n = std::clamp(n, lower, std::max(lower, cap));
    new_t = std::min(t, mu * n);
  }
  return n * axis + (t > 1e-12 ? Vector3d(tangent * (new_t / t)) : Vector3d(Vector3d::Zero()));
}

const FixedVector<Vector3d, kMaxFingers>& ContactForceQp::Solve(const ForceProblem& problem) {
  const std::size_t n = problem.contacts.size();
  const double inv_R2 = 1.0 / (problem.torque_scale * problem.torque_scale);
  const double w = problem.grip_weight;
  std::array<Vector3d, kMaxFingers> x, y, next;
  double lipschitz = static_cast<double>(n) + w;  // bounds the largest eigenvalue of the Hessian
  for (std::size_t i = 0; i < n; ++i) {
    const ForceContact& c = problem.contacts[i];
    lipschitz += c.r.squaredNorm() * inv_R2;
    const Vector3d start =
        has_warm_[c.finger] ? warm_[c.finger] : Vector3d(c.grip * c.inward_normal);
    x[i] = y[i] =
        ProjectOntoTruncatedCone(start, c.inward_normal, problem.mu, problem.lower, c.cap);
  }
  const double step = 1.0 / lipschitz;
  double momentum = 1.0;
  auto Residuals = [&](const std::array<Vector3d, kMaxFingers>& f, Vector3d* force,
                       Vector3d* torque) {
    *force = -problem.force;
    *torque = -problem.torque;
    for (std::size_t i = 0; i < n; ++i) {
      *force += f[i];
      *torque += problem.contacts[i].r.cross(f[i]);
    }
  };
  Vector3d e_f, e_t;
  for (int k = 0; k < kIterations; ++k) {
    Residuals(y, &e_f, &e_t);
    e_t *= inv_R2;
    const double next_momentum = 0.5 * (1.0 + std::sqrt(1.0 + 4.0 * momentum * momentum));
    const double beta = (momentum - 1.0) / next_momentum;
    for (std::size_t i = 0; i < n; ++i) {
      const ForceContact& c = problem.contacts[i];
      const Vector3d gradient = e_f + e_t.cross(c.r) + w * (y[i] - c.grip * c.inward_normal);
      next[i] = ProjectOntoTruncatedCone(y[i] - step * gradient, c.inward_normal, problem.mu,
                                         problem.lower, c.cap);
    }
    for (std::size_t i = 0; i < n; ++i) {
      y[i] = next[i] + beta * (next[i] - x[i]);
      x[i] = next[i];
    }
    momentum = next_momentum;
  }
  Residuals(x, &e_f, &e_t);
  residual_ = std::sqrt(e_f.squaredNorm() + e_t.squaredNorm() * inv_R2);
  has_warm_.fill(false);
  forces_.clear();
  for (std::size_t i = 0; i < n; ++i) {
    warm_[problem.contacts[i].finger] = x[i];
    has_warm_[problem.contacts[i].finger] = true;
    forces_.push_back(x[i]);
  }
  return forces_;
}

}  // namespace regrasp
