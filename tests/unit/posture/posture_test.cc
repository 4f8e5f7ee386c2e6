/// Fingers, palms and grasps found for hands that nobody has prepared.

#include <gtest/gtest.h>

#include "core/posture/finger_name.h"
#include "core/posture/grasp_search.h"
#include "core/posture/hand_guess.h"
#include "core/posture/scenario_text.h"
#include "core/posture/way_in.h"
#include "tests/unit/hand/model_files.h"
#include "tests/unit/posture/radial_hand.h"

namespace regrasp {
namespace {

class PostureTest : public testing::Test {
 protected:
  PostureTest() {
    std::string name = (fs::temp_directory_path() / "regrasp_posture_XXXXXX").string();
    directory_ = mkdtemp(name.data());
  }
  ~PostureTest() override { fs::remove_all(directory_); }

  fs::path Write(const std::string& name, const std::string& text) const {
    const fs::path path = directory_ / name;
    std::ofstream(path) << text;
    return path;
  }
  static std::string WhyNot(const fs::path& file) {
    try {
      GuessHand(file);
    } catch (const ModelError& error) {
      return error.what();
    }
    return "";
  }

  fs::path directory_;
};

TEST_F(PostureTest, FindsTheFingersOfHandsWithTwoToEightFingers) {
  for (int n = 2; n <= kMaxFingers; ++n) {
    SCOPED_TRACE(n);
    const HandGuess guess = GuessHand(Write("hand.urdf", RadialHandUrdf(n)));
    ASSERT_EQ(guess.layout.fingers.size(), static_cast<std::size_t>(n));
    EXPECT_EQ(guess.layout.fingers[1].tip_link, "arm2c");
    EXPECT_EQ(guess.layout.fingers[1].name, "finger2");
    EXPECT_TRUE(guess.layout.locked.empty());
    if (n * 3 > kMaxJoints) continue;
    const HandModel hand = LoadHand(directory_ / "hand.urdf", guess.layout);
    EXPECT_EQ(hand.num_joints(), 3 * n);
    EXPECT_EQ(hand.fingers[1].joints.size(), 3u);
  }
  EXPECT_NE(WhyNot(Write("one.urdf", RadialHandUrdf(1))).find("a hand has 2 .. 8"),
            std::string::npos);
  EXPECT_NE(WhyNot(Write("nine.urdf", RadialHandUrdf(9))).find("9 chains"), std::string::npos);
}

TEST_F(PostureTest, TurnsThePalmUprightWhicheverWayTheFileHasIt) {
  for (const Vector3d& turn :
       {Vector3d(0, 0, 0), Vector3d(M_PI / 2, 0, 0), Vector3d(0, -1, 0.4), Vector3d(2, 1, -0.5)}) {
    const Matrix3d R = FromRotationVector(turn).toRotationMatrix();
    const HandGuess guess = GuessHand(Write("hand.urdf", RadialHandUrdf(4, R)));
    const Isometry3d& X_HR = guess.layout.X_HR;
    // Fingers stand along R z, and go to +z of the hand.
    EXPECT_LT((X_HR.linear() * R.col(2) - Vector3d::UnitZ()).norm(), 1e-6);
    EXPECT_NEAR(X_HR.linear().determinant(), 1, 1e-9);
    const HandModel hand = LoadHand(directory_ / "hand.urdf", guess.layout);
    KinematicsData data;
    ForwardKinematics(hand, JointVector::Zero(hand.num_joints()), &data);
    for (int f = 0; f < 4; ++f) EXPECT_GT(FingertipCentre(hand, data, f).z(), 0.08);
  }
}

TEST_F(PostureTest, LocksAWristAndTellsIt) {
  const HandGuess guess =
      GuessHand(Write("hand.urdf", RadialHandUrdf(3, Matrix3d::Identity(), true)));
  ASSERT_EQ(guess.layout.locked.count("W"), 1u);
  EXPECT_NE(guess.notes.front().find("wrist: W"), std::string::npos);
  EXPECT_EQ(LoadHand(directory_ / "hand.urdf", guess.layout).num_joints(), 9);
}

TEST_F(PostureTest, NamesFingersByWhatTheFileCallsThem) {
  std::string text = RadialHandUrdf(5);
  for (const auto& [from, to] :
       {std::pair{"arm1", "Index_"}, std::pair{"arm2", "mf"}, std::pair{"arm3", "RING"},
        std::pair{"arm4", "pinky"}, std::pair{"arm5", "hand_thumb_"}})
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at))
      text.replace(at, 4, to);
  const HandGuess guess = GuessHand(Write("hand.urdf", text));
  std::vector<std::string> names;
  for (const auto& finger : guess.layout.fingers) names.push_back(finger.name);
  EXPECT_EQ(names, (std::vector<std::string>{"first", "middle", "ring", "little", "thumb"}));
}

