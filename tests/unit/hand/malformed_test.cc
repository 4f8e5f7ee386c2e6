/// One kind of mistake a row: each is refused with the file, the line where it has one, the value
/// and what is allowed. Several mistakes in one file are told at once.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/unit/hand/model_files.h"

namespace regrasp {
namespace {

using Words = std::vector<std::string>;

struct Row {
  const char *from, *to;
  Words words;
};

class MalformedTest : public LoaderTest {
 protected:
  void ExpectAll(const Words& words) const {
    const std::string said = Refusal();
    for (const std::string& word : words)
      EXPECT_NE(said.find(word), std::string::npos) << word << " not in: " << said;
  }
};

TEST_F(MalformedTest, Hands) {
  const Row rows[] = {
      {"radius=\"0.005\"",
       "radius=\"0,005\"",
       {"mini.urdf:10", "\"0,005\"", "finite number", "point"}},
      {"size=\"0.01 0.01 0.04\"",
       "size=\"${w} 0.01 0.04\"",
       {"mini.urdf:6", "link \"upper\"", "<box> size", "${w}", "xacro"}},
      {"size=\"0.01 0.01 0.04\"",
       "size=\"0.01 0.04\"",
       {"mini.urdf:6", "\"0.01 0.04\"", "3 finite"}},
      {"size=\"0.01 0.01 0.04\"", "size=\"0.01 -0.01 0.04\"", {"mini.urdf:6", "-0.01", "> 0"}},
      {"<box size=\"0.01 0.01 0.04\"/>",
       "<capsule radius=\"0.01\" length=\"0.04\"/>",
       {"mini.urdf:6", "<capsule> is unknown", "sphere, box, cylinder"}},
      {"<box size=\"0.01 0.01 0.04\"/>", "<box/>", {"mini.urdf:6", "<box> size is missing"}},
      {"<geometry><box size=\"0.01 0.01 0.04\"/></geometry>", "", {"mini.urdf:6", "no <geometry>"}},
      {"<box size=\"0.01 0.01 0.04\"/>",
       "<mesh filename=\"a.obj\" scale=\"0.001\"/>",
       {"mini.urdf:6", "scale = \"0.001\"", "3 finite numbers", "0.001 0.001 0.001"}},
      {"<box size=\"0.01 0.01 0.04\"/>",
       "<mesh filename=\"a.obj\" scale=\"1 0 1\"/>",
       {"mini.urdf:6", "scale", "no number may be 0"}},
      {"<box size=\"0.01 0.01 0.04\"/>", "<mesh/>", {"mini.urdf:6", "filename is missing"}},
      {"<box size=\"0.01 0.01 0.04\"/>",
       "<mesh filename=\"http://a/b.obj\"/>",
       {"mini.urdf:6", "http://a/b.obj", "package://"}},
      {"<box size=\"0.01 0.01 0.04\"/>",
       "<mesh filename=\"package://nowhere/b.obj\"/>",
       {"mini.urdf:6", "package://nowhere/b.obj", "$ROS_PACKAGE_PATH"}},
      {"<mass value=\"0.03\"/>", "<mass value=\"-1\"/>", {"mini.urdf:4", "<mass> = -1", "> 0"}},
      {"<mass value=\"0.03\"/>", "<mass/>", {"mini.urdf:4", "<mass> value is missing"}},
      {"<mass value=\"0.03\"/>", "", {"mini.urdf:4", "no <mass>"}},
      {"<mass value=\"0.03\"/>", "<mass value=\"1e999\"/>", {"mini.urdf:4", "1e999", "finite"}},
      {"ixy=\"0\" ", "", {"mini.urdf:5", "<inertia> ixy is missing"}},
      {"ixx=\"4e-6\"", "ixx=\"1e-6kg\"", {"mini.urdf:5", "\"1e-6kg\"", "finite number"}},
      {"ixx=\"4e-6\"", "ixx=\"-4e-6\"", {"mini.urdf:5", "-4e-06", "--inertia-from-shape"}},
      {"izz=\"1e-6\"", "izz=\"1e-5\"", {"mini.urdf:5", "sum of the other two"}},
      {"xyz=\"0 0 0.02\"", "xyz=\"0 0\"", {"mini.urdf:4", "<origin> xyz", "\"0 0\""}},
      {"xyz=\"0 0 0.02\"", "xyz=\"0 0 20\"", {"mini.urdf:4", "20", "-10 .. 10"}},
      {"type=\"revolute\"",
       "type=\"prismatic\"",
       {"mini.urdf:12", "prismatic", "revolute and fixed"}},
      {"type=\"revolute\"",
       "type=\"floating\"",
       {"mini.urdf:12", "floating", "revolute and fixed"}},
      {"type=\"revolute\"", "", {"mini.urdf:12", "joint \"A\"", "type is missing"}},
      {"<parent link=\"palm\"/>",
       "<parent link=\"plam\"/>",
       {"mini.urdf:12", "\"plam\"", "no such link"}},
      {"<parent link=\"palm\"/>", "", {"mini.urdf:12", "<parent> link is missing"}},
      {"<axis xyz=\"2 0 0\"/>", "<axis xyz=\"0 0 0\"/>", {"mini.urdf:13", "must not be zero"}},
      {"<axis xyz=\"2 0 0\"/>", "<axis/>", {"mini.urdf:13", "<axis> xyz is missing"}},
      {"lower=\"0\"", "lower=\"zero\"", {"mini.urdf:13", "lower = \"zero\"", "finite number"}},
      {"lower=\"0\"", "lower=\"2\"", {"mini.urdf:13", "lower = 2", "less than upper = 1.5"}},
      {"lower=\"0\"", "lower=\"-180\"", {"mini.urdf:13", "-180", "-3.14159 .. 3.14159"}},
      {"effort=\"2\" ", "", {"mini.urdf:13", "effort is missing"}},
      {"effort=\"2\"", "effort=\"-2\"", {"mini.urdf:13", "effort [N m] = -2", ">= 0"}},
      {"damping=\"0.05\"", "damping=\"-0.05\"", {"mini.urdf:13", "damping = -0.05", ">= 0"}},
      {"<axis xyz=\"2 0 0\"/>",
       "<axis xyz=\"2 0 0\"/><mimic joint=\"C\"/>",
       {"mini.urdf:12", "<mimic> joint = \"C\"", "no such joint"}},
      {"<axis xyz=\"2 0 0\"/>",
       "<axis xyz=\"2 0 0\"/><mimic joint=\"B\" multiplier=\"0\"/>",
       {"mini.urdf:12", "multiplier = 0", "0.001 .. 100"}},
      {"<link name=\"upper\">", "<link>", {"mini.urdf:3", "<link> name is missing"}},
      {"<link name=\"upper\">", "<link name=\"tip\">", {"mini.urdf:8", "\"tip\" is used twice"}},
      {"</link>\n  <link name=\"tip\">",
       "\n  <link name=\"tip\">",
       {"mini.urdf:3", "not a valid URDF", "<link> is not closed"}},
      {"<robot name", "<model name", {"mini.urdf", "not a valid URDF"}},
      {"\"mini\"", "\"mini", {"mini.urdf:1", "not a valid URDF", "does not end"}},
      {"<link name=\"palm\"/>", "<link name=\"palm&x;\"/>", {"mini.urdf:2", "entity \"&x;\""}},
      {"<robot name",
       "<!DOCTYPE r [<!ENTITY a \"b\">]><robot name",
       {"mini.urdf:1", "internal subset"}},
      {"<robot name", "<!DOCTYPE robot><robot name", {}},
      {"<robot name",
       "<!-- a --><?xml version=\"1.0\"?><robot name",
       {"mini.urdf:1", "before the first"}},
      {"<robot name", "text <robot name", {"mini.urdf:1", "outside of the root"}},
      {"</robot>", "</robot><robot/>", {"mini.urdf:16", "second root"}},
      {"</robot>", "</robot></robot><link/>", {"mini.urdf", "a closing tag too many"}},
      {"</robot>", "</robot>text", {"mini.urdf:16", "outside of the root"}},
      {"</robot>", "<!-- </robot>", {"mini.urdf:16", "a comment does not end"}},
      {"</robot>", "<link name=\"b\"</robot>", {"mini.urdf:16", "not a valid URDF"}},
      {"<link name=\"palm\"/>", "<link name=\"palm\" name=\"p\"/>", {"mini.urdf:2", "given twice"}},
      {"<link name=\"palm\"/>", "<link name=palm/>", {"mini.urdf:2", "no quoted value"}},
      {"<robot name", "<robot version=\"2.0\" name", {"mini.urdf:1", "version = \"2.0\"", "1.0"}},
      {"<origin xyz=\"0 0 0.1\"/>",
       "<origin quat_xyzw=\"0 0 0 1\"/>",
       {"mini.urdf:12", "quat_xyzw", "rpy"}},
      {"type=\"revolute\"", "type=\"screw\"", {"mini.urdf:12", "\"screw\"", "revolute and fixed"}},
      {"<box size=\"0.01 0.01 0.04\"/>",
       "<mesh filename=\"model://nowhere/b.obj\"/>",
       {"mini.urdf:6", "model://nowhere/b.obj", "$GAZEBO_MODEL_PATH"}},
      {"<mass value=\"0.03\"/>",
       "<mass value=\"0.03\"/><mass value=\"0.3\"/>",
       {"mini.urdf:4", "link \"upper\"", "a second <mass>", "allowed is one"}},
      {"<inertia ixx=\"4e-6\"",
       "<inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/><inertia "
       "ixx=\"4e-6\"",
       {"mini.urdf:5", "a second <inertia>"}},
      {"<box size=\"0.01 0.01 0.04\"/>",
       "<box size=\"0.01 0.01 0.04\"/><sphere radius=\"0.01\"/>",
       {"mini.urdf:6", "a second <sphere> in <geometry>"}},
      {"<box size=\"0.01 0.01 0.04\"/></geometry>",
       "<box size=\"0.01 0.01 0.04\"/></geometry><geometry><sphere radius=\"0.01\"/></geometry>",
       {"mini.urdf:6", "a second <geometry> in <collision>"}},
      {"<origin xyz=\"0 0 0.1\"/>",
       "<origin xyz=\"0 0 0.1\" rpy=\"0 90 0\"/>",
       {"mini.urdf:12", "<origin> rpy = 90", "-6.3 .. 6.3 rad"}},
      {"<origin xyz=\"0 0 0.1\"/>",
       "<origin xyz=\"0 0 0.1\" rpy=\"0 0 1e300\"/>",
       {"mini.urdf:12", "1e+300", "-6.3 .. 6.3 rad"}},
      {"<box size=\"0.01 0.01 0.04\"/>",
       "<mesh filename=\"a.obj\" scale=\"nan 1 1\"/>",
       {"mini.urdf:6", "scale = \"nan 1 1\"", "3 finite numbers"}},
      {"<box size=\"0.01 0.01 0.04\"/>",
       "<cylinder radius=\"0.01\" length=\"-0.04\"/>",
       {"mini.urdf:6", "<cylinder> length = -0.04", "> 0"}},
      {"<robot name", "<sdf version=\"1.6\"/><robot name", {"mini.urdf:1", "second root"}},
      {"<parent link=\"palm\"/>",
       "<parent link=\"upper\"/>",
       {"mini.urdf:3", "\"upper\" is not connected to the root"}},
      {"<parent link=\"palm\"/>",
       "<parent link=\"palm\"/><parent link=\"palm\"/>",
       {"mini.urdf:12", "a second <parent> in <joint>"}},
      {"<mass value=\"0.03\"/>", "<mass>0.03</mass>", {"mini.urdf:4", "<mass> value is missing"}},
      {"<mass value=\"0.03\"/>",
       "<mass value=\"0x1p-5\"/>",
       {"mini.urdf:4", "\"0x1p-5\"", "finite number"}},
      {"<link name=\"palm\"/>", "<link name=\"palm\"/>\xff text", {}},
      // What other readers of the format trip over.
      {"size=\"0.01 0.01 0.04\"", "size=\" 0.01\n\t+0.01  4e-2 \"", {}},
      {" velocity=\"10\"", "", {}},
      {"<dynamics damping=\"0.05\"/>", "<dynamics friction=\"0,1\" damping=\"0.05\"/>", {}},
  };
  for (const Row& row : rows) {
    SCOPED_TRACE(std::string(row.from) + " -> " + row.to);
    EditHand(row.from, row.to);
    if (row.words.empty())
      EXPECT_NO_THROW(Load());  // text between elements is nobody's business
    else
      ExpectAll(row.words);
  }
}

TEST_F(MalformedTest, Scenarios) {
  const Row rows[] = {
      {"[q_preshape_deg]",
       "[palm]\nrotation_deg = [0, 90]\n[q_preshape_deg]",
       {"mini.toml:10", "rotation_deg", "3 numbers"}},
      {"[q_preshape_deg]",
       "[palm]\nrotate = [0, 90, 0]\n[q_preshape_deg]",
       {"mini.toml:10", "unknown key \"rotate\"", "rotation_deg"}},
      {"[q_preshape_deg]",
       "[locked_deg]\nC = 0\n[q_preshape_deg]",
       {"mini.toml:10", "no joint \"C\""}},
      {"[q_preshape_deg]",
       "[locked_deg]\nB = 999\n[q_preshape_deg]",
       {"mini.toml:10", "999", "360"}},
      {"[q_preshape_deg]",
       "[coupled.C]\ndriver = \"A\"\n[q_preshape_deg]",
       {"mini.toml:9: coupled: there is no joint \"C\""}},
      {"[q_preshape_deg]", "[coupled.B]\nratio = 2\n[q_preshape_deg]", {"\"driver\" is missing"}},
      {"object = \"ball\"",
       "object = \"ball\"\ninertia_from_shape = 1",
       {"mini.toml:2", "true or false"}},
      {"object = \"ball\"", "object = 7", {"mini.toml:1", "object must be a string"}},
      {"[object_pose]", "object_pose = 3\n[pose]", {"mini.toml:4", "object_pose must be a table"}},
      {"armature_kg_m2 = 1e-4", "", {"\"armature_kg_m2\" is missing"}},
      {"armature_kg_m2 = 1e-4", "armature_kg_m2 = inf", {"mini.toml:3", "inf", "0 .. 0.1"}},
  };
  for (const Row& row : rows) {
    SCOPED_TRACE(std::string(row.from) + " -> " + row.to);
    EditScenario(row.from, row.to);
    ExpectAll(row.words);
  }
  Write("hands/mini.toml", "object = " + std::string(5000, '['));
  ExpectAll({"mini.toml", "nested deeper than 32"});
  std::string key;
  for (int i = 0; i < 300000; ++i) key += "a.";
  for (const std::string& text : {key + "b = 1", "[" + key + "b]", "c = {" + key + "b = 1}",
                                  "c = [\"\"\"\n\"\"\", {" + key + "b = 1}]"}) {
    Write("hands/mini.toml", text);
    ExpectAll({"mini.toml", "nested deeper than 32"});
  }
  Write("hands/mini.toml", std::string("object = \"ball\"\0", 16) + kScenarioToml);
  ExpectAll({"mini.toml", "zero byte"});
}

TEST_F(MalformedTest, TellsAllMistakesOfAFileAtOnce) {
  std::string text = Replaced(kHandUrdf, "size=\"0.01 0.01 0.04\"", "size=\"0,01 0,01 0,04\"");
  text = Replaced(text, "<mass value=\"0.03\"/>", "<mass value=\"x\"/>");
  text = Replaced(text, "<axis xyz=\"2 0 0\"/>", "<axis xyz=\"a b c\"/>");
  Write("hands/mini.urdf", text);
  ExpectAll({"3 errors", "mini.urdf:4", "mini.urdf:6", "mini.urdf:13"});
  text = Replaced(kHandUrdf, "effort=\"2\"", "effort=\"-2\"");
  text = Replaced(text, "lower=\"-0.5\"", "lower=\"5\"");
  Write("hands/mini.urdf", text);
  ExpectAll({"3 errors", "mini.urdf:13", "mini.urdf:15", "effort", "lower [rad] = 5"});
  Write("hands/mini.urdf", kHandUrdf);
  Write("hands/mini.toml", Replaced(Replaced(kScenarioToml, "-9.81", "\"g\""), "1e-4", "1"));
  ExpectAll({"2 errors", "mini.toml:2", "mini.toml:3"});
}

TEST_F(MalformedTest, NothingAfterAZeroByteIsBelieved) {
  std::string text = kHandUrdf;
  text.insert(20, 1, '\0');
  Write("hands/mini.urdf", text);
  ExpectAll({"mini.urdf", "zero byte"});
}

TEST_F(MalformedTest, TextInTwoByteUnitsIsNamed) {
  Write("hands/mini.urdf", std::string("\xff\xfe<\0r\0", 6));
  ExpectAll({"mini.urdf:1", "UTF-16", "UTF-8"});
  Write("hands/mini.urdf", std::string("\xef\xbb\xbf") + kHandUrdf);
  EXPECT_NO_THROW(Load());
}

TEST_F(MalformedTest, ElementsAndAttributesAreCounted) {
  std::string text = "<robot name=\"mini\">";
  for (int i = 0; i < 100001; ++i) text += "<a/>";
  Write("hands/mini.urdf", text + "</robot>");
  ExpectAll({"mini.urdf:1", "more than 100000 elements"});
  text = "<robot name=\"mini\"";
  for (int i = 0; i < 300; ++i) text += " a" + std::to_string(i) + " = '1'\n";
  Write("hands/mini.urdf", text + "/>");
  ExpectAll({"mini.urdf:200", "more than 200 attributes"});
  // A line of "=" in a comment is none.
  Write("hands/mini.urdf",
        "<!-- " + std::string(500, '=') + " it's \"quoted\" -->" + std::string(kHandUrdf));
  EXPECT_NO_THROW(Load());
}

TEST_F(MalformedTest, NamesThatAreNone) {
  const struct {
    const char *name, *why, *shown;
  } cases[] = {{"t&#27;[2Jp", "control character", "\"t[2Jp\""},
               {"t\xe9p", "not UTF-8", "\"t\\xe9p\""},
               {"t\xe2\x80\xaep", "changes the direction", "\"t\\xe2\\x80\\xaep\""}};
  for (const auto& c : cases) {
    SCOPED_TRACE(c.why);
    EditHand("<link name=\"upper\">", "<link name=\"" + std::string(c.name) + "\">");
    ExpectAll({"mini.urdf:3", c.why, c.shown});
    EditHand("<robot name=\"mini\">", "<robot name=\"" + std::string(c.name) + "\">");
    ExpectAll({"mini.urdf:1", c.why, c.shown});
  }
  Write("hands/mini.urdf", kHandUrdf);
  EditScenario("name = \"only\"", "name = \"on\\u001b[2Jly\"");
  ExpectAll({"mini.toml", "on\\x1b[2Jly", "control character"});
}

// What a file holds and a message quotes.
TEST_F(MalformedTest, MessagesMoveNoCursor) {
  EditScenario("armature_kg_m2", "\"a\\u001b[2J\"");
  ExpectAll({"mini.toml:3", "a\\x1b[2J"});
  Write("hands/mini.toml", kScenarioToml);
  EditHand("<robot name=\"mini\">", "<robot name=\"mini\"><a\xe9>");
  ExpectAll({"mini.urdf", "a\\xe9"});
  EXPECT_EQ((ModelWarning{"f", 2, "", "x\x1b"}.Line()), "f:2: x\\x1b");
}

TEST_F(MalformedTest, DeepFilesAreRefusedWithoutRecursion) {
  std::string text;
  for (int i = 0; i < 100000; ++i) text += "<a>";
  Write("hands/mini.urdf", text);
  ExpectAll({"mini.urdf:1", "nested deeper than 64"});
}

}  // namespace
}  // namespace regrasp
