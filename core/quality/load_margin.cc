#include "core/quality/load_margin.h"

#include <array>
#include <vector>

#include "core/quality/cone_simplex.h"

namespace regrasp {
namespace {

using cone::ConeSimplex;
using cone::ContactPair;
using cone::Least;
using cone::Problem;
using cone::Vector6d;

constexpr double kDegeneracyShift = 1e-6;  // of the weight: makes the programme non-degenerate

template <int kRows>
double Solve(const Problem& problem, const Vector3d& weight, double unit, bool is_signed) {
  Vector6d target;
  target << -weight / unit, Vector3d::Zero();
  // Any generic direction will do.
  Vector6d shift;
  shift << 0.31, -0.47, 0.73, 0.59, -0.23, 0.89;
  target += kDegeneracyShift * shift;

  ConeSimplex<kRows> start;
  double shortfall = 0;
  if (!start.Reach(problem, target, is_signed ? &shortfall : nullptr)) return -shortfall * unit;
  // Always on with the direction that has come least far: none goes beyond the least of all.
  std::array<ConeSimplex<kRows>, 12> directions;
  std::array<double, 12> reached;
  for (int k = 0; k < 12; ++k) {
    directions[k].Begin(start, k / 2, k % 2 == 0 ? 1.0 : -1.0);
    reached[k] = directions[k].reached();
  }
  for (;;) {
    Least least{cone::kInfinity};
    for (int k = 0; k < 12; ++k) least.Add(reached[k], k);
    if (least.index < 0 || !directions[least.index].Advance()) return least.value * unit;
    reached[least.index] = directions[least.index].reached();
  }
}

double Margin(std::span<const GraspContact> contacts, const Vector3d& weight, double torque_scale,
              double max_force, bool is_signed) {
  const double norm = weight.norm();
  const double unit = norm > 0 ? norm : 1.0;
  std::array<ContactPair, (kMaxFingers + 1) / 2> few;
  std::vector<ContactPair> many;  // only for grasps that no hand of ours has
  std::span<ContactPair> pairs(few);
  if (contacts.size() > kMaxFingers) {
    many.resize((contacts.size() + 1) / 2);
    pairs = many;
  }
  for (std::size_t i = 0; i < contacts.size(); ++i)
    pairs[i / 2].Set(static_cast<int>(i % 2), contacts[i]);
  const Problem problem{contacts, pairs, 1.0 / torque_scale,
                        max_force < cone::kUncapped ? max_force / unit : max_force};
  const auto solve = [&]<int kRows>() { return Solve<kRows>(problem, weight, unit, is_signed); };
  if (!problem.capped()) return solve.operator()<6>();
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
