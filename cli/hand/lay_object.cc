#include "cli/hand/lay_object.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/common/box_corners.h"
#include "core/hand/kinematics.h"
#include "core/hand/solid.h"
#include "core/world/start_overlap.h"

namespace regrasp::hand {
namespace {

constexpr double kShift = 5e-3;      // of the object, where it lies too near to a link [m]
constexpr double kSame = 1e-3;       // places of corners that differ by less are alike [m]
constexpr double kCorners = 1.2;     // a ball that reaches towards the corners
constexpr double kOtherBall = 5e-3;  // balls that differ by less are one [m]
constexpr double kEqual = 0.01;      // moments that differ by less, of the largest, are equal

/// Corners of what the object fills, in O [m].
std::vector<Vector3d> CornersOf(const ObjectModel& object) {
  if (object.kind == ObjectModel::Kind::kMesh) return object.vertices_O;
  Vector3d half = object.half_extents;
  if (object.kind != ObjectModel::Kind::kBox) half.setConstant(object.radius);
  const auto corners = BoxCorners(half);
  return {corners.begin(), corners.end()};
}

/// Whether two turns bring the same points to about the same places.
bool Alike(const std::vector<Vector3d>& points, const Matrix3d& a, const Matrix3d& b) {
  const Matrix3d R = a.transpose() * b;
  return std::ranges::all_of(points, [&](const Vector3d& p) {
    return std::ranges::any_of(
        points, [&](const Vector3d& q) { return (R * p - q).squaredNorm() < kSame * kSame; });
  });
}

/// The turns that bring the axes of a box onto those of the hand: 24, or fewer where some make no
/// difference to `points` (from the middle, along the box). Those that follow each other have its
/// `longest` axis along another one.
std::vector<Matrix3d> Turns(const std::vector<Vector3d>& points, int longest) {
  std::vector<Matrix3d> turns;
  const int second = (longest + 1) % 3, third = (longest + 2) % 3;
  for (int about = 0; about < 4; ++about)
    for (const double sign : {1, -1})
      for (int along = 0; along < 3; ++along) {
        Matrix3d R = Matrix3d::Zero();
        R(along, longest) = sign;
        R((along + 1 + about % 2) % 3, second) = about < 2 ? 1 : -1;
        R.col(third) = R.col(longest).cross(R.col(second));
        if (std::ranges::none_of(turns, [&](const Matrix3d& t) { return Alike(points, t, R); }))
          turns.push_back(R);
      }
  return turns;
}

/// Principal axes, as columns; the file's where its moments are equal or it lies along them.
Matrix3d AxesOf(const Matrix3d& inertia) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(inertia);
  const Vector3d& moment = solver.eigenvalues();  // the least first
  const double equal = kEqual * moment[2];
  const Matrix3d mixed = inertia - Matrix3d(inertia.diagonal().asDiagonal());
  if (mixed.cwiseAbs().maxCoeff() <= equal) return Matrix3d::Identity();
  Matrix3d axes = solver.eigenvectors();
  const bool pair = moment[1] - moment[0] <= equal || moment[2] - moment[1] <= equal;
  if (pair) {  // the plane of two is known, not the two: the file's axis that is nearest to it
    const Vector3d alone = axes.col(moment[1] - moment[0] <= equal ? 2 : 0);
    int nearest = 0;
    alone.cwiseAbs().minCoeff(&nearest);
    const Vector3d along = Vector3d::Unit(nearest);
    axes.col(0) = (along - alone.dot(along) * alone).normalized();
    axes.col(1) = alone;
  }
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

/// The hand's links, where the object has been moved by so much.
struct Posed {
  std::vector<Isometry3d> X_WL;
  Vector3d moved;
};

Posed PosedAt(const HandModel& hand, const JointVector& q, const Vector3d& moved) {
  KinematicsData data;
  ForwardKinematics(hand, q, &data);
  const auto end = data.X_WL.begin() + static_cast<std::ptrdiff_t>(hand.links.size());
  return {{data.X_WL.begin(), end}, moved};
}

/// Counts the starts in which the object begins inside a link; false where it does in the first,
/// which is the preshape itself.
bool Judge(const LoadedScenario& model, const std::vector<Posed>& hands, Way* way) {
  for (std::size_t k = 0; k < hands.size(); ++k) {
    Isometry3d X_WO = way->X_WO;
    X_WO.translation() += hands[k].moved;
    const double depth = DeepestOverlap(model.hand, hands[k].X_WL, model.object, X_WO).depth;
    if (k == 0 && depth > kStartOverlap) return false;
    way->inside += depth > kStartOverlap;
    way->depth = std::max(way->depth, depth);
  }
  return true;
}

}  // namespace

ObjectBox BoxOf(const ObjectModel& object) {
  ObjectBox box;
  if (object.kind == ObjectModel::Kind::kMesh) box.R_OB = AxesOf(ObjectSolid(object).inertia);
  Vector3d least = Vector3d::Constant(1e9), most = -least;
  for (const Vector3d& corner : CornersOf(object)) {
    least = least.cwiseMin(box.R_OB.transpose() * corner);
    most = most.cwiseMax(box.R_OB.transpose() * corner);
  }
  box.size = most - least;
  box.p_OB = box.R_OB * (0.5 * (least + most));
  box.reach = object.kind == ObjectModel::Kind::kSphere ? object.radius : 0;
  if (object.kind != ObjectModel::Kind::kSphere)
    for (const Vector3d& corner : CornersOf(object))
      box.reach = std::max(box.reach, (corner - box.p_OB).norm());
  std::vector<Vector3d> points;
  for (const Vector3d& corner : CornersOf(object))
    points.push_back(box.R_OB.transpose() * (corner - box.p_OB));
  int longest = 0;
  box.size.maxCoeff(&longest);
  box.turns = Turns(points, longest);
  return box;
}

std::vector<double> BallsFor(const ObjectBox& box, double least) {
  Vector3d size = box.size;
  std::sort(size.begin(), size.end());
  std::vector<double> balls;
  const double mean = 0.5 * (size[0] + size[1]);
  for (const double d : {mean, kCorners * mean, size[1], size[0]}) {
    const double ball = std::max(d, least);
    if (std::ranges::none_of(balls, [&](double b) { return std::abs(b - ball) < kOtherBall; }))
      balls.push_back(ball);
  }
  return balls;
}

std::vector<Way> WaysToLie(const LoadedScenario& model, const ObjectBox& box, const Vector3d& p_WB,
                           const std::vector<Start>& starts) {
  std::vector<Posed> hands = {PosedAt(model.hand, model.scenario.q_preshape, Vector3d::Zero())};
  for (const Start& start : starts) hands.push_back(PosedAt(model.hand, start.q, start.moved));
  std::vector<Way> ways;
  for (const Matrix3d& R_WB : box.turns) {
    std::optional<Way> best;
    for (int shift = 0; shift < 7; ++shift) {  // not at all, then along each axis
      if (best && best->inside == 0) break;
      Vector3d p = p_WB;
      if (shift > 0) p[(shift - 1) % 3] += shift > 3 ? -kShift : kShift;
      Way way;
      way.X_WO.linear() = R_WB * box.R_OB.transpose();
      way.X_WO.translation() = p - way.X_WO.linear() * box.p_OB;
      if (!Judge(model, hands, &way)) continue;
      if (!best || way.inside < best->inside) best = way;
    }
    if (best) ways.push_back(*best);
  }
  std::ranges::stable_sort(ways, {},
                           [](const Way& way) { return std::pair(way.inside, way.depth); });
  return ways;
}

}  // namespace regrasp::hand
