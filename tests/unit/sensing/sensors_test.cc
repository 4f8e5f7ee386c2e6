#include "core/sensing/sensors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/hand/taxels.h"
#include "tests/unit/sensing/sensors_fixture.h"

namespace regrasp {
namespace {

constexpr double kDegree = M_PI / 180;

/// Sample mean within 5 standard errors; sample sigma within 5 of its own, sigma / sqrt(2 n).
void ExpectWhite(const Moments& m, double sigma, const char* what) {
  EXPECT_NEAR(m.mean(), 0, 5 * sigma / std::sqrt(m.n)) << what;
  EXPECT_NEAR(m.sigma(), sigma, 5 * sigma / std::sqrt(2.0 * m.n)) << what;
}

TEST_F(SensorsTest, OffIsTheTruthToTheBit) {
  Collect(*NoisePreset("off"), 3, [&](const SensorReading& reading) {
    EXPECT_EQ(reading.q, truth_.q);
    EXPECT_EQ(reading.p_WO, truth_.p_WO);
    EXPECT_EQ(reading.q_WO.coeffs(), truth_.q_WO.coeffs());
    for (int f = 0; f < hand_.num_fingers(); ++f) {
      EXPECT_TRUE(reading.fingertips[f].in_contact);
      EXPECT_EQ(reading.fingertips[f].p_WC, truth_.contacts[f].p_WC);
      EXPECT_EQ(reading.fingertips[f].normal_W, truth_.contacts[f].normal_W);
      EXPECT_EQ(reading.fingertips[f].force,
                -truth_.contacts[f].force_W.dot(truth_.contacts[f].normal_W));
    }
  });
}

TEST_F(SensorsTest, PaperNoiseHasTheStatedMoments) {
  Moments position, tilt, force, joint, object_position, object_rotation;
  Collect(*NoisePreset("paper"), 20000, [&](const SensorReading& reading) {
    const ObjectContact& contact = truth_.contacts[2];
    const FingertipReading& tip = reading.fingertips[2];
    position.Add((tip.p_WC - contact.p_WC).y());
    // The component along a fixed tangent is the sine of the tilt about the other: at 2 deg, equal
    // to the angle within 0.1 %, a tenth of the tolerance.
    tilt.Add(tip.normal_W.dot(RotationFromZ(contact.normal_W).col(0)));
    force.Add(tip.force + contact.force_W.dot(contact.normal_W));
    joint.Add(reading.q[5] - truth_.q[5]);
    object_position.Add((reading.p_WO - truth_.p_WO).x());
    object_rotation.Add(RotationVector(reading.q_WO * truth_.q_WO.inverse()).z());
  });
  ExpectWhite(position, 1e-3, "position");
  ExpectWhite(tilt, 2 * kDegree, "normal");
  ExpectWhite(force, 0.05, "force");
  ExpectWhite(joint, 0.3 * kDegree, "joint");
  ExpectWhite(object_position, 1e-3, "object position");
  ExpectWhite(object_rotation, 1 * kDegree, "object rotation");
}

TEST_F(SensorsTest, NoiseIsWhiteInTime) {
  std::vector<double> x;
  Collect(*NoisePreset("paper"), 20000,
          [&](const SensorReading& r) { x.push_back(r.q[0] - truth_.q[0]); });
  for (int lag = 1; lag <= 3; ++lag) {
    double sum = 0, square = 0;
    for (std::size_t i = lag; i < x.size(); ++i) sum += x[i] * x[i - lag], square += x[i] * x[i];
    EXPECT_LT(std::abs(sum / square), 5 / std::sqrt(20000.0))
        << "lag " << lag;  // 5 standard errors
  }
}

TEST_F(SensorsTest, NormalsAreUnitAndForcesNotNegative) {
  NoiseLevels levels = *NoisePreset("coarse");
  levels.force_n = 2;
  levels.normal_rad = 1;
  Collect(levels, 2000, [&](const SensorReading& reading) {
    for (const FingertipReading& tip : reading.fingertips) {
      EXPECT_NEAR(tip.normal_W.norm(), 1, 1e-14);
      EXPECT_GE(tip.force, 0);
    }
  });
}

/// Changing one level changes that sensor's samples and no bit of any other's.
TEST_F(SensorsTest, StreamsAreIndependent) {
  const NoiseLevels base = *NoisePreset("paper");
  struct Case {
    const char* name;
    double NoiseLevels::*level;
  };
  const Case cases[] = {{"position", &NoiseLevels::position_m},
                        {"normal", &NoiseLevels::normal_rad},
                        {"force", &NoiseLevels::force_n},
                        {"joint", &NoiseLevels::joint_rad},
                        {"object position", &NoiseLevels::object_position_m},
                        {"object rotation", &NoiseLevels::object_rotation_rad}};
  for (const Case& changed : cases) {
    NoiseLevels other = base;
    other.*changed.level = 0;
    Sensors a(hand_, 1e-3, 3), b(hand_, 1e-3, 3);
    a.SetNoise(base);
    b.SetNoise(other);
    for (int tick = 0; tick < 50; ++tick) {
      const SensorReading& ra = a.Read(tick, truth_);
      const SensorReading& rb = b.Read(tick, truth_);
      bool same[6] = {
          true, true, true, ra.q == rb.q, ra.p_WO == rb.p_WO, ra.q_WO.coeffs() == rb.q_WO.coeffs()};
      for (int f = 0; f < hand_.num_fingers(); ++f) {
        same[0] &= ra.fingertips[f].p_WC == rb.fingertips[f].p_WC;
        same[1] &= ra.fingertips[f].normal_W == rb.fingertips[f].normal_W;
        same[2] &= ra.fingertips[f].force == rb.fingertips[f].force;
      }
      for (int i = 0; i < 6; ++i)
        ASSERT_EQ(same[i], &cases[i] != &changed) << cases[i].name << " after " << changed.name;
    }
  }
}

TEST_F(SensorsTest, ContactsDoNotShiftTheStreams) {
  Sensors a(hand_, 1e-3, 3), b(hand_, 1e-3, 3);
  a.SetNoise(*NoisePreset("paper"));
  b.SetNoise(*NoisePreset("paper"));
  WorldState free = truth_;
  free.contacts.clear();
  for (int tick = 0; tick < 20; ++tick) {
    a.Read(tick, truth_);
    const SensorReading& none = b.Read(tick, free);
    for (const FingertipReading& tip : none.fingertips) EXPECT_FALSE(tip.in_contact);
  }
  const SensorReading ra = a.Read(20, truth_);
  const SensorReading rb = b.Read(20, truth_);
  for (int f = 0; f < hand_.num_fingers(); ++f) {
    EXPECT_EQ(ra.fingertips[f].p_WC, rb.fingertips[f].p_WC);
    EXPECT_EQ(ra.fingertips[f].force, rb.fingertips[f].force);
  }
}

TEST_F(SensorsTest, SeedsAndHashesTellRunsApart) {
  const auto hash = [&](std::uint64_t seed, const char* preset) {
    Sensors sensors(hand_, 1e-3, seed);
    sensors.SetNoise(*NoisePreset(preset));
    for (int tick = 0; tick < 5; ++tick) sensors.Read(tick, truth_);
    StateHasher hasher;
    HashFields(sensors, &hasher);
    return hasher.Digest();
  };
  EXPECT_EQ(hash(1, "paper"), hash(1, "paper"));
  EXPECT_NE(hash(1, "paper"), hash(2, "paper"));
  EXPECT_NE(hash(1, "paper"), hash(1, "fine"));
}

TEST_F(SensorsTest, LightTouchAndOtherLinksAreNoContact) {
  truth_.contacts[0].force_W = -0.009 * truth_.contacts[0].normal_W;  // the threshold is .01 N
  truth_.contacts[1].force_W = -0.011 * truth_.contacts[1].normal_W;
  truth_.contacts[2].finger = -1;
  Collect(*NoisePreset("off"), 1, [&](const SensorReading& reading) {
    EXPECT_FALSE(reading.fingertips[0].in_contact);
    EXPECT_TRUE(reading.fingertips[1].in_contact);
    EXPECT_FALSE(reading.fingertips[2].in_contact);
    EXPECT_EQ(reading.fingertips[2].force, 0);
  });
}

TEST_F(SensorsTest, SeveralContactsAreWeightedByForce) {
  ObjectContact a = truth_.contacts[0], b = a;
  a.normal_W = b.normal_W = Vector3d::UnitZ();
  a.force_W = Vector3d(0.4, 0, -1);  // friction does not count as pressure
  b.force_W = Vector3d(0, 0, -3);
  b.p_WC = a.p_WC + Vector3d(4e-3, 0, 0);
  truth_.contacts.clear();
  truth_.contacts.push_back(a);
  truth_.contacts.push_back(b);
  Collect(*NoisePreset("off"), 1, [&](const SensorReading& reading) {
    EXPECT_LT((reading.fingertips[0].p_WC - (a.p_WC + Vector3d(3e-3, 0, 0))).norm(),
              1e-15);  // rounding
    EXPECT_EQ(reading.fingertips[0].normal_W, Vector3d(0, 0, 1));
    EXPECT_DOUBLE_EQ(reading.fingertips[0].force, 4);
  });
}

TEST_F(SensorsTest, SamplesAtOneKilohertzWhateverTheStep) {
  Sensors fast(hand_, 0.5e-3, 7), slow(hand_, 1e-3, 7);
  fast.SetNoise(*NoisePreset("paper"));
  slow.SetNoise(*NoisePreset("paper"));
  for (int tick = 0; tick < 100; ++tick) {
    const SensorReading even = fast.Read(2 * tick, truth_);
    const SensorReading odd = fast.Read(2 * tick + 1, truth_);
    const SensorReading& reference = slow.Read(tick, truth_);
    EXPECT_EQ(even.q, reference.q);
    EXPECT_EQ(odd.q, reference.q);
    EXPECT_EQ(odd.fingertips[3].p_WC, reference.fingertips[3].p_WC);
    EXPECT_EQ(odd.tick, 2 * tick + 1);
  }
}

TEST_F(SensorsTest, LateObjectPoseIsOneToTwoFramesOld) {
  NoiseLevels levels;
  levels.object_rate_hz = 15;
  levels.object_delay_frames = 1;
  Sensors sensors(hand_, 1e-3, 1);
  sensors.SetNoise(levels);
  int changes = 0;
  double last = -1;
  for (int tick = 0; tick < 3000; ++tick) {
    truth_.p_WO.x() = tick * 1e-3;  // the position tells when it was seen
    const double seen = sensors.Read(tick, truth_).p_WO.x();
    const double age_s = tick * 1e-3 - seen;
    if (tick >= 134) {                            // two frames of 66.7 ms
      EXPECT_GE(age_s, 1.0 / 15 - 1e-3) << tick;  // frames begin on whole ticks
      EXPECT_LE(age_s, 2.0 / 15 + 1e-3) << tick;
    }
    changes += seen != last;
    last = seen;
  }
  EXPECT_EQ(changes, 44);  // 3 s hold 45 frames, of which the last is not yet reported
}

TEST_F(SensorsTest, TaxelsSnapPositionAndNormal) {
  const double pitch = NoisePreset("taxel")->taxel_pitch_m;
  NoiseLevels levels;
  levels.taxel_pitch_m = pitch;
  Collect(levels, 1, [&](const SensorReading& reading) {
    for (int f = 0; f < hand_.num_fingers(); ++f) {
      const auto taxels = MakeTaxels(MakeTipAxes(hand_, f), pitch);
      const Isometry3d& X_WL = kinematics_.X_WL[hand_.fingers[f].tip_link];
      int matches = 0;
      double nearest = 1;
      for (const Taxel& taxel : taxels) {
        nearest = std::min(nearest, (X_WL * taxel.p_LT - truth_.contacts[f].p_WC).norm());
        if ((X_WL * taxel.p_LT - reading.fingertips[f].p_WC).norm() > 1e-12) continue;  // rounding
        ++matches;
        EXPECT_LT((X_WL.linear() * taxel.outward_L + reading.fingertips[f].normal_W).norm(), 1e-12);
      }
      EXPECT_EQ(matches, 1);
      EXPECT_NEAR((reading.fingertips[f].p_WC - truth_.contacts[f].p_WC).norm(), nearest, 1e-12);
    }
  });
}

TEST_F(SensorsTest, TaxelsLieOnTheTipOnePitchApart) {
  const double pitch = 6.6e-3;
  for (int f = 0; f < hand_.num_fingers(); ++f) {
    const TipAxes tip = MakeTipAxes(hand_, f);
    const auto taxels = MakeTaxels(tip, pitch);
    for (std::size_t i = 0; i < taxels.size(); ++i) {
      const Vector3d from_centre = taxels[i].p_LT - tip.p_LF;
      const double back = std::clamp(-from_centre.dot(tip.along_L), 0.0, tip.segment);
      EXPECT_NEAR((from_centre + back * tip.along_L).norm(), tip.radius, 1e-12);
      EXPECT_NEAR(taxels[i].outward_L.norm(), 1, 1e-14);
      double nearest = 1;
      for (std::size_t k = 0; k < taxels.size(); ++k)
        if (k != i) nearest = std::min(nearest, (taxels[i].p_LT - taxels[k].p_LT).norm());
      // Chords of one pitch of arc: 2 r sin(pitch / 2 r) is 6.36 mm at r = 7 mm, and 5.5 mm around
      // the apex, where three taxels share a circle of radius r sin(pitch / 2 r) = 3.2 mm.
      EXPECT_GT(nearest, 0.8 * pitch) << f << " " << i;
      EXPECT_LT(nearest, 1.01 * pitch) << f << " " << i;
    }
    // The pad is where flexion of the last joint carries the tip.
    const Joint& last = hand_.joints[hand_.fingers[f].joints.back()];
    EXPECT_NEAR(tip.pad_L.dot(last.axis_J.cross(tip.p_LF).normalized()), 1, 1e-12);
  }
}

TEST(NoisePresets, NamesRoundTrip) {
  for (const std::string_view name : NoisePresetNames())
    EXPECT_EQ(NoiseName(*NoisePreset(name)), name);
  EXPECT_FALSE(NoisePreset("loud").has_value());
  NoiseLevels custom = *NoisePreset("paper");
  custom.force_n *= 2;
  EXPECT_EQ(NoiseName(custom), "custom");
}

}  // namespace
}  // namespace regrasp
