#include "core/quality/load_margin.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace regrasp {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kUncapped = 1e29;  // a larger cap is none
constexpr double kDegeneracyShift =
    1e-6;                            // of the weight: makes the linear programme non-degenerate
constexpr double kGap = 1e-6;        // of the weight: where a maximisation stops
constexpr double kMaxSqueeze = 1e5;  // weights: a grasp that needs more does not hold
constexpr double kPivot = 1e-10;
constexpr int kMaxPivots = 400;  // per maximisation; typical 3, of the least direction 25

using Vector6d = Eigen::Matrix<double, 6, 1>;

/// The share of the friction cone's radius that a price takes out of a column: mu v_t of a hard
/// finger; of a soft one the ellipsoid's, with the price `spin` of a unit moment about the normal.
double ConeReach(const GraspContact& contact, double v_t, double spin) {
  return contact.torsion == 0 ? contact.mu * v_t
                              : std::hypot(contact.mu * v_t, contact.torsion * spin);
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
  ConeSimplex(std::span<const GraspContact> contacts, double torque_scale, double cap)
      : contacts_(contacts),
        inverse_scale_(1.0 / torque_scale),
        capped_(cap < kUncapped),
        rows_(kRows != Eigen::Dynamic ? kRows : 6 + static_cast<int>(contacts.size())),
        cap_(cap) {}

  /// Phase 1: a basis of real columns with sum of wrenches = target. False where there is none;
  /// with `shortfall` only after the least sum of missing components has been found.
  bool Reach(const Vector6d& target, double* shortfall) {
    inverse_.setIdentity(rows_, rows_);
    x_.setConstant(rows_, cap_);
    for (int k = 0; k < 6; ++k) {
      if (target(k) < 0) inverse_(k, k) = -1.0;
      x_(k) = std::abs(target(k));
      artificial_[k] = true;
    }
    const double squeeze = capped_ ? cap_ * static_cast<double>(contacts_.size()) : kMaxSqueeze;
    for (int pivots = 0; pivots < kMaxPivots; ++pivots) {
      double rest = 0.0;
      bool any = false;
      prices_.setZero(rows_);
      for (int k = 0; k < 6; ++k) {
        if (!artificial_[k]) continue;
        any = true;
        rest += x_(k);
        prices_ -= inverse_.row(k).transpose();
      }
      if (!any) return true;
      const double gain = -Price();
      if (shortfall != nullptr) *shortfall = rest;
      if (gain < kPivot || (shortfall == nullptr ? gain * squeeze < rest : gain * squeeze < kGap))
        return false;
      const int leaving = RatioTest();
      if (leaving < 0) return false;
      Pivot(leaving);
      if (leaving < 6) artificial_[leaving] = false;
    }
    return false;
  }

  /// Phase 2, from the basis of Reach(): towards the largest delta with target + delta * direction
  /// reachable. reached() is a lower bound from now on.
  void Begin(const Vector6d& direction) {
    column_ = -(inverse_.template leftCols<6>() * direction);
    objective_ = RatioTest();
    if (objective_ < 0) {
      unbounded_ = true;
    } else {
      Pivot(objective_);
    }
  }
  /// One step. False where reached() is the largest delta already.
  bool Advance() {
    if (unbounded_ || ++pivots_ > kMaxPivots) return false;
    prices_ = inverse_.row(objective_).transpose();
    const double gain = -Price();
    if (gain * (x_.sum() + 1.0) < kGap) return false;
    const int leaving = RatioTest();
    unbounded_ = leaving < 0;
    if (!unbounded_) Pivot(leaving);
    return true;
  }
  double reached() const { return unbounded_ ? kInfinity : x_(objective_); }

 private:
  using Column = Eigen::Matrix<double, kRows, 1>;
  using Square = Eigen::Matrix<double, kRows, kRows>;

  /// The column with the least prices_ᵀ a; leaves inverse_ * a in column_.
  double Price() {
    const Vector3d y_f = prices_.template head<3>();
    const Vector3d y_t = prices_.template segment<3>(3) * inverse_scale_;
    double best = kInfinity;
    int best_contact = -1;
    bool best_is_slack = false;
    Vector3d best_v = Vector3d::Zero();
    double best_spin = 0;
    for (int i = 0; i < static_cast<int>(contacts_.size()); ++i) {
      const GraspContact& contact = contacts_[i];
      const Vector3d v = y_f + y_t.cross(contact.position);
      const double v_n = v.dot(contact.inward_normal);
      const double v_t = std::sqrt(std::max(0.0, v.squaredNorm() - v_n * v_n));
      const double slack = capped_ ? prices_(6 + i) : 0.0;
      const double spin = y_t.dot(contact.inward_normal);
      const double value = v_n - ConeReach(contact, v_t, spin) + slack;
      if (value < best) {
        best = value;
        best_contact = i;
        best_is_slack = false;
        best_v = v;
        best_spin = spin;
      }
      if (capped_ && slack < best) {
        best = slack;
        best_contact = i;
        best_is_slack = true;
      }
    }
    if (best_contact < 0) return 0.0;
    if (best_is_slack) {
      column_ = inverse_.col(6 + best_contact);
      return best;
    }
    const GraspContact& contact = contacts_[best_contact];
    Vector3d u = TangentPart(best_v, contact.inward_normal);
    const double length = u.norm();
    if (length > 0) u /= length;
    double slide = contact.mu, moment = 0;
    if (const double reach = ConeReach(contact, length, best_spin);
        contact.torsion > 0 && reach > 0) {
      slide = contact.mu * contact.mu * length / reach;
      moment = contact.torsion * contact.torsion * best_spin / reach;
    }
    const Vector3d f = contact.inward_normal - slide * u;
    Vector6d wrench;
    wrench << f, (contact.position.cross(f) - moment * contact.inward_normal) * inverse_scale_;
    column_ = inverse_.template leftCols<6>() * wrench;
    if (capped_) column_ += inverse_.col(6 + best_contact);
    return best;
  }

  /// The basic variable that reaches zero first as column_ enters; -1 where none does.
  int RatioTest() const {
    int leaving = -1;
    double step = kInfinity;
    for (int k = 0; k < rows_; ++k) {
      if (column_(k) <= kPivot) continue;
      const double ratio = x_(k) / column_(k);
      if (ratio < step) {
        step = ratio;
        leaving = k;
      }
    }
    return leaving;
  }

  void Pivot(int row) {
    const double scale = 1.0 / column_(row);
    const double step = x_(row) * scale;
    x_ -= step * column_;
    x_(row) = step;
    x_ = x_.cwiseMax(0.0);
    column_(row) -= 1.0;
    pivot_row_ = inverse_.row(row).transpose() * scale;
    for (int k = 0; k < rows_; ++k) inverse_.col(k) -= column_ * pivot_row_(k);
  }

  std::span<const GraspContact> contacts_;
  double inverse_scale_;
  bool capped_;
  int rows_;
  double cap_;
  bool artificial_[6] = {};
  int objective_ = -1;  // row of delta
  int pivots_ = 0;
  bool unbounded_ = false;
  Square inverse_;
  Column x_, prices_, column_, pivot_row_;
};

