// Holding, one motion without a regrasp, and whether the same run gives the same bits: straight on
// the session. Turns and explorations are measured by `regrasp experiment`.
//   claims hold      [--seeds N] [--first S] [--seconds T]   six gravity directions
//   claims objects   [--seeds N] [--first S] [--seconds T]   spheres of 45, 50, 60 mm and the egg,
//                    or those of --object A,B,... (names or .urdf files) [--inertia-from-shape]
//   claims move      [--seeds N] [--first S] [--angle DEG] [--offset MM] [--axis X,Y,Z | all]
//                    one motion about and along the axis, without a regrasp; --reach: for each
//                    start, the angle that geometry allows a ball on which all fingertips roll
//                    (bench/rolling_reach.h), beside what was reached
//   claims repeat    [--seconds T]                            state hash of the same run, twice
// Common: --hand NAME|FILE --noise PRESET --object NAME --tilt DEG (of the palm) --set NAME=VALUE
// (repeatable)
// --exact --rows (a line per trial). Trials run in two processes (--jobs N); each is reproducible
// alone from its seed.

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/children.h"
#include "bench/rolling_reach.h"
#include "bench/settings.h"
#include "bench/trial.h"
#include "core/hand/scenario.h"
#include "core/session/session.h"

using namespace regrasp;

namespace {

struct Options {
  std::string what, hand = "shadow", noise = "paper", object;
  int seeds = 5, jobs = 2;
  std::uint64_t first = 1;
  double seconds = 60, tilt = -1, angle = 0, offset_mm = 0;
  std::string axis = "0,0,-1";
  bool exact = false, rows = false, reach = false, inertia_from_shape = false;
  std::vector<ParameterSetting> set;
};

constexpr double kFailed = -1, kDegree = M_PI / 180;
constexpr double kPositionBound_mm = 4, kAngleBound_deg = 5;  // within which a motion counts

SessionConfig MakeConfig(const Options& o, std::uint64_t seed, const std::string& object) {
  SessionConfig config;
  LoadOptions load;
  load.inertia_from_shape = o.inertia_from_shape;
  config.model = LoadScenario(o.hand, object, ModelSearchPath(), load);
  config.parameters = DefaultParameters(config.model);
  config.noise = NoisePreset(o.noise).value();
  config.seed = seed;
  if (o.exact) config.world.stepper = Stepper::kExact;
  if (o.tilt >= 0) {
    const double t = o.tilt * M_PI / 180;
    config.parameters.gravity_W = 9.81 * Vector3d(0, std::cos(t), std::sin(t));
  }
  Apply(o.set, &config.parameters);
  return config;
}

using Row = std::vector<double>;

/// Runs `trial(k)` for k in [0, n) in `jobs` processes; rows come back in order.
std::vector<Row> Parallel(int n, int jobs, const std::function<Row(int)>& trial) {
  std::vector<Row> rows(n);
  std::vector<int> pipes;
  for (int w = 0; w < jobs; ++w) {
    int fd[2];
    if (pipe(fd) != 0) std::exit(74);
    if (fork() == 0) {
      close(fd[0]);
      FILE* out = fdopen(fd[1], "w");
      for (int k = w; k < n; k += jobs) {
        const Row row = trial(k);
        std::fprintf(out, "%d", k);
        for (double v : row) std::fprintf(out, " %.17g", v);
        std::fprintf(out, "\n");
        std::fflush(out);
      }
      std::fclose(out);
      _exit(0);
    }
    close(fd[1]);
    pipes.push_back(fd[0]);
  }
  for (int fd : pipes) {
    FILE* in = fdopen(fd, "r");
    char line[4096];
    while (std::fgets(line, sizeof(line), in)) {
      char* p = line;
      const int k = static_cast<int>(std::strtol(p, &p, 10));
      for (char* end = p;; p = end) {
        const double v = std::strtod(p, &end);
        if (end == p) break;
        rows[k].push_back(v);
      }
    }
    std::fclose(in);
  }
  WaitForChildren();
  return rows;
}

double Mean(const std::vector<double>& v) {
  double sum = 0;
  for (double x : v) sum += x;
  return v.empty() ? 0 : sum / static_cast<double>(v.size());
}
double Max(const std::vector<double>& v) {
  return v.empty() ? 0 : *std::max_element(v.begin(), v.end());
}

/// {held, max deviation mm, rms mm, mean force residual / weight, foreign contacts, largest
/// link-link count}
Row HoldTrial(Session& session, double seconds) {
  if (!GraspObject(session)) return {kFailed, 0, 0, 0, 0, 0};
  const Vector3d p0 = session.truth().p_WO;
  double worst = 0, square = 0, foreign = 0, links = 0;
  Vector3d force = Vector3d::Zero();
  const int ticks = static_cast<int>(seconds * 1000);
  for (int k = 0; k < ticks; ++k) {
    session.Tick();
    session.TakeEvents();
    const double d = (session.truth().p_WO - p0).norm();
    worst = std::max(worst, d);
    square += d * d;
    for (const ObjectContact& c : session.truth().contacts) {
      force += c.force_W;
      foreign += c.finger < 0;
    }
    links = std::max(links, static_cast<double>(session.truth().link_link_contacts));
  }
  const double weight = session.world().mass_kg() * session.world().gravity_W().norm();
  const Vector3d mean_force = force / ticks;
  const double residual =
      (mean_force + session.world().mass_kg() * session.world().gravity_W()).norm() / weight;
  return {session.state() == SessionState::kHolding ? 1.0 : 0.0,
          worst * 1e3,
          std::sqrt(square / ticks) * 1e3,
          residual,
          foreign,
          links};
}

void PrintHold(const char* label, const std::vector<Row>& rows) {
  int held = 0, failed = 0;
  std::vector<double> worst, rms, residual, foreign, links;
  for (const Row& r : rows) {
    if (r.empty() || r[0] == kFailed) {
      ++failed;
      continue;
    }
    held += r[0] == 1.0;
    worst.push_back(r[1]);
    rms.push_back(r[2]);
    residual.push_back(r[3]);
    foreign.push_back(r[4]);
    links.push_back(r[5]);
  }
  std::printf(
      "%-16s held %2d/%-2zu  not grasped %d  max deviation %5.2f mm  rms %5.2f mm  "
      "force balance %5.2f %%  foreign contacts %.0f  link-link %.0f\n",
      label, held, rows.size(), failed, Max(worst), Mean(rms), 100 * Max(residual), Max(foreign),
      Max(links));
  std::fflush(stdout);
}

int Hold(const Options& o) {
  const std::pair<const char*, Vector3d> directions[] = {
      {"gravity +x", {9.81, 0, 0}},  {"gravity -x", {-9.81, 0, 0}}, {"gravity +y", {0, 9.81, 0}},
      {"gravity -y", {0, -9.81, 0}}, {"gravity +z", {0, 0, 9.81}},  {"gravity -z", {0, 0, -9.81}}};
  for (const auto& [label, gravity] : directions) {
    const auto rows = Parallel(o.seeds, o.jobs, [&, g = gravity](int k) {
      SessionConfig config = MakeConfig(o, o.first + k, o.object);
      config.parameters.gravity_W = g;
      Session session(std::move(config));
      return HoldTrial(session, o.seconds);
    });
    PrintHold(label, rows);
  }
  return 0;
}

int Objects(const Options& o) {
  std::istringstream list(o.object.empty() ? "sphere_45mm,sphere,sphere_60mm,egg" : o.object);
  for (std::string object; std::getline(list, object, ',');) {
    const auto rows = Parallel(o.seeds, o.jobs, [&](int k) {
      Session session(MakeConfig(o, o.first + k, object));
      return HoldTrial(session, o.seconds);
    });
    PrintHold(object.c_str(), rows);
  }
  return 0;
}

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

int Repeat(const Options& o) {
  std::uint64_t hash[2];
  for (std::uint64_t& h : hash) {
    Session session(MakeConfig(o, o.first, o.object));
    GraspObject(session);
    const int ticks = static_cast<int>(o.seconds * 1000);
    while (session.tick() < ticks) {
      session.Tick();
      session.TakeEvents();
    }
    h = session.StateHash();
    std::printf("state hash after %.0f s: %016llx (%s)\n", o.seconds,
                static_cast<unsigned long long>(h), Name(session.state()).data());
  }
  return hash[0] == hash[1] ? 0 : 1;
}

}  // namespace

