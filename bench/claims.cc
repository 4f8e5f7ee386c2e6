// Measures what the README claims, straight on the session (no daemon): every table names this
// command.
//   claims hold      [--seeds N] [--first S] [--seconds T]   six gravity directions
//   claims objects   [--seeds N] [--first S] [--seconds T]   spheres of 45, 50, 60 mm and the egg,
//                    or those of --object A,B,... (names or .urdf files) [--inertia-from-shape]
//   claims explore   [--seeds N] [--first S] [--criterion C] [--estimator E] [--finger NAME]
//   claims rotate    [--seeds N] [--first S] [--turns T | --angle DEG] [--axis X,Y,Z | all]
//                    [--speed DEG_S] [--explore] [--push N]  a push of so much for 0.1 s a second
//   claims move      [--seeds N] [--first S] [--angle DEG] [--offset MM] [--axis X,Y,Z | all]
//                    one motion about and along the axis, without a regrasp
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
#include "bench/settings.h"
#include "bench/trial.h"
#include "core/hand/scenario.h"
#include "core/session/completed.h"
#include "core/session/session.h"

using namespace regrasp;

namespace {

struct Options {
  std::string what, hand = "shadow", noise = "paper", object, criterion = "manipulability",
                    estimator = "least_squares", finger;
  int seeds = 5, jobs = 2;
  std::uint64_t first = 1;
  double seconds = 60, turns = 1, speed = 0, tilt = -1, push = 0, angle = 0, offset_mm = 0;
  std::string axis = "0,0,-1";
  bool exact = false, rows = false, exploring = false, inertia_from_shape = false;
  std::vector<ParameterSetting> set;
};

constexpr double kFailed = -1;

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

int Explore(const Options& o) {
  const SessionConfig probe = MakeConfig(o, 1, o.object);
  int total_rose = 0, total = 0;
  for (int finger = 0; finger < probe.model.hand.num_fingers(); ++finger) {
    const std::string& name = probe.model.hand.fingers[finger].name;
    if (!o.finger.empty() && o.finger != name) continue;
    const auto rows = Parallel(o.seeds, o.jobs, [&](int k) -> Row {
      Session session(MakeConfig(o, o.first + k, o.object));
      if (!GraspObject(session)) return {kFailed};
      Command c;
      c.type = CommandType::kExplore;
      c.finger = finger;
      c.seed = o.first + k;
      for (const CriterionInfo& criterion : kCriterionTable)
        if (criterion.name == o.criterion) c.criterion = criterion.id;
      c.estimator = o.estimator == "secant" ? Estimator::kSecant : Estimator::kLeastSquares;
      const Vector3d p0 = session.truth().p_WO;
      const JobRecord job = RunJob(session, c, {.limit_s = 60});
      for (int t = 0; t < 1000; ++t) session.Tick();
      return {static_cast<double>(job.state == JobState::kDone),
              static_cast<double>(job.explore.reason),
              job.explore.phi_true_initial,
              job.explore.phi_true_final,
              job.explore.path_length_m * 1e3,
              static_cast<double>(job.explore.cycles),
              static_cast<double>(session.state() == SessionState::kDropped),
              (session.truth().p_WO - p0).norm() * 1e3};
    });
    int rose = 0, failed = 0, dropped = 0, converged = 0, refused = 0;
    std::vector<double> gain, cycles, moved;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const Row& r = rows[k];
      if (r.empty() || r[0] == kFailed) {
        ++failed;
        continue;
      }
      if (o.rows) {
        std::printf(
            "  seed %llu done %.0f reason %s phi %.4f -> %.4f path %.1f mm cycles %.0f dropped "
            "%.0f moved %.2f mm\n",
            static_cast<unsigned long long>(o.first + k), r[0],
            Name(static_cast<ExploreReason>(static_cast<int>(r[1]))).data(), r[2], r[3], r[4], r[5],
            r[6], r[7]);
      }
      if (r[0] == 0 && static_cast<ExploreReason>(static_cast<int>(r[1])) == ExploreReason::kNone) {
        ++refused;  // the load margin without this finger is too small: the object stays held
        continue;
      }
      rose += r[3] > r[2] && r[6] == 0;
      dropped += r[6] != 0;
      converged += static_cast<ExploreReason>(static_cast<int>(r[1])) == ExploreReason::kGradient;
      gain.push_back(r[3] / r[2] - 1);
      cycles.push_back(r[5]);
      moved.push_back(r[7]);
    }
    std::printf(
        "%-8s phi rose %2d/%-2zu  refused %d  dropped %d  not grasped %d  converged %d  gain mean "
        "%+.1f %%  "
        "cycles mean %.0f  object moved max %.2f mm\n",
        name.c_str(), rose, rows.size(), refused, dropped, failed, converged, 100 * Mean(gain),
        Mean(cycles), Max(moved));
    std::fflush(stdout);
    total_rose += rose;
    total += static_cast<int>(rows.size());
  }
  std::printf("all      phi rose %d/%d\n", total_rose, total);
  return 0;
}

