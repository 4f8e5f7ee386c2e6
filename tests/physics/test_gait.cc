// The finger gait in closed loop, on the session: what it promises, each on one seed. Success rates
// over seeds are measured by `regrasp experiment rotation`, not here.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/session/session.h"

namespace regrasp {
namespace {

constexpr double kDegree = M_PI / 180.0;

SessionConfig Config(std::uint64_t seed) {
  SessionConfig config;
  config.model = LoadScenario("shadow", "", ModelSearchPath());
  config.parameters = DefaultParameters(config.model);
  config.noise = NoisePreset("paper").value();
  config.seed = seed;
  return config;
}

/// Ticks until the running job ends, at most `seconds`.
JobRecord Finish(Session& session, double seconds) {
  const auto limit = session.tick() + static_cast<std::int64_t>(seconds * 1000);
  while (session.tick() < limit) {
    session.Tick();
    const auto jobs = session.TakeFinishedJobs();
    if (!jobs.empty()) return jobs.front();
  }
  return JobRecord();
}

void Grasp(Session& session) {
  Command command;
  command.type = CommandType::kGrasp;
  command.job = 1;
  session.Apply(command);
  ASSERT_EQ(Finish(session, 20).state, JobState::kDone);
}

Command Turn(double degrees, const Vector3d& axis) {
  Command command;
  command.type = CommandType::kRotate;
  command.job = 2;
  command.angle_rad = degrees * kDegree;
  command.axis_W = axis;
  return command;
}

// The seed on which a hop along a chord scraped the object, so that the little finger came back a
// little less far every time and the load margin fell to a half.
TEST(Rotate, EveryFingerComesBackEveryTime) {
  constexpr double kTilt = 60 * kDegree;
  SessionConfig config = Config(30502);
  config.parameters.gravity_W =
      config.parameters.gravity_W.norm() * Vector3d(0, std::cos(kTilt), std::sin(kTilt));
  config.parameters.gait.dare_cycles = 1000;  // so that both margins are of the same friction
  Session session(std::move(config));
  ASSERT_NO_FATAL_FAILURE(Grasp(session));
  const auto margin_after = [&](double degrees) {
    session.Apply(Turn(degrees, -Vector3d::UnitZ()));
    const JobRecord job = Finish(session, 60);
    EXPECT_EQ(job.state, JobState::kDone) << job.error;
    Frame frame;
    session.Snapshot(&frame, false);
    return frame.stability.load_margin;
  };
  const double first = margin_after(20);
  EXPECT_GT(margin_after(180), 0.8 * first);
}

TEST(Rotate, TurnsTheObjectOnceAndGoesOnHolding) {
  Session session(Config(1));
  ASSERT_NO_FATAL_FAILURE(Grasp(session));
  session.Apply(Turn(360, -Vector3d::UnitZ()));
  EXPECT_EQ(session.state(), SessionState::kRotating);
  const JobRecord job = Finish(session, 120);
  ASSERT_EQ(job.state, JobState::kDone) << job.error;
  // The bounds for one motion (5 degrees, 4 mm); the reference is followed by an
  // integrating controller, so that a whole turn has the same error.
  EXPECT_NEAR(job.rotate.angle_rad, 2 * M_PI, 5 * kDegree);
  EXPECT_LT(job.rotate.max_position_error_m, 0.004);
  EXPECT_FALSE(job.rotate.dropped);
  // A cycle begins before any finger has followed by more than a quarter of a turn.
  EXPECT_GE(job.rotate.gait_cycles, 4);
  for (int k = 0; k < 1000; ++k) session.Tick();
  EXPECT_EQ(session.state(), SessionState::kHolding);
}

// Turning while fingers regrasp takes less time and fewer cycles than resting meanwhile, where at
// least one finger has to regrasp after each step but the last.
TEST(Rotate, TurnsOnWhileFingersRegrasp) {
  const auto turn = [](bool rests) {
    SessionConfig config = Config(1);
    if (rests) config.parameters.gait.along_speed = 0;
    Session session(std::move(config));
    Grasp(session);
    session.Apply(Turn(180, -Vector3d::UnitZ()));
    const JobRecord job = Finish(session, 60);
    EXPECT_EQ(job.state, JobState::kDone) << job.error;
    EXPECT_NEAR(job.rotate.angle_rad, M_PI, 5 * kDegree);
    return job.rotate;
  };
  const RotateResult rests = turn(true), goes_on = turn(false);
  const int steps = static_cast<int>(std::ceil(M_PI / GaitParameters().step_rad));
  EXPECT_GE(rests.gait_cycles, steps - 1);
  EXPECT_GE(rests.regrasps, steps - 1);
  EXPECT_LT(goes_on.gait_cycles, rests.gait_cycles);
  EXPECT_LT(goes_on.sim_time_s, 0.8 * rests.sim_time_s);
}

// With planned landings Algorithm 1 begins where the finger lands, and the object turns meanwhile.
// By the paper's gait the finger first slides to where it ended before, and the object rests.
TEST(Rotate, ExploresFromWhereItLandsWhileTheObjectTurnsOn) {
  struct Seen {
    int explorations = 0, recalls = 0;
    double turned = 0;  // while a finger explored [rad]
  };
  const auto turn = [](bool paper) {
    SessionConfig config = Config(1);
    config.parameters.gait.mode = GaitMode::kExploring;
    config.parameters.gait.explore = GaitExplore::kAlways;
    config.parameters.gait.plan = !paper;
    Session session(std::move(config));
    Grasp(session);
    session.Apply(Turn(90, -Vector3d::UnitZ()));
    Seen seen;
    std::string phase;
    double before = 0;
    Frame frame;
    for (int tick = 0; tick < 40000 && session.TakeFinishedJobs().empty(); ++tick) {
      session.Tick();
      session.Snapshot(&frame, false);
      for (const Event& event : session.TakeEvents())
        if (event.kind == EventKind::kGaitPhase) {
          phase = event.text;  // "ring: explore"
          phase.erase(0, phase.find(": ") == std::string::npos ? 0 : phase.find(": ") + 2);
          seen.explorations += phase == "explore";
          seen.recalls += phase == "recall";
        }
      const double turned = std::abs(frame.gait.reference_angle_rad);
      if (phase == "explore") seen.turned += turned - before;
      before = turned;
    }
    return seen;
  };
  const Seen planned = turn(false), paper = turn(true);
  EXPECT_GT(planned.explorations, 3);
  EXPECT_EQ(planned.recalls, 0);
  EXPECT_GT(planned.turned, 5 * kDegree);
  EXPECT_GT(paper.explorations, 3);
  EXPECT_GT(paper.recalls, 0);
  EXPECT_EQ(paper.turned, 0);
}

// While the opposing finger is away, and only then, the others hold tighter; not where they may
// slip.
TEST(Rotate, HoldsTighterWhileTheOpposingFingerIsAway) {
  struct Grip {
    double with = 0, without = 0;  // mean normal force of the middle finger [N]
  };
  const auto turn = [](double grip, double from_friction = 0) {
    SessionConfig config = Config(1);
    config.parameters.gait.opposing_grip = grip;
    config.parameters.gait.opposing_friction = from_friction;
    const auto finger = [&](std::string_view name) {
      int i = 0;
      while (config.model.hand.fingers[i].name != name) ++i;
      return i;
    };
    const int thumb = finger("thumb"), middle = finger("middle");
    Session session(std::move(config));
    Grasp(session);
    session.Apply(Turn(180, -Vector3d::UnitZ()));
    std::array<double, 2> sum{}, ticks{};
    Frame frame;
    for (int tick = 0; tick < 40000 && session.TakeFinishedJobs().empty(); ++tick) {
      session.Tick();
      session.Snapshot(&frame, false);
      if (frame.gait.finger == middle) continue;
      const auto away = static_cast<std::size_t>(frame.gait.finger == thumb);
      sum[away] += frame.fingers[middle].force;
      ++ticks[away];
    }
    return Grip{sum[0] / ticks[0], sum[1] / ticks[1]};
  };
  const Grip same = turn(2), more = turn(4);
  EXPECT_GT(more.without, 1.2 * same.without);
  EXPECT_LT(more.with, 1.2 * same.with);
  EXPECT_LT(turn(4, 1).without, 1.2 * same.without);  // no more than 0.7 is counted on
}

// With so little friction no finger may leave: what was felt counts once nothing else has helped.
TEST(Rotate, CountsOnAllOfTheFrictionFeltAtAStandstill) {
  const auto most_counted = [](int dare_cycles) {
    SessionConfig config = Config(1);
    const double before_felt = config.parameters.control.friction_estimate;
    config.parameters.control.feel_most = 0.2;
    config.parameters.gait.dare_cycles = dare_cycles;
    Session session(std::move(config));
    Grasp(session);
    session.Apply(Turn(180, -Vector3d::UnitZ()));
    double most = 0;
    Frame frame;
    for (int tick = 0; tick < 20000 && session.TakeFinishedJobs().empty(); ++tick) {
      session.Tick();
      session.Snapshot(&frame, false);
      if (frame.friction_counted != before_felt) most = std::max(most, frame.friction_counted);
    }
    return most;
  };
  EXPECT_GT(most_counted(1), 0.6);
  EXPECT_EQ(most_counted(1000), 0.2);
}

// About this axis the fingertips move along the row of the fingers: the one at its limit must leave
// first (without that rule seed 301 loses the object about +y), and each stands where its neighbour
// would land (without waiting for that, seed 320 gives up about -y).
TEST(Rotate, TurnsTheObjectAlongTheRowOfTheFingers) {
  const auto turn = [](std::uint64_t seed, double sign) {
    Session session(Config(seed));
    Grasp(session);
    session.Apply(Turn(360, sign * Vector3d::UnitY()));
    const JobRecord job = Finish(session, 70);
    EXPECT_EQ(job.state, JobState::kDone) << job.error;
    EXPECT_NEAR(job.rotate.angle_rad, 2 * M_PI, 5 * kDegree);
  };
  turn(301, 1);
  turn(320, -1);
}

// Sensors as they are: taxels 6.6 mm apart, a pose at 15 Hz that is late and off by 5 mm. Believed
// as it comes, the object is dropped within a second of turning.
TEST(Rotate, TurnsOnTaxelsAndASlowPose) {
  SessionConfig config = Config(700);
  config.noise = NoisePreset("taxel").value();
  Session session(std::move(config));
  ASSERT_NO_FATAL_FAILURE(Grasp(session));
  session.Apply(Turn(120, -Vector3d::UnitZ()));
  const JobRecord job = Finish(session, 60);
  ASSERT_EQ(job.state, JobState::kDone) << job.error;
  EXPECT_NEAR(job.rotate.angle_rad, 120 * kDegree, 5 * kDegree);
  EXPECT_FALSE(job.rotate.dropped);
}

TEST(Rotate, NegativeAngleTurnsTheOtherWay) {
  Session session(Config(2));
  ASSERT_NO_FATAL_FAILURE(Grasp(session));
  session.Apply(Turn(-45, Vector3d::UnitX()));
  const JobRecord job = Finish(session, 60);
  ASSERT_EQ(job.state, JobState::kDone) << job.error;
  EXPECT_NEAR(job.rotate.angle_rad, -45 * kDegree, 5 * kDegree);
}

TEST(Rotate, RefusesToUnloadBelowTheMarginAndNamesIt) {
  SessionConfig config = Config(3);
  config.parameters.gait.margin_min = 2.0;  // more than any four fingers have without the thumb
  config.parameters.gait.margin_wanted = 0;
  config.parameters.gait.plan =
      false;  // a planned gait asks for less after cycles without progress
  Session session(std::move(config));
  ASSERT_NO_FATAL_FAILURE(Grasp(session));
  session.Apply(Turn(360, -Vector3d::UnitZ()));
  bool refused = false;
  JobRecord job;
  for (int k = 0; k < 120000 && job.id == 0; ++k) {
    session.Tick();
    for (const Event& event : session.TakeEvents())
      refused |= event.kind == EventKind::kRefused &&
                 std::string(event.text).find("thumb may not leave") != std::string::npos;
    const auto jobs = session.TakeFinishedJobs();
    if (!jobs.empty()) job = jobs.front();
  }
  EXPECT_TRUE(refused);
  EXPECT_EQ(job.state, JobState::kFailed);
  EXPECT_NE(std::string(job.error).find("load margin"), std::string::npos) << job.error;
  EXPECT_FALSE(job.rotate.dropped);
  EXPECT_EQ(session.state(), SessionState::kHolding);
}

TEST(Rotate, StopDuringAHopEndsInASafeHold) {
  Session session(Config(4));
  ASSERT_NO_FATAL_FAILURE(Grasp(session));
  session.Apply(Turn(360, -Vector3d::UnitZ()));
  Frame frame;
  int air = -1;
  for (int k = 0; k < 20000 && air < 0; ++k) {
    session.Tick();
    session.Snapshot(&frame, false);
    for (int i = 0; i < frame.num_fingers; ++i)
      if (frame.fingers[i].role == FingerRole::kMove && !frame.fingers[i].true_contact) air = i;
  }
  ASSERT_GE(air, 0) << "no finger ever left the object";
  Command stop;
  stop.type = CommandType::kStop;
  session.Apply(stop);
  const JobRecord job = Finish(session, 5);
  EXPECT_EQ(job.state, JobState::kCancelled);
  EXPECT_EQ(session.state(), SessionState::kHolding);
  for (int k = 0; k < 500; ++k) session.Tick();
  session.Snapshot(&frame, false);
  EXPECT_EQ(session.state(), SessionState::kHolding);
  for (int i = 0; i < frame.num_fingers; ++i) EXPECT_TRUE(frame.fingers[i].true_contact) << i;
}

TEST(Rotate, SameSeedSameBits) {
  std::uint64_t hash[2];
  for (std::uint64_t& h : hash) {
    Session session(Config(5));
    ASSERT_NO_FATAL_FAILURE(Grasp(session));
    session.Apply(Turn(40, Vector3d::UnitY()));
    for (int k = 0; k < 8000; ++k) session.Tick();
    h = session.StateHash();
  }
  EXPECT_EQ(hash[0], hash[1]);
}

// A long bar about its length, which this hand cannot turn so: it goes on a little, gives way and
// goes on again. That is no way ahead, and the job ends.
TEST(Rotate, AGaitThatTurnsTheObjectNoFurtherEnds) {
  SessionConfig config = Config(62);
  config.parameters.control.follow_object = 0;  // a grasp with which it goes so
  ObjectModel& bar = config.model.object;
  bar.kind = ObjectModel::Kind::kBox;
  bar.half_extents = Vector3d(0.015, 0.015, 0.055);
  bar.bounding_radius = bar.half_extents.norm();
  const Vector3d squares = bar.half_extents.cwiseAbs2();
  bar.I_OCom =
      (bar.mass / 3 * (Vector3d::Constant(squares.sum()) - squares)).asDiagonal().toDenseMatrix();
  Session session(config);
  Grasp(session);
  session.Apply(Turn(360, Vector3d::UnitY()));
  const JobRecord job = Finish(session, 400);
  EXPECT_EQ(job.state, JobState::kFailed);
  EXPECT_NE(std::string(job.error).find("no farther than before"), std::string::npos) << job.error;
  EXPECT_EQ(session.state(), SessionState::kHolding);
}

}  // namespace
}  // namespace regrasp