int Main(int argc, char** argv) {
  Options o;
  if (argc > 1) o.what = argv[1];
  for (int i = 2; i < argc; ++i) {
    const std::string a = argv[i];
    auto next = [&]() -> std::string {
      if (++i >= argc) {
        std::fprintf(stderr, "claims: %s needs a value\n", a.c_str());
        std::exit(2);
      }
      return argv[i];
    };
    if (a == "--seeds")
      o.seeds = std::stoi(next());
    else if (a == "--first")
      o.first = std::stoull(next());
    else if (a == "--seconds")
      o.seconds = std::stod(next());
    else if (a == "--hand")
      o.hand = next();
    else if (a == "--noise")
      o.noise = next();
    else if (a == "--object")
      o.object = next();
    else if (a == "--angle")
      o.angle = std::stod(next());
    else if (a == "--offset")
      o.offset_mm = std::stod(next());
    else if (a == "--tilt")
      o.tilt = std::stod(next());
    else if (a == "--axis")
      o.axis = next();
    else if (a == "--jobs")
      o.jobs = std::stoi(next());
    else if (a == "--exact")
      o.exact = true;
    else if (a == "--rows")
      o.rows = true;
    else if (a == "--reach")
      o.reach = true;
    else if (a == "--inertia-from-shape")
      o.inertia_from_shape = true;
    else if (a == "--set")
      o.set.push_back(ReadSetting(next()));
    else {
      std::fprintf(stderr, "claims: unknown option %s\n", a.c_str());
      return 2;
    }
  }
  if (o.what != "objects")
    MakeConfig(o, o.first, o.object);  // throws here, before any trial, what is wrong with them
  if (o.what == "hold") return Hold(o);
  if (o.what == "objects") return Objects(o);
  if (o.what == "move") return Move(o);
  if (o.what == "repeat") return Repeat(o);
  std::fprintf(
      stderr,
      "usage: claims hold|objects|move|repeat [options]; see the head of bench/claims.cc\n");
  return 2;
}

int main(int argc, char** argv) {
  try {
    return Main(argc, argv);
  } catch (const std::invalid_argument&) {
    std::fprintf(stderr, "claims: the value of an option is not a number\n");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "claims: %s\n", error.what());
  }
  return 2;
}
