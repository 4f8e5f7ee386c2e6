// `claims move`: one motion of the object without a regrasp.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>

#include "bench/claims/claims.h"
#include "bench/claims/parallel.h"
#include "bench/rolling_reach.h"
#include "bench/trial.h"

namespace regrasp::claims {
namespace {

constexpr double kDegree = M_PI / 180;
constexpr double kPositionBound_mm = 4, kAngleBound_deg = 5;  // within which a motion counts

/// The axes of --axis by name; ends the program where it is wrong.
std::vector<std::pair<std::string, Vector3d>> Axes(const Options& o) {
  if (o.axis == "all")
    return {{"+x", {1, 0, 0}},  {"-x", {-1, 0, 0}}, {"+y", {0, 1, 0}},
            {"-y", {0, -1, 0}}, {"+z", {0, 0, 1}},  {"-z", {0, 0, -1}}};
  Vector3d a;
  if (std::sscanf(o.axis.c_str(), "%lf,%lf,%lf", &a[0], &a[1], &a[2]) != 3 || a.norm() == 0) {
    std::fprintf(stderr, "claims: --axis wants X,Y,Z or all\n");
    std::exit(2);
  }
  return {{o.axis, a.normalized()}};
}

/// The joint of `finger` that is nearest to a limit, by its index in the hand; -1 for no finger.
int NearestToLimit(const Session& session, int finger) {
  const HandModel& hand = session.config().model.hand;
  int nearest = -1;
  double least = 1e9;
  if (finger < 0) return -1;
  for (int j : hand.fingers[finger].joints) {
    const double q = session.truth().q[j];
    const double left = std::min(q - hand.joints[j].lower, hand.joints[j].upper - q);
    if (left < least) nearest = j;
    least = std::min(least, left);
  }
  return nearest;
}

/// --reach: how far geometry lets the ball turn from where the session holds it.
struct Reach {
  RollingReach strict;   ///< straight about the axis through its resting centre
  RollingReach allowed;  ///< as far off that as a motion that counts may be
};

Reach ReachOf(const Session& session, const Options& o, const Vector3d& axis) {
  std::vector<int> fingers;
  for (const ObjectContact& c : session.truth().contacts)
    if (c.finger >= 0 && std::ranges::find(fingers, c.finger) == fingers.end())
      fingers.push_back(c.finger);
  const auto farthest = [&](const Allowance& allowance) {
    return FarthestTurn(session.config().model.hand, fingers, session.truth().q,
                        {session.truth().p_WO, session.config().model.object.radius}, axis,
                        o.angle * kDegree, allowance);
  };
  return {farthest({}), farthest({kPositionBound_mm * 1e-3, kAngleBound_deg * kDegree})};
}

void PrintReach(const Session& session, const Options& o, const Reach& reach, std::uint64_t seed,
                double reached_deg) {
  const auto joint = [&](const RollingReach& r) {
    return r.joint < 0 ? "none" : session.config().model.hand.joints[r.joint].name.c_str();
  };
  const auto least = std::ranges::min_element(reach.allowed.alone, {}, &RollingEnd::angle);
  std::fprintf(stderr,
               "  seed %llu  rolling allows %.1f deg (%s), off by %.0f mm and %.0f deg %.1f deg "
               "(%s), every finger by itself at least %.1f deg  reached %.1f of %.3g deg\n",
               static_cast<unsigned long long>(seed), reach.strict.angle / kDegree,
               joint(reach.strict), kPositionBound_mm, kAngleBound_deg,
               reach.allowed.angle / kDegree, joint(reach.allowed), least->angle / kDegree,
               reached_deg, o.angle);
}

/// {end, finger, joint nearest to its limit, angle error deg, position error at the end mm, largest
/// on the way mm, still held a second later, share of the way, largest angle error on the way deg}.
/// Errors are against what was wanted and, on the way, against the reference.
Row MoveTrial(Session& session, const Options& o, const Vector3d& axis, std::uint64_t seed) {
  if (!GraspObject(session)) return {kFailed};
  const Reach reach = o.reach ? ReachOf(session, o, axis) : Reach();
  Command c;
  c.type = CommandType::kMove;
  c.offset_W = o.offset_mm * 1e-3 * axis;
  c.rotation_W = o.angle * M_PI / 180 * axis;
  const JobRecord job = RunJob(session, c, {.limit_s = 120});
  const MoveResult& r = job.move;
  const int joint = NearestToLimit(session, r.end_finger);
  for (int t = 0; t < 1000; ++t) session.Tick();
  const double angle_error = RotationVector(FromRotationVector(r.achieved_rotation_rad) *
                                            FromRotationVector(c.rotation_W).conjugate())
                                 .norm() *
                             180 / M_PI;
  const double along = o.angle != 0 ? r.achieved_rotation_rad.dot(axis) * 180 / M_PI / o.angle
                                    : r.achieved_offset_m.dot(axis) * 1e3 / o.offset_mm;
  const double position_error = (r.achieved_offset_m - c.offset_W).norm() * 1e3;
  const bool held = session.state() == SessionState::kHolding;
  if (o.rows)
    std::fprintf(stderr,
                 "  seed %llu %s %s %s  %.0f %% of the way  angle error %.2f deg  position error "
                 "%.2f mm (on the way %.2f mm, %.1f deg)  %s  %s\n",
                 static_cast<unsigned long long>(seed), Name(job.state).data(), Name(r.end).data(),
                 joint < 0 ? "" : session.config().model.hand.joints[joint].name.c_str(),
                 100 * along, angle_error, position_error, r.max_position_error_m * 1e3,
                 r.max_rotation_error_rad * 180 / M_PI, held ? "held" : "NOT HELD", job.error);
  if (o.reach) PrintReach(session, o, reach, seed, along * o.angle);
  return {static_cast<double>(r.end),
          static_cast<double>(r.end_finger),
          static_cast<double>(joint),
          angle_error,
          position_error,
          r.max_position_error_m * 1e3,
          held ? 1.0 : 0.0,
          along,
          r.max_rotation_error_rad * 180 / M_PI};
}

}  // namespace

int Move(const Options& o) {
  if (o.angle == 0 && o.offset_mm == 0) {
    std::fprintf(stderr, "claims: move wants --angle or --offset\n");
    return 2;
  }
  const LoadedScenario model = MakeConfig(o, 1, o.object).model;
  if (o.reach &&
      (model.object.kind != ObjectModel::Kind::kSphere || o.angle <= 0 || o.offset_mm != 0)) {
    std::fprintf(stderr, "claims: --reach wants a ball, --angle above 0 and no --offset\n");
    return 2;
  }
  const HandModel& hand = model.hand;
  for (const auto& [label, axis] : Axes(o)) {
    const auto rows = Parallel(o.seeds, o.jobs, [&, a = axis](int k) {
      Session session(MakeConfig(o, o.first + k, o.object));
      return MoveTrial(session, o, a, o.first + k);
    });
    int reached = 0, failed = 0, lost = 0, within = 0;
    std::vector<double> angle, position, on_way, way;
    std::map<std::string, int> ends;
    for (const Row& r : rows) {
      if (r.empty() || r[0] == kFailed) {
        ++failed;
        continue;
      }
      lost += r[6] == 0;
      on_way.push_back(r[5]);
      way.push_back(100 * r[7]);
      const auto end = static_cast<MoveEnd>(static_cast<int>(r[0]));
      if (end == MoveEnd::kReached) {
        ++reached;
        within += r[3] < kAngleBound_deg && std::max(r[4], r[5]) < kPositionBound_mm;
        angle.push_back(r[3]);
        position.push_back(r[4]);
        continue;
      }
      std::string what(Name(end));
      if (r[1] >= 0) what += " of " + hand.fingers[static_cast<std::size_t>(r[1])].name;
      if (end == MoveEnd::kJointLimit && r[2] >= 0)
        what += " (" + hand.joints[static_cast<std::size_t>(r[2])].name + ")";
      ++ends[what];
    }
    std::printf(
        "%-8s %.3g deg %.3g mm  reached %2d/%-2zu  of these within 5 deg and 4 mm %d  lost %d  not "
        "grasped %d  angle error max %.1f mean %.1f deg  position error max %.2f mean %.2f mm, of "
        "all on the way %.2f mm  way mean %.0f %%",
        label.c_str(), o.angle, o.offset_mm, reached, rows.size(), within, lost, failed, Max(angle),
        Mean(angle), Max(position), Mean(position), Max(on_way), Mean(way));
    for (const auto& [what, n] : ends) std::printf("\n         ended by %s: %d", what.c_str(), n);
    std::printf("\n");
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace regrasp::claims
