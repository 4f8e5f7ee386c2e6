#include "core/quality/wrench_hull.h"

#include <Eigen/LU>
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace regrasp {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kFlat = 1e-8;               // of the largest wrench: thinner sets span no volume
constexpr std::size_t kSeamFacets = 100000;  // most new facets of one insertion
// Facets have five seams each, and five times a number is no power of two: a place stays free.
constexpr std::size_t kSeamsPerFacet = 5;

}  // namespace

void AppendPrimitiveWrenches(std::span<const GraspContact> contacts, double torque_scale, int edges,
                             std::vector<Wrench>& out) {
  for (const GraspContact& contact : contacts) {
    const TangentBasis basis = ContactTangents(contact.inward_normal);
    for (int j = 0; j < edges; ++j) {
      const double a = 2.0 * M_PI * j / edges;
      const Vector3d f =
          contact.inward_normal + contact.mu * (std::cos(a) * basis.t1 + std::sin(a) * basis.t2);
      Wrench& wrench = out.emplace_back();
      wrench << f, contact.position.cross(f) / torque_scale;
    }
    if (contact.torsion == 0) continue;
    const Vector3d& n = contact.inward_normal;
    for (const double sign : {1.0, -1.0})
      out.emplace_back() << n,
          (contact.position.cross(n) + sign * contact.torsion * n) / torque_scale;
  }
}

void WrenchHull::Reserve(std::size_t points, std::size_t facets) {
  inserted_.reserve(points);
  facets_.reserve(facets);
  key_.reserve(facets);
  free_.reserve(facets);
  visible_.reserve(facets);
  fresh_.reserve(facets);
  // A vertex of a simplicial hull of n points in six dimensions has at most (n - 4)(n - 5) facets.
  const std::size_t n = std::max<std::size_t>(points, 7);
  const std::size_t fresh = std::min({facets, kSeamFacets, (n - 4) * (n - 5)});
  seams_.resize(std::max(seams_.size(), std::bit_ceil(kSeamsPerFacet * fresh)));
  facet_limit_ = std::max(facet_limit_, facets);
}

bool WrenchHull::Start(std::span<const Wrench> points, double tolerance) {
  points_ = points;
  facets_.clear();
  key_.clear();
  free_.clear();
  facets_built_ = 0;
  visit_ = 0;
  inserted_.assign(points.size(), 0);
  if (points.size() < 7) return false;
  double size = 0.0;
  for (const Wrench& p : points) size = std::max(size, p.norm());
  tolerance_ = tolerance * size;

  // Greedy: always the point farthest from the span of those already chosen.
  std::array<int, 7> corner{};
  Eigen::Matrix<double, 6, 6> axes;
  Wrench mean = Wrench::Zero();
  for (const Wrench& p : points) mean += p / static_cast<double>(points.size());
  for (int c = 0; c < 7; ++c) {
    const Wrench& base = c == 0 ? mean : points[corner[0]];
    double best = -1.0;
    Wrench best_residual = Wrench::Zero();
    for (int i = 0; i < static_cast<int>(points.size()); ++i) {
      Wrench residual = points[i] - base;
      for (int k = 0; k < c - 1; ++k) residual -= axes.col(k).dot(residual) * axes.col(k);
      const double length = residual.squaredNorm();
      if (length <= best) continue;
      best = length;
      best_residual = residual;
      corner[c] = i;
    }
    if (std::sqrt(best) < kFlat * size) return false;
    if (c > 0) axes.col(c - 1) = best_residual.normalized();
    inserted_[corner[c]] = 1;
  }

  // Barycentric coordinates are the rows of the inverse of [corners; 1 ... 1]; the plane opposite a
  // corner is where its coordinate is zero.
  Eigen::Matrix<double, 7, 7> corners;
  for (int c = 0; c < 7; ++c) corners.col(c) << points[corner[c]], 1.0;
  const Eigen::Matrix<double, 7, 7> barycentric = corners.partialPivLu().inverse();
  inside_ = corners.topRows<6>().rowwise().mean();
  for (int c = 0; c < 7; ++c) {
    Facet& facet = facets_[NewFacet()];
    const Wrench gradient = barycentric.row(c).head<6>().transpose();
    facet.normal = -gradient / gradient.norm();
    facet.offset = barycentric(c, 6) / gradient.norm();
    int slot = 0;
    for (int other = 0; other < 7; ++other) {
      if (other == c) continue;
      facet.vertex[slot] = static_cast<std::uint16_t>(corner[other]);
      facet.neighbour[slot++] = other;
    }
    key_[c] = facet.offset;
  }
  return true;
}

int WrenchHull::NearestOpen() const {
  double least = kInfinity;
  int nearest = -1;
  for (std::size_t f = 0; f < key_.size(); ++f) {
    if (key_[f] < least) {
      least = key_[f];
      nearest = static_cast<int>(f);
    }
  }
  return nearest;
}

int WrenchHull::NewFacet() {
  ++facets_built_;
  int index;
  if (free_.empty()) {
    index = static_cast<int>(facets_.size());
    facets_.emplace_back();
    key_.push_back(kInfinity);
  } else {
    index = free_.back();
    free_.pop_back();
  }
  facets_[index].mark = 0;
  return index;
}

