/// What a URDF file says and nobody simulates is told, once.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/hand/object_loader.h"
#include "tests/unit/hand/model_files.h"

namespace regrasp {
namespace {

class UrdfUnused : public LoaderTest {
 protected:
  /// The warnings whose text contains `part`, without their directory.
  std::vector<std::string> Of(const ModelReport& report, const std::string& part) const {
    std::vector<std::string> lines;
    for (const ModelWarning& warning : report.warnings)
      if (const std::string line = warning.Line(); line.find(part) != std::string::npos)
        lines.push_back(
            line.substr(line.rfind(root_.string(), 0) == 0 ? root_.string().size() + 1 : 0));
    return lines;
  }
};

using Lines = std::vector<std::string>;

TEST_F(UrdfUnused, FrictionOfPyBulletsContactIsTold) {
  const auto told = [&] {
    ModelReport report;
    EXPECT_EQ(LoadObjectFile(root_ / "objects/ball.urdf", {}, &report).friction, 0.8);
    return Of(report, "<contact>");
  };
  EXPECT_EQ(told(), Lines{});
  EditBall("<inertial>",
           "<contact><lateral_friction value=\"0.3\"/><rolling_friction value=\"0\"/></contact>"
           "<inertial>");
  EXPECT_EQ(told(),
            Lines{"objects/ball.urdf:2: link \"object\": <contact> is not used: lateral_friction = "
                  "\"0.3\", rolling_friction; the friction of every contact is that of the object, "
                  "\"friction\" in the .toml beside its URDF, or 0.8 where it says none"});
}

TEST_F(UrdfUnused, FrictionOfJointsIsToldOnce) {
  const auto told = [&] { return Of(LoaderTest::Load().report, "friction"); };
  EditHand("<dynamics damping=\"0.05\"/>", "<dynamics damping=\"0.05\" friction=\"0.0\"/>");
  EXPECT_EQ(told(), Lines{});
  EditHand("<dynamics damping=\"0.05\"/>", "<dynamics damping=\"0.05\" friction=\"5.0\"/>");
  EXPECT_EQ(told(), Lines{"hands/mini.urdf:13: joint \"A\": <dynamics> friction is not simulated"});
  const std::string both =
      Replaced(Replaced(kHandUrdf, "<dynamics damping=\"0.05\"/>", "<dynamics friction=\"5.0\"/>"),
               "effort=\"1\" velocity=\"10\"/>",
               "effort=\"1\" velocity=\"10\"/><dynamics friction=\".1\"/>");
  Write("hands/mini.urdf", both);
  EXPECT_EQ(told(), Lines{"hands/mini.urdf:13: joint \"A\": <dynamics> friction is not simulated "
                          "(nor of 1 more joint)"});
}

TEST_F(UrdfUnused, SoftLimitsAreToldOnce) {
  const auto told = [&] { return Of(LoaderTest::Load().report, "safety_controller"); };
  EditHand("<dynamics damping=\"0.05\"/>", "<safety_controller k_velocity=\"1\"/>");
  EXPECT_EQ(told(), Lines{});
  EditHand("<dynamics damping=\"0.05\"/>",
           "<safety_controller soft_lower_limit=\"-0.2\" soft_upper_limit=\"0.1\" "
           "k_velocity=\"1\"/>");
  EXPECT_EQ(told(), Lines{"hands/mini.urdf:13: joint \"A\": soft limits of <safety_controller> are "
                          "not simulated: the joint goes as far as its <limit>"});
}

}  // namespace
}  // namespace regrasp
