/// URDF files as strangers bring them: each is read as it is meant, or refused with what to do.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <tuple>

#include "core/hand/urdf.h"
#include "tests/unit/hand/wild_files.h"

namespace regrasp {
namespace {

// A frame above the object, a lid and a weight, all fixed: 30 g in the middle, 10 g 40 mm away.
TEST_F(WildTest, LinksThatAreFixedToEachOtherAreOneBody) {
  const auto fixed = [](const char* parent, const char* child, const char* xyz) {
    return fmt::format(
        R"(<joint name="to_{1}" type="fixed"><parent link="{0}"/><child link="{1}"/><origin xyz="{2}"/></joint>)",
        parent, child, xyz);
  };
  Write("objects/parts.urdf",
        R"(<robot name="parts"><link name="world"/><link name="body"><inertial><mass value="0.03"/>
<inertia ixx="1e-5" ixy="0" ixz="0" iyy="1e-5" iyz="0" izz="1e-5"/></inertial>
<collision><geometry><box size="0.04 0.04 0.04"/></geometry></collision></link><link name="lid">
<inertial><mass value="0.01"/><inertia ixx="1e-6" ixy="0" ixz="0" iyy="1e-6" iyz="0" izz="1e-6"/></inertial>
<inertial><mass value="7"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
<collision><origin xyz="0 0 0.01"/><geometry><box size="0.04 0.04 0.02"/></geometry></collision></link>)" +
            fixed("world", "body", "0.5 0 0") + fixed("body", "lid", "0 0 0.02") + "</robot>");
  ModelReport report;
  const ObjectModel object = LoadObject((root_ / "objects/parts.urdf").string(), {}, {}, &report);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(
      report.warnings[0].Line().find("parts.urdf:5: link \"lid\": a second <inertial> is not read"),
      std::string::npos)
      << report.warnings[0].Line();
  EXPECT_DOUBLE_EQ(object.mass, 0.04);
  EXPECT_NEAR(ObjectSolid(object).volume, 0.04 * 0.04 * 0.06, 1e-9);
  // About the common centre, 5 mm above the body's.
  EXPECT_NEAR(object.I_OCom(0, 0), 1.1e-5 + 0.03 * 0.005 * 0.005 + 0.01 * 0.015 * 0.015, 1e-12);
  EXPECT_NEAR(object.I_OCom(2, 2), 1.1e-5, 1e-12);
  EXPECT_NEAR(ObjectSolid(object).centre.z(), 0.01 - 0.005, 1e-6);
}

TEST_F(WildTest, OfTwoInertialsTheFirstCountsAndTheOtherIsTold) {
  const LoadedScenario once = LoaderTest::Load();
  EditHand("<mass value=\"0.01\"/><inertia",
           "<mass value=\"0.01\"/><inertia ixx=\"2e-6\" ixy=\"0\" ixz=\"0\" iyy=\"2e-6\" iyz=\"0\" "
           "izz=\"1e-6\"/></inertial><inertial><mass value=\"0.5\"/><inertia");
  const LoadedScenario twice = LoaderTest::Load();
  EXPECT_EQ(twice.hand.links[2].mass, once.hand.links[2].mass);
  ASSERT_EQ(twice.report.warnings.size(), once.report.warnings.size() + 1);
  EXPECT_TRUE(std::ranges::any_of(twice.report.warnings, [](const ModelWarning& warning) {
    return warning.Line().find("mini.urdf:9: link \"tip\": a second <inertial> is not read") !=
           std::string::npos;
  }));
  EditHand("<mass value=\"0.01\"/><inertia",
           "<mass value=\"0.01\"/><inertia ixx=\"2e-6\" ixy=\"0\" ixz=\"0\" iyy=\"2e-6\" iyz=\"0\" "
           "izz=\"1e-6\"/></inertial><inertial><mass value=\"0,5\"/><inertia");
  ExpectRefused({"mini.urdf:9", "link \"tip\"", "\"0,5\"", "finite number"});
}

TEST_F(WildTest, AMomentAboveThatOfALinksSizeIsTold) {
  const auto told = [](const LoadedScenario& loaded) {
    return std::ranges::any_of(loaded.report.warnings, [](const ModelWarning& warning) {
      return warning.Line().find(
                 "mini.urdf:9: link \"tip\": <inertia> has the moment 0.0002 kg m²; "
                 "a body of its size has at most m R² = ") != std::string::npos &&
             warning.text.ends_with("; --inertia-from-shape computes it");
    });
  };
  EXPECT_FALSE(told(LoaderTest::Load()));
  EditHand("<inertia ixx=\"2e-6\" ixy=\"0\" ixz=\"0\" iyy=\"2e-6\"",
           "<inertia ixx=\"2e-4\" ixy=\"0\" ixz=\"0\" iyy=\"2e-4\"");
  EXPECT_TRUE(told(LoaderTest::Load()));
  LoadOptions options;
  options.inertia_from_shape = true;
  const LoadedScenario computed = LoadScenario("mini", "", {root_}, options);
  EXPECT_FALSE(told(computed));
  EXPECT_LT(computed.hand.links[2].I_LCom(0, 0), 2e-5);
}

// A finger of links that all have what an exporter wrote for want of masses.
TEST_F(WildTest, GramsForKilogramsInALinkAreTold) {
  const auto told = [](const LoadedScenario& loaded) {
    return std::ranges::any_of(loaded.report.warnings, [](const ModelWarning& warning) {
      return warning.Line().find("mini.urdf:9: link \"tip\": <mass> = 10 kg in ") !=
                 std::string::npos &&
             warning.text.find("more than 25000 (grams for kilograms") != std::string::npos;
    });
  };
  EXPECT_FALSE(told(LoaderTest::Load()));
  EditHand("<mass value=\"0.01\"/>", "<mass value=\"10\"/>");
  EXPECT_TRUE(told(LoaderTest::Load()));
}

// Nothing of a hand is as long, whatever it is: a line of a finger in millimetres does not pass.
TEST_F(WildTest, MillimetresAreToldOfEveryShapeAndOrigin) {
  const std::pair<const char*, const char*> edits[] = {
      {"radius=\"0.005\"", "radius=\"5\""},
      {"length=\"0.02\"", "length=\"20\""},
      {"size=\"0.01 0.01 0.04\"", "size=\"10 10 40\""},
      {"<collision><geometry><box", "<collision><origin xyz=\"0 0 9\"/><geometry><box"},
      {"<origin xyz=\"0 0 0.04\"/>", "<origin xyz=\"0 0 4\"/>"}};
  for (const auto& [from, to] : edits) {
    SCOPED_TRACE(to);
    EditHand(from, to);
    ExpectRefused({"mini.urdf:", "; allowed are at most ", " m; lengths are in metres"});
  }
}

TEST_F(WildTest, ANegativeMassIsToldOnce) {
  EditHand("<mass value=\"0.01\"/>", "<mass value=\"-0.01\"/>");
  try {
    LoaderTest::Load();
    FAIL() << "was not refused";
  } catch (const ModelError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("<mass> = -0.01; must be > 0"), std::string::npos) << text;
    EXPECT_EQ(text.find("<mass> = 0;"), std::string::npos) << text;
  }
}

