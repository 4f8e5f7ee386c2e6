/// What is wrong with a scenario, all in one list.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/unit/hand/model_files.h"

namespace regrasp {
namespace {

using Words = std::vector<std::string>;

class ScenarioProblems : public LoaderTest {
 protected:
  void ExpectInOrder(const Words& words) const {
    const std::string said = Refusal();
    std::size_t at = 0;
    for (const std::string& word : words) {
      const std::size_t found = said.find(word, at);
      ASSERT_NE(found, std::string::npos) << word << " not in its place in: " << said;
      at = found + word.size();
    }
  }
};

TEST_F(ScenarioProblems, TellsAllMistakesOfAScenarioInTheOrderOfItsLines) {
  const auto spoilt = [](Words edits) {
    std::string text = kScenarioToml;
    for (std::size_t i = 0; i < edits.size(); i += 2) text = Replaced(text, edits[i], edits[i + 1]);
    return text;
  };
  // What stands after the fingers and needs the hand is told with what stands before.
  Write("hands/mini.toml", spoilt({"object =", "objekt =", "-9.81", "\"g\"", "1e-4", "1",  //
                                   "name = ", "lenght_m = 1\nname = ", "B = 20.5", "B = 400",
                                   "A = 60", "A = 60\nC = 1"}));
  ExpectInOrder({"7 errors:\n  ", "mini.toml:1: unknown key \"objekt\"; did you mean 'object'?",
                 "mini.toml:1: key \"object\" is missing",
                 "mini.toml:2: gravity_m_s2 must be a number",
                 "mini.toml:3: armature_kg_m2 = 1; allowed 0 .. 0.1",
                 "mini.toml:7: unknown key \"lenght_m\"; allowed are name, tip_link",
                 "mini.toml:12: q_preshape_deg.B [deg] = 400; allowed -28.6529 .. 85.9487",
                 "mini.toml:15: unknown key \"C\"; allowed are A, B"});
  // The hand's file as well.
  EditHand("effort=\"2\"", "effort=\"-2\"");
  Write("hands/mini.toml", spoilt({"-9.81", "\"g\"", "B = 20.5", "B = 400"}));
  ExpectInOrder({"3 errors:\n  ", "mini.toml:2: ", "mini.toml:11: ", "mini.urdf:13: ", "= -2"});
  Write("hands/mini.urdf", kHandUrdf);
  // No hand can be built: its file still tells what the postures may be, and nothing else is
  // invented.
  Write("hands/mini.toml",
        spoilt({"tip_link = \"tip\"", "tip = \"tip\"", "B = 20.5", "B = 400", "B = 70", "D = 70"}));
  ExpectInOrder(
      {"4 errors:\n  ", "mini.toml:6: key \"tip_link\" is missing",
       "mini.toml:8: unknown key \"tip\"; did you mean 'tip_link'?; allowed are name, tip_link",
       "mini.toml:11: q_preshape_deg.B [deg] = 400; allowed -28.6529 .. 85.9487",
       "mini.toml:14: unknown key \"D\"; allowed are A, B"});
  Write("hands/mini.toml",
        spoilt({"tip_link = \"tip\"", "tip_link = \"tap\"", "B = 20.5", "B = 400"}));
  ExpectInOrder({"2 errors:\n  ",
                 "mini.toml:8: finger \"only\": there is no link \"tap\"; did you mean 'tip'?; "
                 "links are palm, tip, upper",
                 "mini.toml:11: q_preshape_deg.B"});
}

// What it says of links and joints is told with its lines, not with the URDF's.
TEST_F(ScenarioProblems, NamesThatTheUrdfHasNotAreTheScenarios) {
  const auto with = [&](const std::string& more) {
    EditScenario("[q_preshape_deg]", more + "\n[q_preshape_deg]");
  };
  with("[locked_deg]\nBB = 3\nA = 2");
  ExpectInOrder(
      {"mini.toml:10: locked_deg: there is no joint \"BB\"; did you mean 'B'?; joints are "
       "A, B"});
  with("[coupled.B]\ndriver = \"B\"");
  EXPECT_TRUE(Refusal().ends_with(
      "mini.toml:10: coupled.B driver: leads in a ring or to a joint that is not there"))
      << Refusal();
  with("[coupled.B]\ndriver = \"A\"\nratio = 0");
  EXPECT_TRUE(
      Refusal().ends_with("mini.toml:11: coupled.B ratio, with those of what its driver "
                          "follows, = 0; allowed are sizes of 0.001 .. 100"))
      << Refusal();
  // All of them, also those of what is wrong otherwise.
  with("[coupled.Bee]\ndriver = \"Aa\"\nratio = \"x\"");
  ExpectInOrder({"3 errors:\n  ", "mini.toml:9: coupled: there is no joint \"Bee\"; ",
                 "mini.toml:10: coupled.Bee driver: there is no joint \"Aa\"; did you mean 'A'?",
                 "mini.toml:11: ratio must be a number"});
  EditScenario("tip_link = \"tip\"", "tip_link = \"palm\"");
  EXPECT_TRUE(Refusal().ends_with(
      "mini.toml:8: finger \"only\": 0 revolute joints between root and \"palm\", coupled ones not "
      "counted; allowed 1 .. 8"))
      << Refusal();
}

TEST_F(ScenarioProblems, WhatAHandLacksForAMisspeltKeyIsNotToldOfThePostures) {
  const auto moved = [](const std::string& text) {  // A is held, so that no posture names it
    return Replaced(Replaced(text, "A = 10\n", ""), "A = 60\n", "") + "[locked_deg]\nA = 10\n";
  };
  const std::string toml = (root_ / "hands/mini.toml").string();
  Write("hands/mini.toml", moved(kScenarioToml));
  Load();
  Write("hands/mini.toml", Replaced(moved(kScenarioToml), "[locked_deg]", "[lockt_deg]"));
  EXPECT_TRUE(Refusal().starts_with(toml + ":13: unknown key \"lockt_deg\"")) << Refusal();
  EXPECT_EQ(Refusal().find('\n'), std::string::npos) << Refusal();
  EditScenario("[object_pose]", "inertia_from_shape = \"yes\"\n[object_pose]");
  EditHand(
      "<inertial><mass value=\"0.01\"/><inertia ixx=\"2e-6\" ixy=\"0\" ixz=\"0\" iyy=\"2e-6\" "
      "iyz=\"0\" izz=\"1e-6\"/></inertial>",
      "");
  EXPECT_EQ(Refusal(), toml + ":4: inertia_from_shape must be true or false");
}

TEST_F(ScenarioProblems, PosturesAreJudgedAsFarAsTheUrdfCanBeRead) {
  EditScenario("B = 20.5", "B = 400\nC = \"x\"");
  EditHand("effort=\"2\"", "effort=\"x\"");
  ExpectInOrder({"3 errors:\n  ", "mini.toml:11: q_preshape_deg.B [deg] = 400; allowed -360",
                 "mini.toml:12: q_preshape_deg.C [deg] must be a number", "mini.urdf:13: "});
}

TEST_F(ScenarioProblems, AUrdfThatIsNotThereIsToldWithTheRest) {
  const std::string toml = (root_ / "hands/mini.toml").string();
  const auto refusal = [&](const std::string& urdf) {
    EditScenario("[object_pose]", urdf + "\ndamping_nm_s_rad = -5\n[object_pose]");
    return Refusal(toml);
  };
  const std::string damping = ":5: damping_nm_s_rad = -5; allowed";
  for (const auto& [urdf, told] :
       {std::pair{"urdf = \"gone.urdf\"", "urdf = \"gone.urdf\": file not found"},
        std::pair{"urdf = 3", "mini.toml:4: urdf must be"}}) {
    SCOPED_TRACE(urdf);
    const std::string said = refusal(urdf);
    EXPECT_NE(said.find("2 errors:"), std::string::npos) << said;
    EXPECT_NE(said.find(damping), std::string::npos) << said;
    EXPECT_NE(said.find(told), std::string::npos) << said;
  }
  const std::string torn = refusal("urdf = 3\n[object_pose");  // no TOML: its first mistake alone
  EXPECT_EQ(torn.find("errors:"), std::string::npos) << torn;
}

TEST_F(ScenarioProblems, OfAHandThatIsWrongAllOverTheRestIsCountedOnce) {
  std::string links;
  for (int i = 0; i < 60; ++i) links += "<link name=\"l" + std::to_string(i) + "\" /><link/>\n";
  EditHand("</robot>", links + "</robot>");
  const std::string by_itself = Refusal();
  const std::size_t more = std::stoul(by_itself.substr(by_itself.rfind("\n  and ") + 7));
  EXPECT_GE(more, 10u) << by_itself;
  EditScenario("B = 20.5", "B = 400");
  ExpectInOrder({"50 errors:\n  ",
                 "mini.toml:11: ", "mini.urdf:", "\n  and " + std::to_string(more + 1) + " more"});
}

TEST_F(ScenarioProblems, ANameOfSeveralLinesIsToldInOne) {
  for (const char* hand : {"a\n  try: x.toml", "a\n  try: x.urdf", "a\n  try: x"})
    EXPECT_EQ(Refusal(hand).find('\n'), std::string::npos) << Refusal(hand);
}

TEST_F(ScenarioProblems, AMistakeByItselfIsToldInOneLine) {
  EditScenario("1e-4", "1");
  EXPECT_EQ(Refusal(),
            (root_ / "hands/mini.toml").string() + ":3: armature_kg_m2 = 1; allowed 0 .. 0.1");
}

}  // namespace
}  // namespace regrasp