WrenchHull::Growth WrenchHull::Insert(int start) {
  const Wrench start_normal = facets_[start].normal;
  double farthest = facets_[start].offset + tolerance_;
  int point = -1;
  for (int i = 0; i < static_cast<int>(points_.size()); ++i) {
    if (inserted_[i]) continue;
    const double reach = start_normal.dot(points_[i]);
    if (reach > farthest) {
      farthest = reach;
      point = i;
    }
  }
  if (point < 0) {
    key_[start] = kInfinity;
    return Growth::kClosed;
  }
  inserted_[point] = 1;
  const Wrench p = points_[point];

  ++visit_;
  visible_.clear();
  fresh_.clear();
  facets_[start].mark = visit_;
  facets_[start].height = farthest - facets_[start].offset;
  visible_.push_back(start);
  for (std::size_t next = 0; next < visible_.size(); ++next) {
    const int f = visible_[next];
    for (int k = 0; k < 6; ++k) {
      const int g = facets_[f].neighbour[k];
      Facet& across = facets_[g];
      if (across.mark != visit_) {
        across.mark = visit_;
        across.height = across.normal.dot(p) - across.offset;
        if (across.height > tolerance_) visible_.push_back(g);
      }
      if (across.height > tolerance_) continue;

      if (free_.empty() && facets_.size() >= facet_limit_) return Growth::kFailed;
      const int made = NewFacet();
      Facet& facet = facets_[made];
      const Facet& seen = facets_[f];
      Facet& behind = facets_[g];
      const double weight = -std::min(behind.height, 0.0);
      facet.normal = seen.height * behind.normal + weight * seen.normal;
      facet.offset = seen.height * behind.offset + weight * seen.offset;
      const double length = facet.normal.norm();
      if (!(length > 0.0)) return Growth::kFailed;
      facet.normal /= length;
      facet.offset /= length;
      facet.vertex[0] = static_cast<std::uint16_t>(point);
      facet.neighbour[0] = g;
      int slot = 1;
      for (int v = 0; v < 6; ++v)
        if (v != k) facet.vertex[slot++] = seen.vertex[v];
      std::sort(facet.vertex.begin() + 1, facet.vertex.end());
      behind.neighbour[static_cast<std::size_t>(
          std::find(behind.neighbour.begin(), behind.neighbour.end(), f) -
          behind.neighbour.begin())] = made;
      key_[made] = facet.offset;
      fresh_.push_back(made);
    }
  }
  if (!Join(fresh_)) return Growth::kFailed;
  for (const std::int32_t f : visible_) {
    key_[f] = kInfinity;
    free_.push_back(f);
  }
  return Growth::kGrown;
}

bool WrenchHull::Complete() {
  for (bool again = true; again;) {
    again = false;
    for (std::size_t f = 0; f < key_.size(); ++f) {
      while (key_[f] < kInfinity) {
        if (Insert(static_cast<int>(f)) == Growth::kFailed) return false;
        again = true;
      }
    }
  }
  return true;
}

bool WrenchHull::Join(std::span<const std::int32_t> facets) {
  const std::size_t size = std::bit_ceil(kSeamsPerFacet * facets.size());
  if (size > seams_.size()) return false;
  const std::size_t mask = size - 1;
  if (++seam_visit_ == 0) {  // wrapped: forget the marks of four thousand million insertions ago
    std::fill(seams_.begin(), seams_.end(), Seam{});
    seam_visit_ = 1;
  }
  std::size_t open = 0;
  for (const std::int32_t f : facets) {
    for (int slot = 1; slot < 6; ++slot) {
      std::uint64_t key = 0;
      for (int v = 1; v < 6; ++v)
        if (v != slot) key = (key << 16) | facets_[f].vertex[v];
      std::size_t at = ((key * 0x9e3779b97f4a7c15ULL) >> 20) & mask;
      while (seams_[at].mark == seam_visit_ && seams_[at].key != key) at = (at + 1) & mask;
      Seam& seam = seams_[at];
      if (seam.mark != seam_visit_) {
        seam = {key, seam_visit_, 8 * f + slot};
        ++open;
        continue;
      }
      if (seam.place < 0) return false;
      facets_[f].neighbour[slot] = seam.place / 8;
      facets_[seam.place / 8].neighbour[seam.place % 8] = f;
      seam.place = -1;
      --open;
    }
  }
  return open == 0;
}

double WrenchHull::Volume() const {
  std::vector<char> dead(facets_.size(), 0);
  for (const std::int32_t f : free_) dead[f] = 1;
  double sum = 0.0;
  for (std::size_t f = 0; f < facets_.size(); ++f) {
    if (dead[f]) continue;
    Eigen::Matrix<double, 6, 6> edges;
    for (int v = 0; v < 6; ++v) edges.col(v) = points_[facets_[f].vertex[v]] - inside_;
    sum += std::abs(edges.determinant());
  }
  return sum / 720.0;
}

}  // namespace regrasp