TEST_F(WildTest, WhatAnInertialHasNotTheShapeGives) {
  const std::string
      mass = "<mass value=\"0.01\"/>",
      inertia = "<inertia ixx=\"2e-6\" ixy=\"0\" ixz=\"0\" iyy=\"2e-6\" iyz=\"0\" izz=\"1e-6\"/>";
  LoadOptions options;
  options.inertia_from_shape = true;
  EditHand("<inertial>" + mass + inertia + "</inertial>", "");
  const Link none = LoadScenario("mini", "", {root_}, options).hand.links[2];
  for (const auto& [given, told, kept] :
       {std::tuple{mass, "<inertial> has no <inertia>", 0.01},
        std::tuple{inertia, "<inertial> has no <mass>", none.mass},
        std::tuple{std::string(), "<inertial> has no <mass>, no <inertia>", none.mass}}) {
    SCOPED_TRACE(told);
    EditHand(mass + inertia, given);
    const std::string why = std::string("mini.urdf:9: link \"tip\": ") + told;
    ExpectRefused({(why + "; --inertia-from-shape computes what is missing").c_str()});
    const LoadedScenario loaded = LoadScenario("mini", "", {root_}, options);
    EXPECT_DOUBLE_EQ(loaded.hand.links[2].mass, kept);
    EXPECT_TRUE(loaded.hand.links[2].I_LCom.isApprox(none.I_LCom * (kept / none.mass)));
    EXPECT_TRUE(std::ranges::any_of(loaded.report.warnings, [&](const ModelWarning& warning) {
      return warning.Line().find(why + "; ") != std::string::npos;
    }));
  }
  // Of a part that is fixed to a link that moves, too; of the palm nothing is needed.
  const std::string part = "<link name=\"nail\"><inertial>" + mass +
                           "</inertial></link>\n<joint name=\"fix\" type=\"fixed\"><parent "
                           "link=\"{}\"/><child link=\"nail\"/></joint></robot>";
  EditHand("</robot>", fmt::format(fmt::runtime(part), "tip"));
  ExpectRefused({"link \"nail\": <inertial> has no <inertia>; --inertia-from-shape"});
  EXPECT_DOUBLE_EQ(LoadScenario("mini", "", {root_}, options).hand.links[2].mass, 0.02);
  EditHand("</robot>", fmt::format(fmt::runtime(part), "palm"));
  EXPECT_EQ(LoaderTest::Load().hand.links.size(), 3u);
}

