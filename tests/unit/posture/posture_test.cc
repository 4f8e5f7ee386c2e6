/// Grasps found for hands that nobody has prepared.

#include "core/posture/grasp_search.h"
#include "core/posture/scenario_text.h"
#include "core/posture/way_in.h"
#include "tests/unit/posture/posture_fixture.h"

namespace regrasp {
namespace {

TEST_F(PostureTest, TouchesABallWithFingersOfAnyNumberOfJoints) {
  std::string text = RadialHandUrdf(3);
  // The far joints follow the near ones, and nothing turns sideways: one joint a finger.
  for (const char* n : {"arm1", "arm2", "arm3"}) {
    const std::string near = std::string(n) + "_near", far = std::string(n) + "_far";
    const std::size_t at = text.find("</joint>", text.find("\"" + far + "\""));
    text.insert(at, "<mimic joint=\"" + near + "\" multiplier=\"0.8\"/>");
    text = Replaced(text, "\"" + std::string(n) + "_side\" type=\"revolute\"",
                    "\"" + std::string(n) + "_side\" type=\"fixed\"");
  }
  const HandGuess guess = GuessHand(Write("hand.urdf", text));
  const HandModel hand = LoadHand(directory_ / "hand.urdf", guess.layout);
  ASSERT_EQ(hand.num_joints(), 3);
  ASSERT_EQ(hand.num_coupled, 3);
  const Vector3d centre(0, 0, 0.07);
  JointVector q = JointVector::Zero(3);
  ASSERT_TRUE(TouchBall(hand, 0.025, centre, &q));
  KinematicsData data;
  ForwardKinematics(hand, q, &data);
  for (int f = 0; f < 3; ++f)
    EXPECT_NEAR((FingertipCentre(hand, data, f) - centre).norm(), 0.033, 2e-5);
  EXPECT_FALSE(TouchBall(hand, 0.025, Vector3d(0, 0, 0.5), &q)) << "out of reach";
}

TEST_F(PostureTest, FindsAGraspThatItsJudgementAndItsFileAgreeOn) {
  const fs::path urdf = Write("radial.urdf", RadialHandUrdf(4));
  HandGuess guess = GuessHand(urdf);
  guess.layout.armature = 2e-4;
  const HandModel hand = LoadHand(urdf, guess.layout);
  GraspSearch search;
  search.steps = 300;
  search.starts = 2;
  const std::vector<BallGrasp> grasps = FindGrasps(hand, search);
  ASSERT_FALSE(grasps.empty());
  const BallGrasp& grasp = grasps.front();
  // Four fingers around a ball hold it without any one of them.
  EXPECT_GT(grasp.load_margin, 0.5);
  for (double margin : grasp.margin_without) EXPECT_GT(margin, 0.0);
  EXPECT_GT(grasp.facing, 0.0);
  BallGrasp again = grasp;
  RateGrasp(hand, search.task, -1e9, &again);
  EXPECT_DOUBLE_EQ(again.score, grasp.score);
  EXPECT_EQ(FindGrasps(hand, search).front().score, grasp.score) << "deterministic";

  RandomStream random(1, 2);
  const WayIn way = FindWayIn(hand, search.task, grasp, 2, &random);
  EXPECT_EQ(way.stuck, -1);
  KinematicsData data;
  for (int f = 0; f < 4; ++f) {
    const double reach = search.task.radius + hand.fingers[static_cast<std::size_t>(f)].tip_radius;
    ForwardKinematics(hand, way.open, &data);
    EXPECT_GT((FingertipCentre(hand, data, f) - grasp.p_WO).norm(), reach + 0.015);
    ForwardKinematics(hand, way.closed, &data);
    EXPECT_LT((FingertipCentre(hand, data, f) - grasp.p_WO).norm(), reach - 0.005);
  }

  // What is written is read back as the same scenario, from a place of its own.
  ScenarioText text;
  text.urdf = "radial.urdf";
  text.layout = guess.layout;
  text.scenario.object = "ball";
  text.scenario.q_preshape = way.open;
  text.scenario.q_closed = way.closed;
  text.scenario.X_WO.translation() = grasp.p_WO;
  const fs::path toml = Write("mine.toml", WriteScenario(text, hand));
  fs::create_directories(directory_ / "objects");
  std::ofstream(directory_ / "objects/ball.urdf") << kBallUrdf;
  const LoadedScenario loaded = LoadScenario(toml.string(), "", {directory_});
  EXPECT_EQ(loaded.hand.name, "mine");
  EXPECT_LT((loaded.scenario.q_preshape - way.open).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_LT((loaded.scenario.q_closed - way.closed).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_LT((loaded.scenario.X_WO.translation() - grasp.p_WO).norm(), 1e-5);
  for (std::size_t j = 0; j < hand.joints.size(); ++j)
    EXPECT_LT((loaded.hand.joints[j].X_PJ.translation() - hand.joints[j].X_PJ.translation()).norm(),
              2e-5);
}

TEST_F(PostureTest, AScenarioNamesFilesWhateverTheyAreCalled) {
  ScenarioText text;
  text.urdf = "odd \"name\"\n[palm]\\ \x7f.urdf";
  text.comments = {"made of\n[finger] " + text.urdf};
  text.scenario.object = "\t\x1b.urdf";
  fs::rename(Write("odd.urdf", kHandUrdf), directory_ / text.urdf);
  const fs::path toml = Write("mine.toml", WriteScenario(text, {}));
  EXPECT_EQ(FindHandFiles(toml.string(), {}).urdf, directory_ / text.urdf);
}

TEST_F(PostureTest, AScenarioThatNamesNoUrdfOrAMissingOneIsRefused) {
  const auto why = [&](const std::string& toml) {
    try {
      LoadScenario(Write("mine.toml", toml).string(), "", {directory_});
    } catch (const ModelError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(why("urdf = \"gone.urdf\"\n").find("urdf = \"gone.urdf\": file not found"),
            std::string::npos);
  EXPECT_NE(why("object = \"ball\"\n").find("mine.urdf beside it"), std::string::npos);
}

TEST(ShippedHands, HaveAGraspThatEveryFingerMayLeave) {
  for (const char* name : {"allegro", "leap"}) {
    SCOPED_TRACE(name);
    const LoadedScenario model = LoadScenario(name, "", ModelSearchPath());
    EXPECT_TRUE(model.report.warnings.empty());
    EXPECT_EQ(model.hand.num_joints(), 16);
    EXPECT_GE(model.hand.FindFinger("thumb"), 0);
    // The way from the preshape to the closed posture leads through a grasp of the ball.
    BallGrasp grasp;
    grasp.q = 0.5 * (model.scenario.q_preshape + model.scenario.q_closed);
    grasp.p_WO = model.scenario.X_WO.translation();
    BallTask task;
    task.weight = 0.08 * model.scenario.gravity_W;
    ASSERT_TRUE(TouchBall(model.hand, task.radius, grasp.p_WO, &grasp.q));
    RateGrasp(model.hand, task, -1e9, &grasp);
    for (double margin : grasp.margin_without) EXPECT_GT(margin, 0.5);
    EXPECT_GT(grasp.room, 0.1);
    EXPECT_GT(grasp.clearance, 0.002);
  }
}

// None of three can leave, so that the search must not look for what two of them hold.
TEST_F(PostureTest, ThreeFingersAreJudgedByWhatTheyHoldTogether) {
  const fs::path file = Write("hand.urdf", RadialHandUrdf(3));
  const HandModel hand = LoadHand(file, GuessHand(file).layout);
  GraspSearch search;
  search.steps = 1500;
  search.starts = 2;
  const std::vector<BallGrasp> found = FindGrasps(hand, search);
  ASSERT_FALSE(found.empty());
  EXPECT_GT(found.front().load_margin, 1.0);
  EXPECT_EQ(found.front().push, 1) << "fingers of three joints press whichever way";
}

// A finger of two joints moves its tip in a plane: it must not touch the ball from beside it.
TEST_F(PostureTest, FingersOfTwoJointsPressAlongTheirNormal) {
  std::string text = RadialHandUrdf(3);
  for (int f = 1; f <= 3; ++f)
    text = Replaced(text, fmt::format("\"arm{}_side\" type=\"revolute\"", f),
                    fmt::format("\"arm{}_side\" type=\"fixed\"", f));
  const fs::path file = Write("hand.urdf", text);
  const HandModel hand = LoadHand(file, GuessHand(file).layout);
  ASSERT_EQ(hand.num_joints(), 6);
  GraspSearch search;
  search.steps = 1500;
  search.starts = 2;
  std::vector<BallGrasp> found = FindGrasps(hand, search);
  ASSERT_FALSE(found.empty());
  EXPECT_GT(found.front().push, 0.7);
  RandomStream random(1, 2);
  EXPECT_EQ(FindWayIn(hand, search.task, found.front(), 4, &random).stuck, -1);
  // The ball beside the fingers' planes: what they can do across their normals tells less.
  BallGrasp beside = found.front();
  beside.p_WO += Vector3d(0.012, 0.012, 0);
  ASSERT_TRUE(TouchBall(hand, search.task.radius, beside.p_WO, &beside.q));
  RateGrasp(hand, search.task, -1e9, &beside);
  EXPECT_LT(beside.push, found.front().push);
}

TEST_F(PostureTest, WhatIsBehindARoundedTipMustBeClearOfTheBall) {
  const fs::path file = Write("hand.urdf", RadialHandUrdf(4));
  const HandModel bare = LoadHand(file, GuessHand(file).layout);
  KinematicsData data;
  ForwardKinematics(bare, JointVector::Zero(bare.num_joints()), &data);
  // A ball that touches the first tip from the side, and is far from all else.
  const Finger& finger = bare.fingers[0];
  const Vector3d p_WF = FingertipCentre(bare, data, 0);
  const Vector3d p_WO = p_WF + (0.02 + finger.tip_radius) * Vector3d::UnitX();
  HandModel thick = bare;
  Shape box;
  box.kind = Shape::Kind::kBox;
  box.half_extents.setConstant(finger.tip_radius + 1e-3);
  box.X_LB.translation() = finger.p_LF;
  thick.links[static_cast<std::size_t>(finger.tip_link)].shapes.push_back(box);
  EXPECT_GT(Clearance(bare, data, p_WO, 0.02), 0);
  EXPECT_NEAR(Clearance(thick, data, p_WO, 0.02), -1e-3, 1e-6) << "the box stands out by 1 mm";
}

}  // namespace
}  // namespace regrasp
