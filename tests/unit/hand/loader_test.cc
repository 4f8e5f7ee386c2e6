/// The loaders refuse what is wrong, and say where, what and what is allowed.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>

#include "core/hand/scenario.h"
#include "core/hand/urdf.h"
#include "tests/unit/hand/model_files.h"

namespace regrasp {
namespace {

TEST_F(LoaderTest, ReadsWhatTheFilesSay) {
  const LoadedScenario loaded = Load();
  const HandModel& hand = loaded.hand;
  ASSERT_EQ(hand.num_joints(), 2);
  ASSERT_EQ(hand.links.size(), 3u);
  EXPECT_EQ(hand.name, "mini");
  EXPECT_EQ(hand.links[0].parent_joint, -1);
  EXPECT_EQ(hand.links[1].parent_joint, 0);
  EXPECT_EQ(hand.joints[0].name, "A");
  EXPECT_EQ(hand.joints[0].axis_J, Vector3d::UnitX());  // normalised
  EXPECT_EQ(hand.joints[0].damping, 0.05);
  EXPECT_EQ(hand.joints[1].damping, kDefaultDamping);  // the file says none
  EXPECT_EQ(hand.joints[1].armature, 1e-4);
  EXPECT_EQ(hand.joints[1].lower, -0.5);
  EXPECT_EQ(hand.links[1].shapes.at(0).kind, Shape::Kind::kBox);
  EXPECT_EQ(hand.links[1].shapes[0].half_extents, Vector3d(0.005, 0.005, 0.02));
  ASSERT_EQ(hand.FindFinger("only"), 0);
  EXPECT_EQ(hand.fingers[0].joints, (std::vector<int>{0, 1}));
  // The cylinder's length is the segment's length, and its far end the fingertip.
  EXPECT_LT((hand.fingers[0].p_LF - Vector3d(0, 0, 0.02)).norm(), 1e-15);
  EXPECT_EQ(hand.fingers[0].tip_radius, 0.005);
  EXPECT_DOUBLE_EQ(loaded.scenario.q_preshape[1], 20.5 * M_PI / 180);
  EXPECT_DOUBLE_EQ(loaded.scenario.q_closed[0], 60 * M_PI / 180);
  EXPECT_EQ(loaded.scenario.X_WO.translation(), Vector3d(0, -0.05, 0.1));
  EXPECT_EQ(loaded.object.name, "ball");
  EXPECT_EQ(loaded.object.radius, 0.025);
  EXPECT_EQ(loaded.object.friction, 0.8);
}

TEST_F(LoaderTest, MergesFixedLinksIntoTheirParent) {
  EditHand("</robot>", R"(<link name="pad"><inertial><origin xyz="0 0 0.01"/><mass value="0.01"/>
      <inertia ixx="2e-6" ixy="0" ixz="0" iyy="2e-6" iyz="0" izz="1e-6"/></inertial></link>
    <joint name="F" type="fixed"><parent link="tip"/><child link="pad"/><origin xyz="0 0.02 0" rpy="1.5707963267948966 0 0"/></joint></robot>)");
  EditScenario("tip_link = \"tip\"",
               "tip_link = \"pad\"");  // a frame fixed to the tip names the tip
  const HandModel hand = Load().hand;
  ASSERT_EQ(hand.links.size(), 3u);
  const Link& tip = hand.links[2];
  EXPECT_EQ(hand.fingers[0].tip_link, 2);
  EXPECT_DOUBLE_EQ(tip.mass, 0.02);
  // The pad's centre (0, 0, .01) is turned to -y: (0, .01, 0) in the tip, half way: (0, .005, 0).
  EXPECT_LT((tip.p_LCom - Vector3d(0, 0.005, 0)).norm(), 1e-12);
  // Two points of 10 g, 5 mm from the centre along y: 5e-7 about x and z; the pad's z moment is now
  // about y.
  const Vector3d expected(4e-6 + 5e-7, 2e-6 + 1e-6, 1e-6 + 2e-6 + 5e-7);
  EXPECT_LT((tip.I_LCom - Matrix3d(expected.asDiagonal())).norm(), 1e-15);
}

TEST_F(LoaderTest, AFingertipFeelsWithTheShapesOfItsOwnLink) {
  EditHand(
      "</robot>",
      R"(<link name="pad"><collision><geometry><box size="0.01 0.01 0.01"/></geometry></collision>
      <collision><geometry><sphere radius="0.006"/></geometry></collision></link>
    <joint name="F" type="fixed"><parent link="tip"/><child link="pad"/><origin xyz="0 0 0.03"/></joint></robot>)");
  for (const auto& [tip_link, felt] : {std::pair{"tip", 1}, {"pad", 2}}) {
    EditScenario("tip_link = \"tip\"", std::string("tip_link = \"") + tip_link + "\"");
    const HandModel hand = Load().hand;
    ASSERT_EQ(hand.links[2].shapes.size(), 3u) << tip_link;
    EXPECT_EQ(hand.fingers[0].tip_shapes, felt) << tip_link;
    EXPECT_EQ(hand.links[2].shapes[0].kind, Shape::Kind::kCapsule) << tip_link;
    EXPECT_EQ(hand.links[2].shapes[0].radius, felt == 2 ? 0.006 : 0.005) << tip_link;
  }
}

TEST_F(LoaderTest, RefusesBadHands) {
  struct Case {
    const char *from, *to;
    std::initializer_list<const char*> words;
  };
  const Case cases[] = {
      {"lower=\"0\"",
       "lower=\"1.6\"",
       {"mini.urdf", "joint \"A\"", "1.6", "less than upper = 1.5"}},
      {"upper=\"1.5\"", "upper=\"inf\"", {"mini.urdf"}},
      {"upper=\"1.5\"", "upper=\"90\"", {"joint \"A\"", "upper", "90", "3.14159"}},
      {"effort=\"2\"", "effort=\"-2\"", {"joint \"A\"", "effort", "-2", ">= 0"}},
      {"damping=\"0.05\"", "damping=\"-1\"", {"joint \"A\"", "damping", "-1", ">= 0"}},
      {"xyz=\"2 0 0\"", "xyz=\"0 0 0\"", {"joint \"A\"", "<axis>", "must not be zero"}},
      {"<mass value=\"0.03\"/>",
       "<mass value=\"-0.03\"/>",
       {"link \"upper\"", "<mass>", "-0.03", "> 0"}},
      {"<mass value=\"0.03\"/>", "<mass value=\"0\"/>", {"link \"upper\"", "<mass>", "> 0"}},
      {"ixx=\"4e-6\"", "ixx=\"-4e-6\"", {"link \"upper\"", "<inertia>", "-4e-06", "> 0"}},
      {"ixx=\"4e-6\"",
       "ixx=\"9e-6\"",
       {"link \"upper\"", "<inertia>", "9e-06", "sum of the other two"}},
      {"xyz=\"0 0 0.04\"", "xyz=\"0 0 40\"", {"joint \"B\"", "<origin>", "40", "-10 .. 10"}},
      {"size=\"0.01 0.01 0.04\"", "size=\"0.01 0 0.04\"", {"link \"upper\"", "<box>", "> 0"}},
      {"length=\"0.02\"", "length=\"0\"", {"link \"tip\"", "<cylinder> length", "> 0"}},
      {"<cylinder radius=\"0.005\" length=\"0.02\"/>",
       "<mesh filename=\"tip.stl\"/>",
       {"link \"tip\"", "<mesh>", "tip.stl", "not found", "--fill-missing-meshes"}},
      {"\"A\" type=\"revolute\"",
       "\"A\" type=\"prismatic\"",
       {"joint \"A\"", "revolute and fixed"}},
      {"<axis xyz=\"2 0 0\"/>",
       "<axis xyz=\"2 0 0\"/><mimic joint=\"A\"/>",
       {"joint \"A\"", "<mimic>", "ring"}},
      {"<joint name=\"B\"", "<joint name=\"A\"", {"mini.urdf", "A"}},
      {"<link name=\"tip\">", "<link name=\"upper\">", {"mini.urdf", "upper"}},
      {"<child link=\"tip\"/>", "<child link=\"nail\"/>", {"mini.urdf", "nail"}},
      {"</robot>", "<link name=\"loose\"/></robot>", {"mini.urdf", "root"}},
      {"</robot>",
       "<joint name=\"C\" type=\"fixed\"><parent link=\"palm\"/><child "
       "link=\"tip\"/></joint></robot>",
       {"link \"tip\"", "\"B\"", "\"C\"", "allowed is one"}},
      {"</robot>",
       "<link name=\"x\"/><link name=\"y\"/>"
       "<joint name=\"C\" type=\"fixed\"><parent link=\"x\"/><child link=\"y\"/></joint>"
       "<joint name=\"D\" type=\"fixed\"><parent link=\"y\"/><child link=\"x\"/></joint></robot>",
       {"link \"x\"", "not connected", "palm"}},
      {"<robot name=\"mini\">", "<robot", {"mini.urdf", "not a valid URDF"}},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(std::string(c.from) + " -> " + c.to);
    EditHand(c.from, c.to);
    ExpectRefused(c.words);
  }
}

TEST_F(LoaderTest, RefusesMovingLinksWithoutMass) {
  std::string text = kHandUrdf;
  const std::size_t begin = text.find("<inertial><mass");
  const std::size_t end = text.find("</inertial>", begin) + std::string("</inertial>").size();
  Write("hands/mini.urdf", text.erase(begin, end - begin));
  ExpectRefused({"mini.urdf", "link \"tip\"", "<inertial>"});
}

TEST_F(LoaderTest, RefusesHandsBeyondTheCapacities) {
  std::ostringstream urdf;
  const char* const body =
      "<inertial><mass value=\"0.01\"/><inertia ixx=\"2e-6\" ixy=\"0\" ixz=\"0\" iyy=\"2e-6\" "
      "iyz=\"0\" "
      "izz=\"1e-6\"/></inertial><collision><geometry><sphere "
      "radius=\"0.005\"/></geometry></collision>";
  urdf << "<robot name=\"mini\"><link name=\"l0\"/>";
  for (int i = 1; i <= kMaxJoints + 1; ++i)
    urdf << "<link name=\"l" << i << "\">" << body << "</link><joint name=\"j" << i
         << "\" type=\"revolute\"><parent link=\"l" << i - 1 << "\"/><child link=\"l" << i
         << "\"/><limit lower=\"0\" upper=\"1\" effort=\"1\" velocity=\"1\"/></joint>";
  urdf << "</robot>";
  Write("hands/mini.urdf", urdf.str());
  EditScenario("\"tip\"", "\"l9\"");
  ExpectRefused({"finger \"only\"", "9 revolute joints", "1 .. 8"});
  EditScenario("\"tip\"", "\"l8\"");
  ExpectRefused({"more than 32 revolute joints"});
}

TEST_F(LoaderTest, RefusesBadScenarios) {
  struct Case {
    const char *from, *to;
    std::initializer_list<const char*> words;
  };
  const Case cases[] = {
      {"armature_kg_m2",
       "armatur_kg_m2",
       {"mini.toml:3", "\"armatur_kg_m2\"", "did you mean 'armature_kg_m2'?"}},
      {"position_m", "positon_m", {"mini.toml:5", "did you mean 'position_m'?"}},
      {"tip_link", "tiplink", {"mini.toml:8", "did you mean 'tip_link'?"}},
      {"B = 70", "BB = 70", {"mini.toml:14", "\"BB\"", "did you mean 'B'?"}},
      {"B = 70\n", "", {"mini.toml:12", "\"B\" is missing"}},
      {"A = 60", "A = 86", {"mini.toml:13", "q_closed_deg.A", "86", "85.94"}},
      {"A = 60", "A = nan", {"mini.toml:13", "q_closed_deg.A", "nan"}},
      {"A = 60", "A = \"60\"", {"mini.toml:13", "must be a number"}},
      {"armature_kg_m2 = 1e-4",
       "armature_kg_m2 = -1e-4",
       {"mini.toml:3", "armature_kg_m2", "0 .. 0.1"}},
      {"[0, 0, -9.81]", "[0, -9.81]", {"mini.toml:2", "gravity_m_s2", "3 numbers"}},
      {"[0, 0, -9.81]", "[0, 0, -981]", {"mini.toml:2", "gravity_m_s2", "-100 .. 100"}},
      {"\"tip\"", "\"nail\"", {"mini.toml:8", "finger \"only\"", "\"nail\"", "palm, tip, upper"}},
      {"\"tip\"", "\"palm\"", {"finger \"only\"", "0 revolute joints", "1 .. 8"}},
      {"[q_preshape_deg]",
       "[[finger]]\nname = \"only\"\ntip_link = \"upper\"\n[q_preshape_deg]",
       {"mini.toml:9", "\"only\" is used twice"}},
      {"[q_preshape_deg]",
       "[[finger]]\nname = \"two\"\ntip_link = \"tip\"\n[q_preshape_deg]",
       {"mini.toml:9", "\"tip\" is used twice"}},
      {"object = \"ball\"", "object = \"bal\"", {"\"bal\"", "available are ball"}},
      {"object = \"ball\"", "object = ", {"mini.toml:1", "not valid TOML"}},
      {"[object_pose]", "[object_pose", {"mini.toml:4", "not valid TOML"}},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(std::string(c.from) + " -> " + c.to);
    EditScenario(c.from, c.to);
    ExpectRefused(c.words);
  }
}

TEST_F(LoaderTest, AnswersUnknownNamesWithTheKnownOnes) {
  ExpectRefused({"\"maxi\"", "available are mini"}, "maxi");
  ExpectRefused({"\"mni\"", "; did you mean 'mini'?; available are mini"}, "mni");
  ExpectRefused({"\"cone\"", "available are ball"}, "mini", "cone");
  ExpectRefused({"gone.urdf", "not found"}, "gone.urdf");
  ExpectRefused({"available are mini"}, "../hands/mini");
  ExpectRefused({"available are mini"}, "");
  fs::remove(root_ / "hands/mini.toml");
  ExpectRefused({"mini.toml", "not found"});
}

TEST_F(LoaderTest, TakesFilesOutsideTheSearchPath) {
  const LoadedScenario loaded =
      LoadScenario((root_ / "hands/mini.urdf").string(), (root_ / "objects/ball.urdf").string(),
                   ModelSearchPath());
  EXPECT_EQ(loaded.hand.name, "mini");
  EXPECT_EQ(loaded.object.name, "ball");
}

TEST_F(LoaderTest, SearchesDirectoriesInOrder) {
  const auto path = ModelSearchPath(root_.string());
  ASSERT_GE(path.size(), 2u);
  EXPECT_EQ(path[0], fs::canonical(root_));
  const auto objects = ListObjects(path);
  EXPECT_NE(std::find(objects.begin(), objects.end(), "ball"), objects.end());
  EXPECT_NE(std::find(objects.begin(), objects.end(), "egg"), objects.end());
  EXPECT_TRUE(std::is_sorted(objects.begin(), objects.end()));
  EditBall("radius=\"0.025\"", "radius=\"0.03\"");
  fs::rename(root_ / "objects/ball.urdf", root_ / "objects/sphere.urdf");
  EXPECT_EQ(LoadObject("sphere", path).radius,
            0.03);  // ours hides the one that comes with the program
  EXPECT_THROW(ModelSearchPath((root_ / "none").string()), ModelError);
}

TEST_F(LoaderTest, WhatAHandStandsOnMayBeLargeAndItsPalmMayNot) {
  const std::string box =
      "<collision><geometry><box size=\"3 2 0.1\"/></geometry></collision></link>";
  EditHand("<link name=\"palm\"/>", "<link name=\"palm\">" + box);
  ExpectRefused({"link \"palm\"", "has a length of 3 m", "at most 1 m"});
  const std::string joint =
      "<joint name=\"J\" type=\"fixed\"><parent link=\"{}\"/><child link=\"{}\"/></joint>";
  for (const bool below : {false, true}) {  // a table that carries the palm, or that it carries
    EditHand("<link name=\"palm\"/>", "<link name=\"palm\"/><link name=\"table\">" + box +
                                          fmt::format(fmt::runtime(joint), below ? "palm" : "table",
                                                      below ? "table" : "palm"));
    if (below)
      ExpectRefused({"link \"table\"", "has a length of 3 m", "at most 1 m"});
    else
      EXPECT_EQ(Load().hand.links.front().shapes.size(), 1u);
  }
  // The same as a mesh.
  Write("hands/slab.obj",
        "v 0 0 0\nv 3 0 0\nv 0 2 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  const std::string slab = Replaced(box, "box size=\"3 2 0.1\"", "mesh filename=\"slab.obj\"");
  EditHand("<link name=\"palm\"/>", "<link name=\"palm\"/><link name=\"table\">" + slab +
                                        fmt::format(fmt::runtime(joint), "table", "palm"));
  EXPECT_EQ(Load().hand.links.front().shapes.size(), 1u);
}

}  // namespace
}  // namespace regrasp
