/// What published files hold of joints: some that follow others or have no limit, palms of any
/// orientation, postures on a limit.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/hand/kinematics.h"
#include "core/hand/urdf.h"
#include "tests/unit/hand/model_files.h"

namespace regrasp {
namespace {

using PublishedJoints = LoaderTest;

TEST_F(PublishedJoints, CoupledJointsFollowAndPassTheirTorque) {
  EditHand(
      "<limit lower=\"-0.5\" upper=\"1.5\"",
      "<mimic joint=\"A\" multiplier=\"0.5\" offset=\"0.1\"/><limit lower=\"-0.5\" upper=\"0.6\"");
  EditScenario("B = 20.5\n", "");
  Write("hands/mini.toml",
        Replaced(Replaced(kScenarioToml, "B = 20.5\n", ""), "A = 60\nB = 70\n", "A = 57.3\n"));
  const HandModel hand = Load().hand;
  ASSERT_EQ(hand.num_joints(), 1);
  ASSERT_EQ(hand.joints.size(), 2u);
  EXPECT_EQ(hand.joints[1].driver, 0);
  EXPECT_DOUBLE_EQ(hand.joints[0].upper, 1.0);  // 0.5 q + 0.1 <= 0.6
  EXPECT_EQ(hand.fingers[0].joints, std::vector<int>{0});
  // The Jacobian against a finite difference: both joints move with the one angle.
  const auto tip = [&](double q) {
    KinematicsData data;
    ForwardKinematics(hand, JointVector::Constant(1, q), &data);
    return FingertipCentre(hand, data, 0);
  };
  KinematicsData data;
  ForwardKinematics(hand, JointVector::Constant(1, 0.7), &data);
  const FingerJacobian J = PointJacobian(hand, data, 0, FingertipCentre(hand, data, 0));
  constexpr double kStep = 1e-6;
  EXPECT_LT((J.col(0) - (tip(0.7 + kStep) - tip(0.7 - kStep)) / (2 * kStep)).norm(), 1e-9);
  // Gravity torque is the slope of the potential energy.
  const Vector3d g(1, -2, -9);
  const auto energy = [&](double q) {
    KinematicsData at;
    ForwardKinematics(hand, JointVector::Constant(1, q), &at);
    double sum = 0;
    for (std::size_t l = 0; l < hand.links.size(); ++l)
      sum -= hand.links[l].mass * g.dot(at.X_WL[l] * hand.links[l].p_LCom);
    return sum;
  };
  EXPECT_NEAR(GravityTorque(hand, data, g)[0],
              (energy(0.7 + kStep) - energy(0.7 - kStep)) / (2 * kStep), 1e-9);
}

TEST_F(PublishedJoints, AScenarioCouplesJoints) {
  Write("hands/mini.toml",
        Replaced(Replaced(Replaced(kScenarioToml, "B = 20.5\n", ""), "B = 70\n", ""),
                 "[q_preshape_deg]",
                 "[coupled.B]\ndriver = \"A\"\nratio = 0.5\noffset_deg = 10\n[q_preshape_deg]"));
  const HandModel hand = Load().hand;
  ASSERT_EQ(hand.num_joints(), 1);
  EXPECT_EQ(hand.joints[1].ratio, 0.5);
  EXPECT_DOUBLE_EQ(hand.joints[1].offset, M_PI / 18);
}

TEST_F(PublishedJoints, AnyPalmIsTurnedAndJointsCanBeLocked) {
  const HandModel straight = Load().hand;
  Write("hands/mini.toml",
        Replaced(Replaced(Replaced(kScenarioToml, "B = 20.5\n", ""), "B = 70\n", ""),
                 "[q_preshape_deg]",
                 "[palm]\nrotation_deg = [90, 0, 0]\nposition_m = [0, 0, 0.5]\n"
                 "[locked_deg]\nB = 30\n[q_preshape_deg]"));
  const HandModel turned = Load().hand;
  ASSERT_EQ(turned.num_joints(), 1);
  KinematicsData a, b;
  ForwardKinematics(straight, Eigen::Vector2d(0.4, M_PI / 6), &a);
  ForwardKinematics(turned, JointVector::Constant(1, 0.4), &b);
  const Vector3d p = FingertipCentre(straight, a, 0);
  EXPECT_LT((FingertipCentre(turned, b, 0) - Vector3d(p.x(), -p.z(), p.y() + 0.5)).norm(), 1e-12);
}

TEST_F(PublishedJoints, ReportsWhatItTook) {
  EditHand("type=\"revolute\"", "type=\"continuous\"");
  Write("hands/mini.toml", kScenarioToml);
  const LoadedScenario loaded = Load();
  EXPECT_DOUBLE_EQ(loaded.hand.joints[0].lower, -M_PI);
  ASSERT_EQ(loaded.report.warnings.size(), 2u);
  EXPECT_NE(loaded.report.warnings[0].Line().find("mini.urdf:12: joint \"A\": a continuous joint"),
            std::string::npos);
  EXPECT_NE(loaded.report.warnings[1].text.find("<dynamics damping> is missing for 1 joint (B)"),
            std::string::npos);
}

TEST_F(PublishedJoints, AContinuousJointNeedsNoLimit) {
  const std::string limit = "<limit lower=\"0\" upper=\"1.5\" effort=\"2\" velocity=\"10\"/>";
  const std::string turning =
      Replaced(kHandUrdf, "\"A\" type=\"revolute\"", "\"A\" type=\"continuous\"");
  Write("hands/mini.urdf", Replaced(turning, limit, ""));
  Write("hands/mini.toml", kScenarioToml);
  EXPECT_DOUBLE_EQ(Load().hand.joints[0].effort, kDefaultEffort);
}

TEST_F(PublishedJoints, AJointWithoutADriveNeedsNoEffort) {
  const std::string limit = "effort=\"1\" velocity=\"10\"/>", none = "velocity=\"10\"/>";
  const std::string alone = Replaced(Replaced(kScenarioToml, "B = 20.5\n", ""), "B = 70\n", "");
  EditHand(limit, none);
  Write("hands/mini.toml", kScenarioToml);
  ExpectRefused({"mini.urdf:15", "joint \"B\": <limit> effort is missing"});
  for (const char* table : {"[locked_deg]\nB = 5", "[coupled.B]\ndriver = \"A\""}) {
    SCOPED_TRACE(table);
    Write("hands/mini.toml",
          Replaced(alone, "[q_preshape_deg]", table + std::string("\n[q_preshape_deg]")));
    EXPECT_EQ(Load().hand.num_joints(), 1);
  }
  EditHand(limit, none + "<mimic joint=\"A\"/>");
  Write("hands/mini.toml", alone);
  EXPECT_EQ(Load().hand.num_coupled, 1);
}

TEST_F(PublishedJoints, PosturesMayStandOnRoundedLimits) {
  EditScenario("A = 10", "A = -0.005");
  EXPECT_EQ(Load().scenario.q_preshape[0], 0);
  EditScenario("A = 10", "A = -0.006");
  ExpectRefused({"mini.toml:10", "q_preshape_deg.A", "-0.006"});
}

TEST_F(PublishedJoints, ARoundedHalfTurnIsALimit) {
  for (const char* half : {"3.1416", "3.142", "3.14159266"}) {
    SCOPED_TRACE(half);
    EditHand("lower=\"0\" upper=\"1.5\"", fmt::format("lower=\"-{0}\" upper=\"{0}\"", half));
    EditScenario("A = 10", "A = -180");
    const LoadedScenario loaded = Load();
    EXPECT_EQ(loaded.hand.joints[0].lower, -M_PI);
    EXPECT_EQ(loaded.hand.joints[0].upper, M_PI);
    EXPECT_EQ(loaded.scenario.q_preshape[0], -M_PI);
  }
  EditHand("lower=\"0\" upper=\"1.5\"", "lower=\"0\" upper=\"3.15\"");
  ExpectRefused({"mini.urdf:13", "joint \"A\"", "<limit> upper [rad] = 3.15; allowed -3.14159"});
  // A coupled joint's are its own.
  EditHand("upper=\"1.5\" effort=\"1\" velocity=\"10\"/>",
           "upper=\"6.2832\" effort=\"1\" velocity=\"10\"/><mimic joint=\"A\"/>");
  Write("hands/mini.toml", Replaced(Replaced(kScenarioToml, "B = 20.5\n", ""), "B = 70\n", ""));
  EXPECT_EQ(Load().hand.joints[1].upper, 6.2832);
}

}  // namespace
}  // namespace regrasp
