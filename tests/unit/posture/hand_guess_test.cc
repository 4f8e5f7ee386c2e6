/// Fingers, palms and damping found for hands that nobody has prepared.

#include "core/hand/kinematics.h"
#include "core/posture/finger_name.h"
#include "tests/unit/posture/posture_fixture.h"

namespace regrasp {
namespace {

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

}  // namespace
}  // namespace regrasp
