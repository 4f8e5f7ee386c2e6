#pragma once

/// The linear programme behind a load margin (load_margin.h): which wrenches can contacts with
/// friction balance? The revised simplex method over the convex cone of contact wrenches.
/// Torques are divided by the torque scale [m], forces by the weight [N].

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "core/quality/grasp.h"

namespace regrasp::cone {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kUncapped = 1e29;   // a larger cap is none
inline constexpr double kGap = 1e-6;        // of the weight: where a maximisation stops
inline constexpr double kMaxSqueeze = 1e5;  // weights: a grasp that needs more does not hold
inline constexpr double kPivot = 1e-10;
inline constexpr int kMaxPivots = 400;  // per maximisation; typical 3, of the least direction 25

using Vector6d = Eigen::Matrix<double, 6, 1>;

/// The share of the friction cone's radius that a price takes out of a column: mu v_t of a hard
/// finger; of a soft one the ellipsoid's, with the price `spin` of a unit moment about the normal.
inline double ConeReach(double mu, double torsion, double v_t, double spin) {
  return torsion == 0 ? mu * v_t : std::hypot(mu * v_t, torsion * spin);
}

/// Two contacts side by side, which the machine prices at once; a place may be empty.
struct ContactPair {
  using Two = Eigen::Array2d;

  void Set(int place, const GraspContact& contact) {
    for (int k = 0; k < 3; ++k) {
      position[k](place) = contact.position(k);
      normal[k](place) = contact.inward_normal(k);
    }
    mu(place) = contact.mu;
    torsion(place) = contact.torsion;
  }
  /// The price of each contact's cheapest column, prices_f and prices_t being those of a unit force
  /// and a unit moment.
  Two Cheapest(const Vector3d& prices_f, const Vector3d& prices_t) const {
    Two v[3];
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      v[k] = prices_f(k) + (prices_t(i) * position[j] - prices_t(j) * position[i]);
    }
    const Two v_n = v[0] * normal[0] + v[1] * normal[1] + v[2] * normal[2];
    const Two v_2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    const Two v_t = (v_2 - v_n * v_n).max(0.0).sqrt();
    Two reach = mu * v_t;
    if ((torsion > 0).any()) {
      const Two spin = prices_t(0) * normal[0] + prices_t(1) * normal[1] + prices_t(2) * normal[2];
      for (int k = 0; k < 2; ++k) reach(k) = ConeReach(mu(k), torsion(k), v_t(k), spin(k));
    }
    return v_n - reach;
  }

  std::array<Two, 3> position{Two::Zero(), Two::Zero(), Two::Zero()};
  std::array<Two, 3> normal{Two::Zero(), Two::Zero(), Two::Zero()};
  Two mu = Two::Zero(), torsion = Two::Zero();
};

/// The first of the least of several values, found without a jump that the machine would have to
/// guess.
struct Least {
  double value;
  int index = -1;
  void Add(double v, int k) {
    index = v < value ? k : index;
    value = v < value ? v : value;
  }
};

/// What the programmes of one margin share.
struct Problem {
  std::span<const GraspContact> contacts;
  std::span<const ContactPair> pairs;  // of the same contacts, in order
  double inverse_scale;                // [1/m]
  double cap;                          // on each normal force; in weights
  bool capped() const { return cap < kUncapped; }
};

/// The wrench a(u) of a contact that costs least at these prices, per normal force: u along the
/// tangential part of the price of a force.
inline Vector6d CheapestWrench(const GraspContact& contact, const Vector3d& prices_f,
                               const Vector3d& prices_t, double inverse_scale) {
  Vector3d u = TangentPart(prices_f + prices_t.cross(contact.position), contact.inward_normal);
  const double length = u.norm();
  if (length > 0) u /= length;
  double slide = contact.mu, moment = 0;
  const double spin = prices_t.dot(contact.inward_normal);
  if (const double reach = ConeReach(contact.mu, contact.torsion, length, spin);
      contact.torsion > 0 && reach > 0) {
    slide = contact.mu * contact.mu * length / reach;
    moment = contact.torsion * contact.torsion * spin / reach;
  }
  const Vector3d f = contact.inward_normal - slide * u;
  Vector6d wrench;
  wrench << f, (contact.position.cross(f) - moment * contact.inward_normal) * inverse_scale;
  return wrench;
}

/// Revised simplex over the convex cone of contact wrenches. The columns are all the wrenches
/// a(u) = G (n + mu u), |u| = 1 (with a moment about n for soft fingers), of all contacts:
/// infinitely many, but the best one for given prices y has a closed form, u along the tangential
/// part of y. Every basis is feasible, hence a lower bound. Rows: 6 of wrench balance, then, with
/// capped normal forces, one per contact; rows beyond those stay those of the identity and never
/// enter. Units: weight, torque_scale.
template <int kRows>
class ConeSimplex {
 public:
  /// Phase 1: a basis of real columns with sum of wrenches = target. False where there is none;
  /// with `shortfall` only after the least sum of missing components has been found.
  bool Reach(const Problem& problem, const Vector6d& target, double* shortfall) {
    const auto n = static_cast<int>(problem.contacts.size());
    const int rows = kRows != Eigen::Dynamic ? kRows : 6 + n;
    problem_ = &problem;
    inverse_.setIdentity(rows, rows);
    x_.setConstant(rows, problem.cap);
    std::array<bool, 6> artificial;
    artificial.fill(true);
    for (int k = 0; k < 6; ++k) {
      if (target(k) < 0) inverse_(k, k) = -1.0;
      x_(k) = std::abs(target(k));
    }
    const double squeeze = problem.capped() ? problem.cap * n : kMaxSqueeze;
    for (int pivots = 0; pivots < kMaxPivots; ++pivots) {
      double rest = 0.0;
      bool any = false;
      prices_.setZero(rows);
      for (int k = 0; k < 6; ++k) {
        if (!artificial[k]) continue;
        any = true;
        rest += x_(k);
        prices_ -= inverse_.row(k).transpose();
      }
      if (!any) return true;
      const double gain = -Price();
      if (shortfall != nullptr) *shortfall = rest;
      if (gain < kPivot || (shortfall == nullptr ? gain * squeeze < rest : gain * squeeze < kGap))
        return false;
      const int leaving = RatioTest(x_, column_);
      if (leaving < 0) return false;
      Pivot(*this, leaving);
      if (leaving < 6) artificial[leaving] = false;
    }
    return false;
  }

