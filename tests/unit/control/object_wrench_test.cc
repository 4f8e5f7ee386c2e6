#include "core/control/object_wrench.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/common/random.h"

namespace regrasp {
namespace {

constexpr double kDt = 1e-3;
const Vector3d kGravity(0, 4, 8);

Estimate At(const Vector3d& p, const Quaterniond& q = Quaterniond::Identity()) {
  Estimate e;
  e.p_WO = p;
  e.q_WO = q;
  return e;
}

TEST(ObjectWrench, StartsAtTheWeightWithoutTorque) {
  const ControlParameters parameters;
  ObjectWrench wrench;
  wrench.Start(At({1, 2, 3}), kGravity, parameters);
  EXPECT_EQ(wrench.force(), -parameters.mass_estimate * kGravity);
  EXPECT_EQ(wrench.torque(), Vector3d::Zero());
  wrench.Update(At({1, 2, 3}), kGravity, parameters, kDt,
                false);  // on its reference: nothing to add
  EXPECT_EQ(wrench.force(), -parameters.mass_estimate * kGravity);
  EXPECT_EQ(wrench.torque(), Vector3d::Zero());
}

TEST(ObjectWrench, PullsBackInProportionAndIntegrates) {
  const ControlParameters parameters;
  ObjectWrench wrench;
  wrench.Start(At(Vector3d::Zero()), kGravity, parameters);
  const Vector3d off(0.001, -0.002, 0.0005);  // within the error limit
  constexpr int kTicks = 100;
  for (int k = 0; k < kTicks; ++k) wrench.Update(At(off), kGravity, parameters, kDt, false);
  const Vector3d expected =
      -parameters.mass_estimate * kGravity -
      (parameters.position_stiffness + parameters.position_integral * kTicks * kDt) * off;
  EXPECT_LT((wrench.force() - expected).norm(), 1e-12);  // rounding
}

TEST(ObjectWrench, TurnsBackAboutTheAxisOfTheError) {
  ControlParameters parameters;
  parameters.yield_s = 0;
  ObjectWrench wrench;
  const Quaterniond start = FromRotationVector({0.3, -0.2, 0.5});
  wrench.Start(At(Vector3d::Zero(), start), kGravity, parameters);
  const Vector3d turned(0.02, 0.05, -0.03);  // in W, after the start orientation
  wrench.Update(At(Vector3d::Zero(), FromRotationVector(turned) * start), kGravity, parameters, kDt,
                true);
  EXPECT_LT((wrench.torque() + parameters.rotation_stiffness * turned).norm(), 1e-12);
}

TEST(ObjectWrench, LimitsTheErrorThatItActsOn) {
  ControlParameters parameters;
  parameters.yield_s = 0;
  ObjectWrench wrench;
  wrench.Start(At(Vector3d::Zero()), Vector3d::Zero(), parameters);
  wrench.Update(At({1, 0, 0}, FromRotationVector({0, 0, 2})), kGravity, parameters, kDt, true);
  const double f = parameters.position_stiffness * parameters.position_error_limit;
  const double t = parameters.rotation_stiffness * parameters.rotation_error_limit;
  EXPECT_LT((wrench.force() - Vector3d(-f, 0, 0)).norm(), 1e-12);
  EXPECT_LT((wrench.torque() - Vector3d(0, 0, -t)).norm(), 1e-12);
}

TEST(ObjectWrench, IntegralsStayInTheirBoxAboutTheStart) {
  ControlParameters parameters;
  parameters.yield_s = 0;
  ObjectWrench wrench;
  const Estimate off = At({0.02, -0.02, 0.02}, FromRotationVector({0.3, -0.3, 0.3}));
  wrench.Start(At(Vector3d::Zero()), kGravity, parameters);
  for (int k = 0; k < 60000; ++k) {
    wrench.Update(off, kGravity, parameters, kDt, false);
    const Vector3d integral = wrench.force() + parameters.mass_estimate * kGravity;
    // What is beyond the proportional part is the integral.
    ASSERT_LE(integral.cwiseAbs().maxCoeff(),
              parameters.force_integral_limit +
                  parameters.position_stiffness * parameters.position_error_limit + 1e-12);
  }
  // Back on the reference only the integrals remain, at their limits: 60 s at the largest error is
  // many times what fills them.
  wrench.Update(At(Vector3d::Zero()), kGravity, parameters, kDt, true);
  const double f = parameters.force_integral_limit, t = parameters.torque_integral_limit;
  EXPECT_LT((wrench.force() + parameters.mass_estimate * kGravity - Vector3d(-f, f, -f)).norm(),
            1e-12);
  EXPECT_LT((wrench.torque() - Vector3d(-t, t, -t)).norm(), 1e-12);
}

TEST(ObjectWrench, AMissedWrenchStopsTheIntegrals) {
  ControlParameters parameters;
  parameters.yield_s = 0;
  ObjectWrench wrench;
  wrench.Start(At(Vector3d::Zero()), kGravity, parameters);
  const Vector3d off(0.001, 0, 0);
  for (int k = 0; k < 1000; ++k) wrench.Update(At(off), kGravity, parameters, kDt, true);
  EXPECT_LT(
      (wrench.force() + parameters.mass_estimate * kGravity + parameters.position_stiffness * off)
          .norm(),
      1e-12);
  wrench.Update(At(Vector3d::Zero()), kGravity, parameters, kDt, true);
  EXPECT_EQ(wrench.force(), -parameters.mass_estimate * kGravity);
}

// Off its reference, with the integrals at work.
TEST(ObjectWrench, AMissedWrenchYieldsToBearingTheWeightAndComesBack) {
  const ControlParameters parameters;
  ObjectWrench wrench, never;
  ControlParameters stubborn = parameters;
  stubborn.yield_s = 0;
  const Estimate off = At({0.002, -0.003, 0.001}, FromRotationVector({0.05, 0.1, -0.05}));
  const Vector3d weight = parameters.mass_estimate * kGravity;
  wrench.Start(At(Vector3d::Zero()), kGravity, parameters);
  never.Start(At(Vector3d::Zero()), kGravity, stubborn);
  const auto update = [&](double seconds, bool missed) {
    for (int k = 0; k < std::lround(seconds / kDt); ++k) {
      wrench.Update(off, kGravity, parameters, kDt, missed);
      never.Update(off, kGravity, stubborn, kDt, missed);
    }
  };
  update(parameters.yield_s / 2, true);
  EXPECT_NEAR(wrench.share(), 0.5, 1e-9);
  EXPECT_LT((wrench.force() + weight - 0.5 * (never.force() + weight)).norm(), 1e-9);
  EXPECT_LT((wrench.torque() - 0.5 * never.torque()).norm(), 1e-12);
  update(parameters.yield_s, true);
  EXPECT_LT((wrench.force() + weight).norm(), 1e-12);
  EXPECT_LT(wrench.torque().norm(), 1e-12);
  update(1.1 * parameters.resume_s, false);
  EXPECT_EQ(wrench.share(), 1);
  EXPECT_EQ(wrench.force(), never.force());
  EXPECT_EQ(wrench.torque(), never.torque());
}

// An object of twice the mass is let down to its own weight, not to the one assumed.
TEST(ObjectWrench, YieldsToTheMassBorneLately) {
  const ControlParameters parameters;
  ObjectWrench wrench;
  const Vector3d weight = parameters.mass_estimate * kGravity;
  wrench.Start(At(Vector3d::Zero()), kGravity, parameters);
  const Vector3d sunk = -weight / parameters.position_stiffness;  // P alone bears the rest
  ControlParameters no_integral = parameters;
  no_integral.position_integral = 0;
  for (int k = 0; k < 10000; ++k) wrench.Update(At(-sunk), kGravity, no_integral, kDt, false);
  EXPECT_LT((wrench.force() + 2 * weight).norm(), 1e-9);
  for (int k = 0; k < 100; ++k) wrench.Update(At(-sunk), kGravity, no_integral, kDt, true);
  EXPECT_LT((wrench.force() + 2 * weight).norm(), 1e-3 * weight.norm());
}

TEST(ObjectWrench, ReferenceMovesWithTheWantedMotion) {
  const ControlParameters parameters;
  ObjectWrench wrench;
  wrench.Start(At({0.1, 0, 0}), kGravity, parameters);
  for (int k = 0; k < 1000; ++k) wrench.Move({0.01, -0.02, 0.03}, {0, 0, 0.5}, kDt);
  EXPECT_LT((wrench.p_ref() - Vector3d(0.11, -0.02, 0.03)).norm(), 1e-12);
  EXPECT_LT((RotationVector(wrench.q_ref()) - Vector3d(0, 0, 0.5)).norm(), 1e-9);
}

}  // namespace
}  // namespace regrasp
