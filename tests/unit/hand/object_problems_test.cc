/// What is wrong with an object, all in one list.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/hand/object_loader.h"
#include "tests/unit/hand/model_files.h"

namespace regrasp {
namespace {

class ObjectProblems : public LoaderTest {
 protected:
  std::vector<std::string> Told(bool from_shape = false) const {
    LoadOptions options;
    options.inertia_from_shape = from_shape;
    try {
      LoadObjectFile(root_ / "objects/ball.urdf", options);
    } catch (const ModelError& error) {
      std::vector<std::string> messages = error.problems.Messages();
      for (std::string& message : messages) message.erase(0, (root_ / "objects/").string().size());
      return messages;
    }
    return {};
  }
};

using Lines = std::vector<std::string>;
const std::string
    kSphere = "<sphere radius=\"0.025\"/>",
    kMass = "<mass value=\"0.08\"/>",
    kInertia = "<inertia ixx=\"2e-5\" ixy=\"0\" ixz=\"0\" iyy=\"2e-5\" iyz=\"0\" izz=\"2e-5\"/>";

TEST_F(ObjectProblems, AreToldInOneList) {
  Write("objects/ball.toml", "friction = 7\n");
  Write("objects/ball.urdf",
        Replaced(Replaced(Replaced(kBallUrdf, kSphere, "<mesh filename=\"gone.obj\"/>"), kMass,
                          "<mass value=\"-1\"/>"),
                 "ixx=\"2e-5\"", "ixx=\"2\""));
  const Lines told = Told();
  ASSERT_EQ(told.size(), 4u);
  EXPECT_EQ(told[0], "ball.toml:1: friction = 7; allowed 0.001 .. 1");
  EXPECT_EQ(told[1], "ball.urdf:2: link \"object\": <mass> = -1; must be > 0");
  EXPECT_TRUE(
      told[2].starts_with("ball.urdf:2: link \"object\": <inertia> has the principal moments"))
      << told[2];
  EXPECT_TRUE(told[3].starts_with("ball.urdf:3: link \"object\": ")) << told[3];
  EXPECT_TRUE(told[3].ends_with("gone.obj: mesh file not found")) << told[3];
}

TEST_F(ObjectProblems, MomentsThatAreFarTooSmallAreToldOnly) {
  const auto warnings = [&] {
    ModelReport report;
    LoadObjectFile(root_ / "objects/ball.urdf", {}, &report);
    return report.warnings;
  };
  EXPECT_TRUE(warnings().empty());
  std::string tiny = kInertia;
  for (std::size_t at; (at = tiny.find("2e-5")) != std::string::npos;) tiny.replace(at, 4, "1e-9");
  EditBall(kInertia, tiny);
  ASSERT_EQ(warnings().size(), 1u);
  EXPECT_NE(warnings()[0].text.find("1e-09 kg m²; a homogeneous body of this shape and mass has "
                                    "2e-05"),
            std::string::npos)
      << warnings()[0].text;
}

// What the parameter and a saved state take.
TEST_F(ObjectProblems, FrictionAndMassHaveTheRangeOfTheirParameters) {
  LoadOptions force;
  force.force = true;
  for (const double mass : {kLeastObjectMass, kMostObjectMass}) {
    EditBall(kMass, fmt::format("<mass value=\"{}\"/>", mass));
    EXPECT_EQ(LoadObjectFile(root_ / "objects/ball.urdf", force).mass, mass);
  }
  for (const char* mass : {"0.00009", "101"}) {
    EditBall(kMass, fmt::format("<mass value=\"{}\"/>", mass));
    const Lines told = Told();
    ASSERT_EQ(told.size(), 1u);
    EXPECT_TRUE(told[0].ends_with("; allowed 0.0001 .. 100 kg")) << told[0];
    EXPECT_THROW(LoadObjectFile(root_ / "objects/ball.urdf", force), ModelError);
  }
}

// A misspelt flag: what it would have mended is not told.
TEST_F(ObjectProblems, TheUrdfIsNotBlamedForWhatAFlagWouldMend) {
  EditBall(kInertia, "");
  Write("objects/ball.toml", "inertia_from_shap = true\n");
  const Lines told = Told();
  ASSERT_EQ(told.size(), 1u);
  EXPECT_TRUE(told[0].starts_with("ball.toml:1: unknown key \"inertia_from_shap\"")) << told[0];
  Write("objects/ball.toml", "inertia_from_shape = true\n");
  EXPECT_EQ(Told(), Lines{});
}

TEST_F(ObjectProblems, TheShapeGivesTheInertiaButNotTheMass) {
  EditBall(kInertia, "");
  EXPECT_EQ(Told(), Lines{"ball.urdf:2: link \"object\": <inertial> has no <inertia>; "
                          "--inertia-from-shape computes it"});
  EXPECT_EQ(Told(true), Lines{});
  EditBall(kMass, "");
  const Lines no_mass = {"ball.urdf:2: link \"object\": <inertial> has no <mass>"};
  EXPECT_EQ(Told(), no_mass);
  EXPECT_EQ(Told(true), no_mass);
  Write("objects/ball.urdf", Replaced(Replaced(kBallUrdf, kMass, ""), kInertia, ""));
  EXPECT_EQ(Told(), (Lines{no_mass[0],
                           "ball.urdf:2: link \"object\": <inertial> has no "
                           "<inertia>; --inertia-from-shape computes it"}));
  EXPECT_EQ(Told(true), no_mass);
  EditBall("<inertial>" + kMass + kInertia + "</inertial>", "");
  const Lines none = {
      "ball.urdf:1: link \"object\": has no <inertial>; an object needs its <mass>"};
  EXPECT_EQ(Told(), none);
  EXPECT_EQ(Told(true), none);
  // Of a part that is fixed to the first.
  EditBall("</robot>",
           "<link name=\"lid\"><inertial>" + kMass +
               "</inertial></link><joint name=\"fix\" type=\"fixed\"><parent link=\"object\"/>"
               "<child link=\"lid\"/></joint></robot>");
  EXPECT_EQ(Told(), Lines{"ball.urdf:2: link \"object\": <inertial> has no <inertia>; "
                          "--inertia-from-shape computes it"});
  EXPECT_EQ(Told(true), Lines{});
}

// Their sum is not told besides.
TEST_F(ObjectProblems, OfSeveralLinksWithoutMassEachIsTold) {
  Write("objects/ball.urdf",
        Replaced(Replaced(kBallUrdf, kMass, ""), "</robot>",
                 "<link name=\"lid\"><inertial>" + kInertia +
                     "</inertial></link><joint name=\"fix\" type=\"fixed\"><parent "
                     "link=\"object\"/><child link=\"lid\"/></joint></robot>"));
  const Lines told = Told();
  ASSERT_EQ(told.size(), 2u);
  for (const std::string& line : told)
    EXPECT_TRUE(line.ends_with("<inertial> has no <mass>")) << line;
}

}  // namespace
}  // namespace regrasp
