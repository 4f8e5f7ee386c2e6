#include "core/quality/epsilon.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/quality/wrench_hull.h"

namespace regrasp {
namespace {

constexpr double kInside = 1e-9;
constexpr std::size_t kTickWrenches = 8 * kMaxFingers;
constexpr std::size_t kTickFacets = 8192;  // twice the whole hull of 8 contacts with 8 edges
constexpr std::size_t kMaxFacets = 2'000'000;

/// Facets before and after an insertion, up to kMaxFacets: no 6-dimensional polytope with n
/// vertices has more than half of it [McMullen 1970], and the old ones go when the new ones are
/// there.
std::size_t FacetRoom(std::size_t n) {
  const double m = static_cast<double>(std::max<std::size_t>(n, 7));
  const double bound = m * (m - 4) * (m - 5) / 3;
  return static_cast<std::size_t>(std::min<double>(bound, kMaxFacets));
}

}  // namespace

struct EpsilonSolver::Impl {
  std::vector<Wrench> wrenches;
  WrenchHull hull;
  std::size_t attempt = 0;  // index of the tolerance
  double bound = 0.0;
  bool done = true;
  bool exact = true;

  void Start() {
    if (hull.Start(wrenches, WrenchHull::kTolerances[attempt])) return;
    done = true;  // flat: the origin is not inside
  }

  void Finish() {
    if (bound <= kInside) bound = 0.0;
    done = true;
  }

  void Advance() {
    const int nearest = hull.NearestOpen();
    bound = std::max(bound, hull.Offset(nearest));
    switch (hull.Insert(nearest)) {
      case WrenchHull::Growth::kGrown:
        return;
      case WrenchHull::Growth::kClosed:
        return Finish();
      case WrenchHull::Growth::kFailed:
        if (++attempt < WrenchHull::kTolerances.size()) return Start();
        exact = false;
        return Finish();
    }
  }
};

EpsilonSolver::EpsilonSolver() : impl_(std::make_unique<Impl>()) {
  impl_->wrenches.reserve(kTickWrenches);
  impl_->hull.Reserve(kTickWrenches, kTickFacets);
}
EpsilonSolver::~EpsilonSolver() = default;
EpsilonSolver::EpsilonSolver(EpsilonSolver&&) noexcept = default;
EpsilonSolver& EpsilonSolver::operator=(EpsilonSolver&&) noexcept = default;

void EpsilonSolver::Begin(std::span<const GraspContact> contacts, double torque_scale, int edges) {
  Impl& s = *impl_;
  s.wrenches.clear();
  AppendPrimitiveWrenches(contacts, torque_scale, edges, s.wrenches);
  if (s.wrenches.size() > kTickWrenches)
    s.hull.Reserve(s.wrenches.size(), FacetRoom(s.wrenches.size()));
  s.attempt = 0;
  s.bound = 0.0;
  s.done = false;
  s.exact = true;
  s.Start();
}

bool EpsilonSolver::Step(int max_facets) {
  Impl& s = *impl_;
  std::size_t made = 0;
  while (!s.done && made < static_cast<std::size_t>(max_facets)) {
    const std::size_t before = s.hull.facets_built();
    s.Advance();
    const std::size_t after = s.hull.facets_built();
    made += after >= before ? after - before : after;  // less: started again
  }
  return s.done;
}

double EpsilonSolver::Compute(std::span<const GraspContact> contacts, double torque_scale,
                              int edges) {
  Begin(contacts, torque_scale, edges);
  Step(std::numeric_limits<int>::max());
  return result();
}

bool EpsilonSolver::done() const { return impl_->done; }
double EpsilonSolver::result() const { return impl_->bound; }
double EpsilonSolver::lower_bound() const { return impl_->bound; }
bool EpsilonSolver::exact() const { return impl_->exact; }

double WrenchHullVolume(std::span<const GraspContact> contacts, double torque_scale, int edges) {
  std::vector<Wrench> wrenches;
  AppendPrimitiveWrenches(contacts, torque_scale, edges, wrenches);
  if (wrenches.size() > kMaxHullWrenches)
    throw std::length_error("wrench hull: " + std::to_string(wrenches.size()) +
                            " primitive wrenches; allowed: at most " +
                            std::to_string(kMaxHullWrenches));
  WrenchHull hull;
  hull.Reserve(wrenches.size(), FacetRoom(wrenches.size()));
  for (const double tolerance : WrenchHull::kTolerances) {
    if (!hull.Start(wrenches, tolerance)) return 0.0;
    if (hull.Complete()) return hull.Volume();
  }
  throw std::runtime_error("wrench hull: rounding defeats every tolerance");
}

}  // namespace regrasp
