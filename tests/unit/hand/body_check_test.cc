#include "core/hand/body_check.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace regrasp {
namespace {

constexpr double kMass = 0.02;  // [kg]

/// A palm and links that move, each a capsule of 30 mm and 6 mm radius; link l is on line 10 l of
/// the file, its inertia one below.
class BodyCheck : public ::testing::Test {
 protected:
  BodyCheck() { AddLink("palm", 0); }

  /// With this moment in all axes [kg m²]; 0: without a body.
  void AddLink(const std::string& name, double moment) {
    UrdfLink in;
    in.name = name;
    in.line = 10 * static_cast<int>(file_.links.size());
    Link link;
    link.name = name;
    Shape& shape = link.shapes.emplace_back();
    shape.b_L = Vector3d(0, 0, 0.03);
    shape.radius = 0.006;
    if (moment > 0) {
      in.inertial.emplace();
      in.inertial->inertia_line = in.line + 1;
      in.inertial->mass = link.mass = kMass;
      in.inertial->inertia = link.I_LCom = moment * Matrix3d::Identity();
    }
    file_.links.push_back(in);
    hand_.links.push_back(link);
  }

  /// What is wrong, and what is told.
  std::vector<std::string> Check(bool inertia_from_shape = false) {
    ModelReport report;
    Problems problems("hand.urdf", &report);
    LoadOptions options;
    options.inertia_from_shape = inertia_from_shape;
    CheckBodies(file_, {}, options, &hand_, &problems);
    std::vector<std::string> lines;
    try {
      problems.ThrowIfAny();
    } catch (const ModelError& error) {
      lines.emplace_back(error.what());
    }
    for (const ModelWarning& warning : report.warnings) lines.push_back(warning.Line());
    return lines;
  }

  UrdfFile file_;
  HandModel hand_;
};

TEST_F(BodyCheck, OnlyAMovingLinkNeedsABody) {
  EXPECT_EQ(Check(), std::vector<std::string>{});  // the palm has none
  AddLink("a", 0);
  EXPECT_EQ(Check(), std::vector<std::string>{
                         "hand.urdf:10: link \"a\": has no <inertial>; a link that moves needs "
                         "mass > 0; --inertia-from-shape computes what is missing"});
}

TEST_F(BodyCheck, AMomentOfThreeLinksIsAPlaceholderOfTwoItIsNot) {
  AddLink("a", 1e-6);
  AddLink("b", 1e-6);
  AddLink("other", 2e-6);
  EXPECT_EQ(Check(), std::vector<std::string>{});
  AddLink("c", 1e-6);
  EXPECT_EQ(Check(),
            std::vector<std::string>{"hand.urdf: <inertia> is 1e-06 kg m² in all axes of several "
                                     "links (a, b, c): a placeholder; --inertia-from-shape "
                                     "computes it"});
}

TEST_F(BodyCheck, AMomentAboveThatOfALinksSizeIsTold) {
  AddLink("a", 1e-4);  // m R² is 4e-5 kg m²
  ASSERT_EQ(Check().size(), 1u);
  EXPECT_EQ(Check()[0].find("hand.urdf:11: link \"a\": <inertia> has the moment 0.0001 kg m²"), 0u)
      << Check()[0];
}

TEST_F(BodyCheck, WhenAskedForTheShapeGivesEachSuchBodyAndNoOther) {
  AddLink("none", 0);
  AddLink("large", 1e-4);
  for (const char* name : {"a", "b", "c"}) AddLink(name, 1e-6);
  AddLink("good", 2e-6);
  EXPECT_EQ(Check(true).size(), 5u);
  EXPECT_EQ(hand_.links[0].mass, 0);  // the palm
  EXPECT_GT(hand_.links[1].mass, 0);  // from its volume
  for (std::size_t l = 2; l < 6; ++l) {
    EXPECT_EQ(hand_.links[l].mass, kMass) << hand_.links[l].name;  // kept
    EXPECT_NEAR(hand_.links[l].p_LCom.z(), 0.015, 1e-6) << hand_.links[l].name;
    EXPECT_LT(hand_.links[l].I_LCom(2, 2), hand_.links[l].I_LCom(0, 0)) << hand_.links[l].name;
  }
  EXPECT_EQ(hand_.links[6].I_LCom, 2e-6 * Matrix3d::Identity());
}

}  // namespace
}  // namespace regrasp