/// One regrasp that was not broken off, by noise-free values of its objective.
struct PhiChange {
  int finger;
  double before, start, after;
};

/// {done, angle deg, deg/min, max position error mm, max tilt deg, regrasps, slips, refused,
/// dropped, angle error deg, regrasps on manipulability, of them higher after than before,
/// explorations begun below 98 % of best, of them rose, mean change start-to-after, mean after,
/// explorations for stability (S_F), of them rose, mean at their start, mean after}
Row RotateTrial(Session& session, const Options& o, const Vector3d& axis, std::uint64_t seed) {
  if (!GraspObject(session)) return {kFailed};
  Command c;
  c.type = CommandType::kRotate;
  c.angle_rad = 2 * M_PI * o.turns;
  c.axis_W = axis;
  c.speed_rad_s = o.speed * M_PI / 180;
  double slips = 0, refused = 0, touching = 0;
  std::vector<PhiChange> changes, shifts;  // for manipulability; for stability
  JobOptions options;
  options.limit_s = std::abs(o.turns) * 1000 + 30;
  options.push_n = o.push;
  options.on_tick = [&] { touching += session.truth().link_link_contacts > 0; };
  options.on_event = [&](const Event& e) {
    slips += e.kind == EventKind::kSlip;
    refused += e.kind == EventKind::kRefused;
    if (e.kind != EventKind::kRegrasp) return;
    const RegraspRecord& r = session.last_regrasp();
    if (r.aborted || r.phi_start <= 0) return;
    const PhiChange change{r.finger, r.phi_before, r.phi_start, r.phi_after};
    if (r.criterion == Criterion::kStability)
      shifts.push_back(change);
    else if (!r.on_stability)
      changes.push_back(change);
  };
  const JobRecord job = RunJob(session, c, options);
  std::map<int, double> best;
  for (const PhiChange& p : changes) best[p.finger] = std::max(best[p.finger], p.after);
  double rose = 0, low = 0, low_rose = 0, gain = 0, phi = 0;
  for (const PhiChange& p : changes) {
    if (o.rows && o.exploring)
      std::fprintf(stderr, "    finger %d manipulability %.4f -> %.4f -> %.4f\n", p.finger,
                   p.before, p.start, p.after);
    rose += p.after > p.before;
    gain += p.after / p.start - 1;
    phi += p.after;
    if (p.start >= 0.98 * best[p.finger]) continue;
    low += 1;
    low_rose += p.after > p.start;
  }
  double raised = 0, stability_start = 0, stability_after = 0;
  for (const PhiChange& p : shifts) {
    raised += p.after > p.start;
    stability_start += p.start / static_cast<double>(shifts.size());
    stability_after += p.after / static_cast<double>(shifts.size());
  }
  const RotateResult& r = job.rotate;
  const double wanted = o.turns * 360, angle = r.angle_rad * 180 / M_PI;
  if (o.rows || job.state != JobState::kDone)
    std::fprintf(stderr,
                 "  seed %llu %s %.1f deg in %.1f s  offset %.2f mm  tilt %.1f deg  regrasps %d  "
                 "motions %d  slips %.0f  "
                 "refused %.0f  link-link %.1f %%  %s\n",
                 static_cast<unsigned long long>(seed), Name(job.state).data(), angle, r.sim_time_s,
                 r.max_position_error_m * 1e3, r.max_tilt_rad * 180 / M_PI, r.regrasps,
                 r.gait_cycles + 1, slips, refused,
                 r.sim_time_s > 0 ? touching / r.sim_time_s / 10 : 0.0, job.error);
  const bool completed =
      job.state == JobState::kDone && TurnedAsAsked(r.angle_rad, 2 * M_PI * o.turns);
  return {completed ? 1.0 : 0.0,
          angle,
          r.sim_time_s > 0 ? std::abs(angle) / r.sim_time_s * 60 : 0,
          r.max_position_error_m * 1e3,
          r.max_tilt_rad * 180 / M_PI,
          static_cast<double>(r.regrasps),
          slips,
          refused,
          r.dropped ? 1.0 : 0.0,
          std::abs(angle - wanted),
          static_cast<double>(changes.size()),
          rose,
          low,
          low_rose,
          changes.empty() ? 0 : gain / static_cast<double>(changes.size()),
          changes.empty() ? 0 : phi / static_cast<double>(changes.size()),
          static_cast<double>(shifts.size()),
          raised,
          stability_start,
          stability_after};
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

int Rotate(const Options& o) {
  for (const auto& [label, axis] : Axes(o)) {
    const auto rows = Parallel(o.seeds, o.jobs, [&, a = axis](int k) {
      Session session(MakeConfig(o, o.first + k, o.object));
      return RotateTrial(session, o, a, o.first + k);
    });
    int done = 0, failed = 0, dropped = 0;
    std::vector<double> rate, offset, tilt, error, slips, refused, gain, phi;
    double explored = 0, rose = 0, low = 0, low_rose = 0, shifted = 0, raised = 0;
    std::vector<double> stability_start, stability_after;
    for (const Row& r : rows) {
      if (r.empty() || r[0] == kFailed) {
        ++failed;
        continue;
      }
      done += r[0] == 1.0;
      dropped += r[8] != 0;
      if (r[0] == 1.0) {
        rate.push_back(r[2]);
        error.push_back(r[9]);
      }
      offset.push_back(r[3]);
      tilt.push_back(r[4]);
      slips.push_back(r[6]);
      refused.push_back(r[7]);
      gain.push_back(r[14]);
      phi.push_back(r[15]);
      explored += r[10];
      rose += r[11];
      low += r[12];
      low_rose += r[13];
      shifted += r[16];
      raised += r[17];
      if (r[16] == 0) continue;
      stability_start.push_back(r[18]);
      stability_after.push_back(r[19]);
    }
    std::printf(
        "%-8s %.3g turns  done %2d/%-2zu  dropped %d  not grasped %d  mean %5.1f deg/min  offset "
        "max %.2f mm "
        " tilt max %.1f deg  angle error max %.1f deg  slips %.1f  refused %.1f\n",
        label.c_str(), o.turns, done, rows.size(), dropped, failed, Mean(rate), Max(offset),
        Max(tilt), Max(error), Mean(slips), Mean(refused));
    if (explored > 0)
      std::printf(
          "         manipulability after a regrasp %.4f on average; above that before it in %.0f "
          "of %.0f\n",
          Mean(phi), rose, explored);
    if (o.exploring)
      std::printf(
          "         explorations raised it by %.1f %% on average; in %.0f of the %.0f that began "
          "below 98 %% of "
          "the best reached\n",
          100 * Mean(gain), low_rose, low);
    if (o.exploring && shifted > 0)
      std::printf(
          "         before the opposing finger leaves, explorations took the stability without it "
          "from %.3f to %.3f on average; it rose in %.0f of %.0f\n",
          Mean(stability_start), Mean(stability_after), raised, shifted);
    std::fflush(stdout);
  }
  return 0;
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

/// {end, finger, joint nearest to its limit, angle error deg, position error at the end mm, largest
/// on the way mm, still held a second later, share of the way, largest angle error on the way deg}.
/// Errors are against what was wanted and, on the way, against the reference.
Row MoveTrial(Session& session, const Options& o, const Vector3d& axis, std::uint64_t seed) {
  if (!GraspObject(session)) return {kFailed};
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
  const HandModel hand = MakeConfig(o, 1, o.object).model.hand;
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
        within += r[3] < 5 && std::max(r[4], r[5]) < 4;
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
    else if (a == "--criterion")
      o.criterion = next();
    else if (a == "--estimator")
      o.estimator = next();
    else if (a == "--finger")
      o.finger = next();
    else if (a == "--turns")
      o.turns = std::stod(next());
    else if (a == "--angle")
      o.turns = (o.angle = std::stod(next())) / 360;
    else if (a == "--offset")
      o.offset_mm = std::stod(next());
    else if (a == "--explore") {
      o.exploring = true;
      o.set.push_back(ReadSetting("gait.mode=exploring"));
    } else if (a == "--tilt")
      o.tilt = std::stod(next());
    else if (a == "--push")
      o.push = std::stod(next());
    else if (a == "--axis")
      o.axis = next();
    else if (a == "--speed")
      o.speed = std::stod(next());
    else if (a == "--jobs")
      o.jobs = std::stoi(next());
    else if (a == "--exact")
      o.exact = true;
    else if (a == "--rows")
      o.rows = true;
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
  if (o.what == "explore") return Explore(o);
  if (o.what == "rotate") return Rotate(o);
  if (o.what == "move") return Move(o);
  if (o.what == "repeat") return Repeat(o);
  std::fprintf(stderr,
               "usage: claims hold|objects|explore|rotate|move|repeat [options]; see the head of "
               "bench/claims.cc\n");
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