  /// Phase 2, from the basis of `start`: towards the largest delta with
  /// target + sign * delta * (unit wrench `axis`) reachable. reached() is a lower bound from now
  /// on.
  void Begin(const ConeSimplex& start, int axis, double sign) {
    start_ = &start;
    problem_ = start.problem_;
    column_ = -sign * start.inverse_.col(axis);
    objective_ = RatioTest(start.x_, column_);
    reached_ = objective_ < 0 ? kInfinity : start.x_(objective_) * (1.0 / column_(objective_));
  }
  /// One step. False where reached() is the largest delta already.
  bool Advance() {
    if (start_ != nullptr) {  // only a direction that is ever advanced needs a basis of its own
      if (objective_ >= 0) Pivot(*start_, objective_);
      start_ = nullptr;
    }
    if (reached_ == kInfinity || ++pivots_ > kMaxPivots) return false;
    prices_ = inverse_.row(objective_).transpose();
    const double gain = -Price();
    if (gain * (x_.sum() + 1.0) < kGap) return false;
    const int leaving = RatioTest(x_, column_);
    if (leaving >= 0) Pivot(*this, leaving);
    reached_ = leaving < 0 ? kInfinity : x_(objective_);
    return true;
  }
  double reached() const { return reached_; }

 private:
  using Column = Eigen::Matrix<double, kRows, 1>;
  using Square = Eigen::Matrix<double, kRows, kRows>;

  /// The column with the least prices_ᵀ a; leaves inverse_ * a in column_.
  double Price() {
    const Problem& problem = *problem_;
    const Vector3d y_f = prices_.template head<3>();
    const Vector3d y_t = prices_.template segment<3>(3) * problem.inverse_scale;
    const bool capped = problem.capped();
    const auto n = static_cast<int>(problem.contacts.size());
    Least best{kInfinity};  // index: twice the contact's, and one more for its slack
    for (int pair = 0; 2 * pair < n; ++pair) {
      const ContactPair::Two cheapest = problem.pairs[pair].Cheapest(y_f, y_t);
      for (int i = 2 * pair; i < std::min(n, 2 * pair + 2); ++i) {
        const double slack = capped ? prices_(6 + i) : 0.0;
        best.Add(cheapest(i - 2 * pair) + slack, 2 * i);
        if (capped) best.Add(slack, 2 * i + 1);
      }
    }
    if (best.index < 0) return 0.0;
    const int contact = best.index / 2;
    if (best.index % 2 != 0) {
      column_ = inverse_.col(6 + contact);
      return best.value;
    }
    column_ = inverse_.template leftCols<6>() *
              CheapestWrench(problem.contacts[contact], y_f, y_t, problem.inverse_scale);
    if (capped) column_ += inverse_.col(6 + contact);
    return best.value;
  }

  /// The basic variable of x, all >= 0, that reaches zero first as `column` enters; -1 where none
  /// does.
  static int RatioTest(const Column& x, const Column& column) {
    // As products and not as choices; where the variable does not fall the ratio is infinite or
    // NaN, never the least.
    const Column falls = ((column.array() - kPivot) * 1e300).max(0.0).min(1.0);  // 0 or 1
    const Column ratios = x.array() / (column.array().abs() * falls.array());
    Least least{kInfinity};
    for (int k = 0; k < ratios.size(); ++k) least.Add(ratios(k), k);
    return least.index;
  }

  /// This basis becomes that of `from` with column_ in the place of basic variable `row`.
  void Pivot(const ConeSimplex& from, int row) {
    const double scale = 1.0 / column_(row);
    const double step = from.x_(row) * scale;
    x_ = from.x_ - step * column_;
    x_(row) = step;
    x_ = x_.cwiseMax(0.0);
    column_(row) -= 1.0;
    const Column pivot_row = from.inverse_.row(row).transpose() * scale;
    if (inverse_.cols() != from.inverse_.cols()) inverse_.resizeLike(from.inverse_);
    for (int k = 0; k < pivot_row.size(); ++k)
      inverse_.col(k) = from.inverse_.col(k) - column_ * pivot_row(k);
  }

  const Problem* problem_ = nullptr;
  const ConeSimplex* start_ = nullptr;  // whose basis this one still has
  int objective_ = -1;                  // row of delta
  int pivots_ = 0;
  double reached_ = 0;
  Square inverse_;
  Column x_, prices_, column_;
};

}  // namespace regrasp::cone
