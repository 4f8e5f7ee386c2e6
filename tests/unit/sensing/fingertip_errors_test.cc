#include "core/sensing/fingertip_errors.h"

#include <vector>

#include "tests/unit/sensing/sensors_fixture.h"

namespace regrasp {
namespace {

TEST_F(SensorsTest, BiasesStayInTheFingertipAndFollowTheSeed) {
  NoiseLevels levels;
  levels.position_bias_m = 0.001;
  levels.force_bias_n = 0.1;
  levels.joint_bias_rad = 0.01;
  levels.object_bias_m = 0.002;
  const Vector3d truth_p = TrueFingertip(truth_, 0).p_WC;
  const auto offset_L = [&](const SensorReading& reading) {
    return Vector3d(kinematics_.X_WL[hand_.fingers[0].tip_link].linear().transpose() *
                    (reading.fingertips[0].p_WC - truth_p));
  };
  std::vector<Vector3d> of_seed;
  for (std::uint64_t seed : {7, 8}) {
    Vector3d first = Vector3d::Zero();
    int n = 0;
    Collect(
        levels, 50,
        [&](const SensorReading& reading) {
          if (n++ == 0) first = offset_L(reading);
          EXPECT_LT((offset_L(reading) - first).norm(), 1e-12);
          EXPECT_GT((reading.q - truth_.q).norm(), 1e-4);
          EXPECT_GT((reading.p_WO - truth_.p_WO).norm(), 1e-5);
        },
        seed);
    EXPECT_GT(first.norm(), 1e-5);
    EXPECT_LT(first.norm(), 0.006);
    of_seed.push_back(first);
  }
  EXPECT_GT((of_seed[0] - of_seed[1]).norm(), 1e-5);
}

TEST_F(SensorsTest, DriftGrowsWithTheRootOfTime) {
  NoiseLevels levels;
  levels.position_drift_m = 0.001;
  levels.object_drift_m = 0.002;
  Moments contact, object;
  const Vector3d truth_p = TrueFingertip(truth_, 1).p_WC;
  for (std::uint64_t seed = 0; seed < 300; ++seed)
    Collect(
        levels, 1000,
        [&](const SensorReading& reading) {
          if (reading.tick != 999) return;
          for (int k = 0; k < 3; ++k) {
            contact.Add(reading.fingertips[1].p_WC[k] - truth_p[k]);
            object.Add(reading.p_WO[k] - truth_.p_WO[k]);
          }
        },
        seed);
  EXPECT_NEAR(contact.sigma(), 0.001, 0.0001);  // 4 of its own standard errors
  EXPECT_NEAR(object.sigma(), 0.002, 0.0002);
}

TEST_F(SensorsTest, DropoutsTakeTheirShareInGapsOfTheirLength) {
  NoiseLevels levels;
  levels.dropout = 0.2;
  levels.dropout_gap_s = 0.02;
  int out = 0, gaps = 0;
  bool before = false;
  constexpr int kTicks = 200000;
  Collect(levels, kTicks, [&](const SensorReading& reading) {
    const bool now = !reading.fingertips[2].in_contact;
    out += now;
    gaps += now && !before;
    before = now;
  });
  EXPECT_NEAR(static_cast<double>(out) / kTicks, 0.2, 0.02);
  EXPECT_NEAR(1e-3 * out / gaps, 0.02, 0.002);
}

TEST_F(SensorsTest, LatencyReportsWhatWasFeltBefore) {
  NoiseLevels levels;
  levels.latency_s = 0.005;
  Sensors sensors(hand_, 1e-3, 7);
  sensors.SetNoise(levels);
  std::vector<double> felt, reported;
  for (int tick = 0; tick < 40; ++tick) {
    truth_.contacts[0].force_W = -(1 + 0.1 * tick) * truth_.contacts[0].normal_W;
    felt.push_back(TrueFingertip(truth_, 0).force);
    reported.push_back(sensors.Read(tick, truth_).fingertips[0].force);
  }
  for (int tick = 5; tick < 40; ++tick) EXPECT_DOUBLE_EQ(reported[tick], felt[tick - 5]);
  levels.latency_s = 0;
  sensors.SetNoise(levels);
  EXPECT_DOUBLE_EQ(sensors.Read(40, truth_).fingertips[0].force, felt[39]);
}

}  // namespace
}  // namespace regrasp