TEST(FingerName, IsToldByPublishedNames) {
  const std::map<std::string, std::vector<std::string>> names = {
      {"thumb",
       {"THJ5", "thbase", "thhub", "thtip", "thtip_joint", "rh_thmiddle", "th_proximal", "thj0",
        "thumb_temp_base", "thumb_fingertip", "right_hand_Thumb_Opposition", "R_thumb_MCP_joint1",
        "rightThumbTip", "RThumb1"}},
      {"first",
       {"FFJ1", "ffmiddle", "lh_FFtip", "fftip", "if_mcp", "index_middle", "index_tip_head",
        "right_hand_Index_Finger_Distal", "L_index_intermediate", "indexFinger2"}},
      {"middle", {"MFJ4", "mfknuckle", "mf_tip", "middle_tip", "middle_middle"}},
      {"ring", {"RFtip", "rfproximal", "ring_tip_head", "right_hand_ring_spread", "RINGa"}},
      {"little", {"LFJ5", "lfmetacarpal", "right_hand_Pinky", "little_1", "pinkie"}},
      {"", {"three_finger_2",
            "thigh",
            "path",
            "other",
            "width",
            "the_palm",
            "thread",
            "thick",
            "north_link",
            "spring",
            "bearing_2",
            "string",
            "wiring",
            "offset",
            "diff",
            "lfo",
            "iffy",
            "finger",
            "finger_1",
            "fingertip_2",
            "joint_0.0",
            "link_15.0_tip",
            "palm",
            "",
            "_",
            "7"}}};
  for (const auto& [finger, of_it] : names)
    for (const std::string& name : of_it) EXPECT_EQ(FingerNameIn(name), finger) << name;
}

TEST_F(PostureTest, AFingertipOfBoxesIsTheRoundedEndOfTheFarthest) {
  std::string text = RadialHandUrdf(4);
  const std::size_t at = text.find("<collision>", text.find("name=\"arm2c\""));
  const std::size_t end = text.find("</collision>", at) + std::string("</collision>").size();
  const auto box = [](double z, double length) {
    return fmt::format(
        "<collision><origin xyz=\"0 0 {}\"/><geometry><box size=\"0.01 0.01 {}\"/></geometry>"
        "</collision>",
        z, length);
  };
  text.replace(at, end - at, box(0.01, 0.02) + box(0.03, 0.02));
  const fs::path file = Write("hand.urdf", text);
  const HandGuess guess = GuessHand(file);
  ASSERT_EQ(guess.layout.fingers.size(), 4u);
  ModelReport report;
  const HandModel hand = LoadHand(file, guess.layout, {}, &report);
  const Finger& finger = hand.fingers[1];
  // About half as wide as the box, and as far out: 40 mm. The corners pull it out, by less than
  // they stick out of it: (sqrt(2) - 1) 5 mm.
  EXPECT_NEAR(finger.tip_radius, 0.005, 2e-3);
  EXPECT_NEAR(finger.p_LF.z() + finger.tip_radius, 0.04, 2e-3);
  EXPECT_NEAR(finger.p_LF.head<2>().norm(), 0, 1e-4);
  const Link& tip = hand.links[static_cast<std::size_t>(finger.tip_link)];
  ASSERT_EQ(tip.shapes.size(), 2u);
  EXPECT_EQ(tip.shapes[1].kind, Shape::Kind::kBox) << "the nearer one stays";
  // A box's corners are far from any capsule, and that is told.
  ASSERT_EQ(report.fits.size(), 1u);
  EXPECT_GT(report.fits[0].error_m, 1e-3);
  EXPECT_NE(report.warnings.front().text.find("differs from its box"), std::string::npos);
}

TEST_F(PostureTest, SuggestsDampingByTheFingersLengthWhereTheFileLacksIt) {
  // 110 mm from the first joint, 88 mm of them to the farthest shape's middle.
  EXPECT_NEAR(GuessHand(Write("hand.urdf", RadialHandUrdf(4))).layout.damping, 0.05, 1e-12);
  std::string longer = RadialHandUrdf(4);
  for (std::size_t at = longer.find("0 0 0.05\""); at != std::string::npos;
       at = longer.find("0 0 0.05\"", at + 1))
    longer.replace(at, 8, "0 0 0.15");
  const HandGuess guess = GuessHand(Write("long.urdf", longer));
  EXPECT_GT(guess.layout.damping, 0.2);
  EXPECT_EQ(guess.layout.least_damping, 0) << "the file says nothing that could be too little";

  std::string weak = RadialHandUrdf(4);
  const std::string limit = "effort=\"1\" velocity=\"5\"/>";
  for (std::size_t at = weak.find(limit); at != std::string::npos; at = weak.find(limit, at + 1))
    weak.insert(at + limit.size(), "<dynamics damping=\"0.001\"/>");
  HandLayout layout = GuessHand(Write("weak.urdf", weak)).layout;
  EXPECT_EQ(layout.least_damping, layout.damping);
  ModelReport report;
  const HandModel raised = LoadHand(directory_ / "weak.urdf", layout, {}, &report);
  for (const Joint& joint : raised.joints) EXPECT_EQ(joint.damping, layout.damping);
  EXPECT_NE(report.warnings.front().text.find("less than the scenario's least for 12 joints"),
            std::string::npos);
  layout.least_damping = 0;
  EXPECT_EQ(LoadHand(directory_ / "weak.urdf", layout).joints.front().damping, 0.001);
}

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
  Judge(hand, search.task, -1e9, &again);
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
    Judge(model.hand, task, -1e9, &grasp);
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
  Judge(hand, search.task, -1e9, &beside);
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