TEST_F(WildTest, TheSameMomentInAllAxesOfSeveralLinksIsAPlaceholder) {
  std::string links, joints, parent = "palm";
  for (const char* name : {"a", "b", "tip"}) {
    links += fmt::format(
        R"(<link name="{}"><inertial><mass value="0.02"/><inertia ixx="1e-6" ixy="0" ixz="0" iyy="1e-6" iyz="0" izz="1e-6"/></inertial>
<collision><origin xyz="0 0 0.02"/><geometry><cylinder radius="0.006" length="0.03"/></geometry></collision></link>)",
        name);
    joints += fmt::format(
        R"(<joint name="to_{0}" type="revolute"><parent link="{1}"/><child link="{0}"/><origin xyz="0 0 0.04"/>
<axis xyz="1 0 0"/><limit lower="0" upper="1" effort="1"/><dynamics damping="0.1"/></joint>)",
        name, parent);
    parent = name;
  }
  Write("hands/three.urdf",
        "<robot name=\"three\"><link name=\"palm\"/>" + links + joints + "</robot>");
  HandLayout layout;
  layout.fingers.push_back({"only", "tip"});
  layout.armature = 1e-4;
  const auto load = [&](bool from_shape, ModelReport* report) {
    LoadOptions options;
    options.inertia_from_shape = from_shape;
    return LoadHand(root_ / "hands/three.urdf", layout, options, report);
  };
  ModelReport report;
  EXPECT_DOUBLE_EQ(load(false, &report).links[1].I_LCom(0, 0), 1e-6);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].text.find("<inertia> is 1e-06 kg m² in all axes of several links "
                                         "(a, b, tip): a placeholder; --inertia-from-shape"),
            std::string::npos)
      << report.warnings[0].Line();
  ModelReport computed;
  const HandModel hand = load(true, &computed);
  EXPECT_EQ(computed.warnings.size(), 3u);
  EXPECT_GT(hand.links[1].I_LCom(0, 0), 2e-6);  // m (3 r² + l²) / 12 of the cylinder: 1.7e-6
  EXPECT_DOUBLE_EQ(hand.links[1].mass, 0.02);
}

TEST_F(WildTest, AMeshThatIsNotThereIsTheOnlyMistakeOfItsLink) {
  EditHand("<box size=\"0.01 0.01 0.04\"/>", "<mesh filename=\"gone.stl\"/>");
  try {
    LoaderTest::Load();
    ADD_FAILURE() << "was not refused";
  } catch (const ModelError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("\"gone.stl\": file not found"), std::string::npos) << text;
    EXPECT_EQ(text.find("outside its shapes"), std::string::npos) << text;
    EXPECT_EQ(text.find("errors"), std::string::npos) << text;
  }
}

TEST_F(WildTest, AMeshWhoseNameDiffersByCapitalsIsFound) {
  Write("hands/Upper.OBJ", kTetrahedron);
  EditHand("<box size=\"0.01 0.01 0.04\"/>", "<mesh filename=\"upper.obj\"/>");
  ExpectRefused({"\"upper.obj\": file not found, but ", "Upper.OBJ is there"});
  LoadOptions options;
  options.fill_missing_meshes = true;
  EXPECT_EQ(LoadScenario("mini", "", {root_}, options).report.fits.size(), 1u);
}