template <typename T, std::size_t... k>
std::array<T, sizeof...(k)> Copies(const T& value, std::index_sequence<k...>) {
  return {((void)k, value)...};
}

template <int kRows>
double Solve(std::span<const GraspContact> contacts, const Vector3d& weight, double torque_scale,
             double max_force, bool is_signed) {
  const double norm = weight.norm();
  const double unit = norm > 0 ? norm : 1.0;
  Vector6d target;
  target << -weight / unit, Vector3d::Zero();
  // Any generic direction will do.
  Vector6d shift;
  shift << 0.31, -0.47, 0.73, 0.59, -0.23, 0.89;
  target += kDegeneracyShift * shift;

  ConeSimplex<kRows> start(contacts, torque_scale,
                           max_force < kUncapped ? max_force / unit : max_force);
  double shortfall = 0;
  if (!start.Reach(target, is_signed ? &shortfall : nullptr)) return -shortfall * unit;
  // Always on with the direction that has come least far: none goes beyond the least of all.
  std::array<ConeSimplex<kRows>, 12> directions = Copies(start, std::make_index_sequence<12>());
  for (int k = 0; k < 12; ++k)
    directions[k].Begin((k % 2 == 0 ? 1.0 : -1.0) * Vector6d::Unit(k / 2));
  const auto least = [&] {
    return std::min_element(directions.begin(), directions.end(),
                            [](const auto& a, const auto& b) { return a.reached() < b.reached(); });
  };
  auto current = least();
  while (current->Advance()) current = least();
  const double margin = current->reached();
  return margin * unit;
}

double Margin(std::span<const GraspContact> contacts, const Vector3d& weight, double torque_scale,
              double max_force, bool is_signed) {
  const auto solve = [&]<int kRows>() {
    return Solve<kRows>(contacts, weight, torque_scale, max_force, is_signed);
  };
  if (!(max_force < kUncapped)) return solve.operator()<6>();
  // An even number of rows: two at a time fit a register.
  if (contacts.size() <= 4) return solve.operator()<10>();
  if (contacts.size() <= 6) return solve.operator()<12>();
  if (contacts.size() <= kMaxFingers) return solve.operator()<6 + kMaxFingers>();
  return solve.operator()<Eigen::Dynamic>();
}

}  // namespace

double LoadMargin(std::span<const GraspContact> contacts, const Vector3d& weight,
                  double torque_scale, double max_force) {
  return Margin(contacts, weight, torque_scale, max_force, false);
}

double SignedLoadMargin(std::span<const GraspContact> contacts, const Vector3d& weight,
                        double torque_scale, double max_force) {
  return Margin(contacts, weight, torque_scale, max_force, true);
}

}  // namespace regrasp
