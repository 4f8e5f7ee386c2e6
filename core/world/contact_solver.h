#pragma once

/// The forces of soft contacts with dry friction. For the rows r of a linear map A from forces to
/// velocities, find f with
///
///   normal:    s_r = 0 and f_r >= 0, or f_r = 0 where s_r > 0,
///   friction:  s_r = 0 and |f_r| <= mu f_normal(r), or f_r at the bound against the motion,
///
/// where s = A f + rate + softness f is the speed along the rows.
///
/// These are the equations of ODE's contact joints: a spring and damper along the normal, the
/// friction pyramid across it. With the friction cone instead, the bound is on the two friction
/// rows r and t of a contact together,
///
///   cone:      (s_r, s_t) = 0 and |(f_r, f_t)| <= mu f_normal(r), or at the bound against it.
///
/// Method: projected Gauss-Seidel in turn with direct solutions for the rows that are not at a
/// bound [Silcowitz, Niebe, Erleben, "Projected Gauss-Seidel subspace minimization method for
/// interactive rigid body dynamics", GRAPP 2010]. Started from the last step's forces the first
/// direct solution is nearly always the answer, and one sweep shows it.

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace regrasp {

struct ContactSolverLimits {
  int max_sweeps = 200;      ///< 1 to 10000
  double tolerance = 1e-8;   ///< largest change of a force in the last sweep [N], > 0
  int direct_solutions = 4;  ///< at most so many, 0 to 100
};

template <int kMaxRows>
class ContactSolver {
 public:
  /// Starts a problem with `rows` rows; the matrix and the vectors are the caller's to fill.
  void Resize(int rows) {
    A.resize(rows, rows);
    rate.resize(rows);
    force.resize(rows);
    softness.resize(rows);
    normal.resize(rows);
  }
  int rows() const { return static_cast<int>(rate.size()); }

  /// Starts from the forces in `force`. `friction`: mu; `cone`: instead of the pyramid. Returns the
  /// sweeps it took.
  int Solve(double friction, bool cone, const ContactSolverLimits& limits) {
    cone_ = cone;
    for (int r = 0; r < rows(); ++r) inverse_[r] = 1.0 / (A(r, r) + softness[r]);
    int sweeps = 0;
    bool settled = rows() == 0;
    for (int direct = 0; !settled && sweeps < limits.max_sweeps; ++sweeps) {
      if (direct < limits.direct_solutions && SolveDirectly(friction)) ++direct;
      settled = !(Sweep(friction) > limits.tolerance);
    }
    return sweeps;
  }

  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxRows, kMaxRows>;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxRows, 1>;
  Matrix A;         ///< symmetric [m/(N s)]: velocity along a row per force along another
  Vector rate;      ///< velocity without the forces, minus the wanted one [m/s]
  Vector force;     ///< in: a guess; out: the solution [N]
  Vector softness;  ///< ODE's cfm [m/(N s)]
  /// Of a friction row: its normal row r, the friction rows being r + 1 and r + 2; -1: of a normal.
  Eigen::Matrix<int, Eigen::Dynamic, 1, 0, kMaxRows, 1> normal;

 private:
  static constexpr int kMaxDirect = 24;        // rows; beyond, sweeps are cheaper
  static constexpr double kAtBound = 0.999;    // of the friction bound: taken to be at it
  static constexpr double kLeastPivot = 1e-6;  // of the largest diagonal: rows are independent

  /// One sweep; returns the largest change of a force [N].
  double Sweep(double friction) {
    double change = 0;
    const auto set = [&](int r, double now) {
      change = std::max(change, std::abs(now - force[r]));
      force[r] = now;
    };
    for (int r = 0; r < rows(); ++r) {
      double now = force[r] - Speed(r) * inverse_[r];
      if (normal[r] < 0) {
        set(r, now > 0 ? now : 0);
        continue;
      }
      const double bound = friction * force[normal[r]];
      if (!cone_) {
        set(r, now > bound ? bound : now < -bound ? -bound : now);
        continue;
      }
      // One step for both, so that the force at the bound is against the motion.
      const double step = std::min(inverse_[r], inverse_[r + 1]);
      now = force[r] - Speed(r) * step;
      const double across = force[r + 1] - Speed(r + 1) * step;
      const double size = std::hypot(now, across), share = size > bound ? bound / size : 1;
      set(r, share * now);
      set(++r, share * across);
    }
    return change;
  }

  /// s_r, the speed along a row with the present forces [m/s].
  double Speed(int r) const {
    const int n = rows();
    double speed = rate[r] + softness[r] * force[r];
    const double* a = A.data() + static_cast<std::ptrdiff_t>(r) * n;
    for (int s = 0; s < n; ++s) speed += a[s] * force[s];
    return speed;
  }

  /// Solves for the rows that the present forces show to be free, with friction at its bound
  /// following the normal force. False, and nothing changed, where that is not possible.
  bool SolveDirectly(double friction) {
    int free = 0;
    for (int r = 0; r < rows(); ++r) {
      position_[r] = -1;
      slip_[r] = 0;
      if (normal[r] < 0) {
        if (!(force[r] > 0)) continue;
      } else {
        const double bound = friction * force[normal[r]];
        if (!(bound > 0)) continue;
        const double size = cone_ ? std::hypot(force[r], force[OtherOf(r)]) : std::abs(force[r]);
        if (size >= kAtBound * bound) {
          slip_[r] = friction * (force[r] / size);
          continue;
        }
      }
      if (free == kMaxDirect) return false;
      position_[r] = free;
      row_of_[free++] = r;
    }
    if (free == 0) return false;
    for (int i = 0; i < free; ++i) {
      const int r = row_of_[i];
      for (int j = 0; j < free; ++j) system_[i][j] = A(r, row_of_[j]);
      system_[i][i] += softness[r];
      system_[i][free] = -rate[r];
      for (int t = 0; t < rows(); ++t)
        if (slip_[t] != 0) system_[i][position_[normal[t]]] += slip_[t] * A(r, t);
    }
    if (!Eliminate(free)) return false;
    for (int r = 0; r < rows(); ++r)
      force[r] = position_[r] >= 0 ? system_[position_[r]][free] : 0.0;
    for (int r = 0; r < rows(); ++r)
      if (slip_[r] != 0) force[r] = slip_[r] * force[normal[r]];
    return true;
  }

  /// The other friction row of its contact.
  int OtherOf(int r) const { return r == normal[r] + 1 ? r + 1 : r - 1; }

  /// Gauss elimination with row exchange of the first n rows of system_, right side in column n.
  bool Eliminate(int n) {
    double largest = 0;
    for (int k = 0; k < n; ++k) largest = std::max(largest, std::abs(system_[k][k]));
    const double least = kLeastPivot * largest;
    for (int k = 0; k < n; ++k) {
      int best = k;
      for (int i = k + 1; i < n; ++i)
        if (std::abs(system_[i][k]) > std::abs(system_[best][k])) best = i;
      if (best != k) std::swap(system_[best], system_[k]);
      const double pivot = system_[k][k];
      if (!(std::abs(pivot) > least)) return false;
      const double scale = 1.0 / pivot;
      for (int i = k + 1; i < n; ++i) {
        const double factor = system_[i][k] * scale;
        if (factor == 0) continue;
        for (int j = k + 1; j <= n; ++j) system_[i][j] -= factor * system_[k][j];
      }
    }
    for (int k = n - 1; k >= 0; --k) {
      double sum = system_[k][n];
      for (int j = k + 1; j < n; ++j) sum -= system_[k][j] * system_[j][n];
      system_[k][n] = sum / system_[k][k];
    }
    return true;
  }

  bool cone_ = false;
  std::array<double, kMaxRows> inverse_, slip_;
  std::array<int, kMaxRows> position_;
  std::array<int, kMaxDirect> row_of_;
  std::array<std::array<double, kMaxDirect + 1>, kMaxDirect> system_;
};

}  // namespace regrasp
