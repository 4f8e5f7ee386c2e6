// What a session shows of itself.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/sensing/sensors.h"
#include "tests/physics/session_run.h"

namespace regrasp {
namespace {

using Kind = Verdict::Kind;

// What frames show as the truth of a fingertip is what its sensor would feel without noise.
TEST(Session, TruthOfAFingertipIsItsNoiseFreeReading) {
  SessionRun run(ShadowConfig(1, "off"));
  ASSERT_TRUE(run.Grasp());
  ASSERT_EQ(run.Explore(3, 1, 500).kind, Kind::kAllowed);
  int touching = 0;
  for (int k = 0; k < 1500; ++k) {
    run.Tick();
    const WorldState& truth = run.session.truth();
    const Frame frame = run.Snapshot();
    for (int i = 0; i < frame.num_fingers; ++i) {
      const FingertipReading reading = TrueFingertip(truth, i);
      ASSERT_EQ(frame.fingers[i].true_contact, reading.in_contact);
      if (!reading.in_contact) continue;
      ++touching;
      ASSERT_EQ(frame.fingers[i].true_p_WC, reading.p_WC);
      ASSERT_EQ(frame.fingers[i].true_normal_W, reading.normal_W);
    }
  }
  EXPECT_GT(touching, 5000);  // five fingers, most of the time
}

constexpr int kSpreadTicks = 100;

bool Finite(const Frame& f) {
  bool ok = f.q_sensed.allFinite() && f.q.allFinite() && f.qdot.allFinite() &&
            f.torque.allFinite() && f.p_WO_sensed.allFinite() &&
            f.q_WO_sensed.coeffs().allFinite() && f.p_WO.allFinite() &&
            f.q_WO.coeffs().allFinite() && f.v_WO.allFinite() && f.w_WO.allFinite() &&
            f.p_WO_reference.allFinite() && f.gravity_W.allFinite();
  for (const FingerFrame& x : f.fingers)
    ok = ok && x.p_WC.allFinite() && x.normal_W.allFinite() && std::isfinite(x.force) &&
         x.f_command_W.allFinite() && std::isfinite(x.manipulability) &&
         std::isfinite(x.joint_limit_margin) && x.true_p_WC.allFinite() &&
         x.true_normal_W.allFinite() && x.true_force_W.allFinite() &&
         std::isfinite(x.true_manipulability) && x.true_tip_W.allFinite() &&
         !std::isnan(x.load_margin_without);  // may be unbounded: +infinity
  for (const auto& c : f.contacts)
    ok = ok && c.p_WC.allFinite() && c.normal_W.allFinite() && c.force_W.allFinite();
  const StabilityFrame& s = f.stability;
  ok = ok && std::isfinite(s.active) && std::isfinite(s.threshold);
  const ExplorationFrame& e = f.exploration;
  ok = ok && std::isfinite(e.gradient_norm) == (e.active && e.cycle > 0);
  if (e.active && e.cycle > 0) ok = ok && std::isfinite(e.phi);
  for (const MeasureInfo& info : kMeasureTable) {
    if (info.cost == MeasureCost::kOnRequest) continue;
    const bool known = info.cost == MeasureCost::kTick || f.tick > kSpreadTicks;
    ok = ok && (std::isfinite(s.of(info.id)) || (!known && std::isnan(s.of(info.id))));
  }
  return ok && !std::isnan(s.load_margin) && f.exploration.gradient_W.allFinite();
}

TEST(Session, EpsilonIsUnknownUntilItHasBeenComputed) {
  SessionConfig config = ShadowConfig();
  config.parameters.control.stability_measure = Measure::kEpsilon;
  SessionRun run(config);
  run.Tick();
  EXPECT_TRUE(std::isnan(run.Snapshot().stability.of(Measure::kEpsilon)));
  EXPECT_TRUE(std::isnan(run.Snapshot().stability.active));
  std::string state;
  run.session.Save(&state);
  run.Ticks(kSpreadTicks);
  EXPECT_EQ(run.Snapshot().stability.of(Measure::kEpsilon), 0);  // nothing is grasped
  EXPECT_EQ(run.Snapshot().stability.active, 0);
  run.session.Load(state);
  EXPECT_TRUE(std::isnan(run.Snapshot().stability.of(Measure::kEpsilon)));
}

TEST(Session, FramesAreFinite) {
  SessionRun run(5);
  Frame frame;
  const auto Check = [&](int ticks, const char* when) {
    for (int k = 0; k < ticks; ++k) {
      run.Tick();
      run.session.Snapshot(&frame, false);
      ASSERT_TRUE(Finite(frame)) << when << ", tick " << k;
    }
  };
  Check(50, "idle");
  run.Give(CommandType::kGrasp);
  Check(6000, "grasping");
  ASSERT_EQ(run.session.state(), SessionState::kHolding);
  run.Explore(3);
  Check(3000, "exploring");
  run.Give(CommandType::kStop);
  Check(1500, "stopping");
  run.Give(CommandType::kRelease);
  Check(2000, "released, the object falling");
}

TEST(Session, PhiOfAnExplorationIsUnknownUntilItsFingerSlides) {
  SessionRun run;
  ASSERT_TRUE(run.Grasp());
  ASSERT_EQ(run.Explore(3, 1, 100).kind, Verdict::Kind::kAllowed);
  int unknown = 0, known = 0;
  while (run.session.job_running()) {
    run.Tick();
    const Frame frame = run.Snapshot();
    const ExplorationFrame& e = frame.exploration;
    if (!e.active) continue;
    const bool slides = frame.fingers[3].role == FingerRole::kExplore;
    EXPECT_EQ(std::isnan(e.phi), known == 0 && !slides) << frame.tick;
    EXPECT_TRUE(std::isnan(e.phi) || e.phi > 0.1) << frame.tick;  // not 0 for what is not known
    std::isnan(e.phi) ? ++unknown : ++known;
  }
  EXPECT_GT(unknown, 100);  // its load is taken from it
  EXPECT_GT(known, 200);
}

TEST(Session, FrameTellsTheQualityOfTheGrasp) {
  SessionRun run;
  ASSERT_TRUE(run.Grasp());
  run.Ticks(1000);
  const Frame frame = run.Snapshot();
  EXPECT_GT(frame.stability.of(Measure::kMinSingularValue), 0);
  EXPECT_GT(frame.stability.of(Measure::kEpsilon),
            0);  // five fingers around a sphere: force closure
  EXPECT_GT(frame.stability.load_margin, 0);
  EXPECT_EQ(frame.stability.measure, Measure::kMinSingularValue);
  EXPECT_EQ(frame.stability.active, frame.stability.of(Measure::kMinSingularValue));
  for (const FingerFrame& finger : frame.fingers) {
    EXPECT_EQ(finger.role, FingerRole::kHold);
    EXPECT_TRUE(finger.true_contact);
    EXPECT_GT(finger.manipulability, 0);
    EXPECT_GT(finger.joint_limit_margin, 0);
    // A margin is worth nothing without four others; with them it is at most the whole grasp's,
    // within what noise changes in the 30 ms between the two looks: 30 %.
    EXPECT_LE(finger.load_margin_without, 1.3 * frame.stability.load_margin);
  }
}

}  // namespace
}  // namespace regrasp