TEST_F(WildTest, AMeshWhosePackageIsNotThereCanBeFilled) {
  EditHand("<box size=\"0.01 0.01 0.04\"/>",
           "<mesh filename=\"package://mini_hand/meshes/gone.obj\"/>");
  ExpectRefused({"package://mini_hand/meshes/gone.obj", "not found", "--fill-missing-meshes"});
  LoadOptions options;
  options.fill_missing_meshes = true;
  EXPECT_NO_THROW(LoadScenario("mini", "", {root_}, options));
}

// Published with a slip of the decimal point: the centre of a finger of 50 mm 300 mm away.
TEST_F(WildTest, ACentreOfMassFarOutsideALinkIsRefusedAndComputedWhenAsked) {
  EditHand("<origin xyz=\"0 0 0.02\"/>", "<origin xyz=\"-0.29 0.001 0.17\"/>");
  ExpectRefused({"mini.urdf:5", "link \"upper\"", "centre of mass (-0.29, 0.001, 0.17) m",
                 "mm outside its shapes", "--inertia-from-shape"});
  LoadOptions options;
  options.inertia_from_shape = true;
  const LoadedScenario computed = LoadScenario("mini", "", {root_}, options);
  EXPECT_LT(computed.hand.links[1].p_LCom.norm(), 1e-9);
  EXPECT_DOUBLE_EQ(computed.hand.links[1].mass, 0.03);
  // Somewhat outside is common: motors and plates without a shape.
  EditHand("<origin xyz=\"0 0 0.02\"/>", "<origin xyz=\"0 0 0.05\"/>");
  EXPECT_EQ(LoaderTest::Load().hand.links[1].p_LCom, Vector3d(0, 0, 0.05));
}

TEST_F(WildTest, WhatOtherProgramsAddIsPassedOver) {
  const std::string sphere = "<sphere radius=\"0.02\"/>";
  EXPECT_EQ(Load(sphere,
                 R"(<contact><lateral_friction value="x"/>g</contact><self_collide>1</self_collide>
<visual><geometry><xacro:shape/><mesh filename="${gone}"/></geometry><material name="red"/></visual>)",
                 R"(<material name="red"><color rgba="1 0 0"/></material>
<gazebo reference="object"><mu1>${mu}</mu1></gazebo><gazebo><plugin name="p" filename="lib.so"/></gazebo>
<transmission name="t"><type>x</type></transmission>)")
                .radius,
            0.02);
}

TEST_F(WildTest, XacroThatHasNotBeenRunIsNamed) {
  const std::string sphere = "<sphere radius=\"0.02\"/>";
  std::string refusal = Refusal(sphere, "", "<xacro:property name=\"r\" value=\"1\"/>");
  EXPECT_NE(refusal.find("thing.urdf:1: <xacro:property> in <robot>"), std::string::npos)
      << refusal;
  EXPECT_NE(refusal.find("run xacro over the file first"), std::string::npos) << refusal;
  refusal = Refusal(sphere, "<xacro:ball_inertia m=\"1\"/>");
  EXPECT_NE(refusal.find("<xacro:ball_inertia> in <link>"), std::string::npos) << refusal;
  for (const char* shape :
       {"<sphere radius=\"${r}\"/>", "<mesh filename=\"$(find a_hand)/a.stl\"/>",
        "<mesh filename=\"package://a_hand/${side}.stl\"/>"}) {
    refusal = Refusal(shape);
    EXPECT_NE(refusal.find("run xacro"), std::string::npos) << refusal;
  }
}

TEST_F(WildTest, FilesOfOtherKindsAreNamed) {
  const auto refusal = [&](const std::string& name) {
    Write(name, "");
    try {
      LoadObject((root_ / name).string(), {});
    } catch (const ModelError& error) {
      return std::string(error.what());
    }
    return std::string("taken");
  };
  EXPECT_NE(refusal("objects/a.urdf.xacro").find("xacro FILE.xacro -o FILE.urdf"),
            std::string::npos);
  EXPECT_NE(refusal("objects/a.STL").find("a mesh needs one that names it"), std::string::npos);
  EXPECT_NE(refusal("objects/a.sdf").find("SDF, MJCF and USD are not read"), std::string::npos);
}

}  // namespace
}  // namespace regrasp
