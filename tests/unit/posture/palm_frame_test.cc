/// How the palm lies of hands whose limits do not tell it as usual, and robots with two hands.

#include "tests/unit/posture/posture_fixture.h"

namespace regrasp {
namespace {

struct Row {
  Vector3d turn = Vector3d::Zero();  ///< rpy of the whole hand in its file
  double outer = -1.6, near = -0.2;  ///< lower limits; the upper ones are 1.6
  std::string prefix = "";
};

std::string Link(const std::string& name) {
  return fmt::format(
      R"(<link name="{}"><inertial><origin xyz="0 0 0.015"/><mass value="0.02"/>
<inertia ixx="5e-6" ixy="0" ixz="0" iyy="5e-6" iyz="0" izz="1e-6"/></inertial>
<collision><origin xyz="0 0 0.015"/><geometry><cylinder radius="0.008" length="0.03"/></geometry></collision></link>
)",
      name);
}

std::string Joint(const std::string& parent, const std::string& child, const std::string& xyz,
                  const char* axis, double lower, double upper) {
  return fmt::format(
      R"(<joint name="to_{1}" type="revolute"><parent link="{0}"/><child link="{1}"/><origin xyz="{2}"/>
<axis xyz="{3}"/><limit lower="{4}" upper="{5}" effort="1" velocity="5"/></joint>
)",
      parent, child, xyz, axis, lower, upper);
}

/// Four fingers in a row along y, stretched along z, that bend to +x, and a thumb opposite.
std::string Fingers(const std::string& palm, const Row& row) {
  std::string text;
  for (int f = 0; f < 5; ++f) {
    const bool thumb = f == 4;
    const char* axis = thumb ? "0 -1 0" : "0 1 0";
    const std::string n = fmt::format("{}f{}_", row.prefix, f);
    for (const char* part : {"a", "b", "c", "d"}) text += Link(n + part);
    text += Joint(palm, n + "a", thumb ? "0.04 0 0" : fmt::format("0 {} 0", 0.03 - 0.02 * f),
                  "1 0 0", -0.5, 0.5) +
            Joint(n + "a", n + "b", "0 0 0.01", axis, row.near, 1.6) +
            Joint(n + "b", n + "c", "0 0 0.04", axis, row.outer, 1.6) +
            Joint(n + "c", n + "d", "0 0 0.04", axis, row.outer, 1.6);
  }
  return text;
}

std::string RowHandUrdf(const Row& row) {
  return fmt::format(
             R"(<robot name="row"><link name="root"/><link name="palm"/><joint name="fix" type="fixed">
<parent link="root"/><child link="palm"/><origin rpy="{:.9f} {:.9f} {:.9f}"/></joint>)",
             row.turn[0], row.turn[1], row.turn[2]) +
         Fingers("palm", row) + "</robot>";
}

Matrix3d Turned(const Vector3d& rpy) {
  return (Eigen::AngleAxisd(rpy[2], Vector3d::UnitZ()) *
          Eigen::AngleAxisd(rpy[1], Vector3d::UnitY()) *
          Eigen::AngleAxisd(rpy[0], Vector3d::UnitX()))
      .toRotationMatrix();
}

class PalmTest : public PostureTest {
 protected:
  /// Of the row's own frame in the hand's; `guessed`: whether a note says so.
  Matrix3d Palm(const Row& row, bool* guessed) const {
    const HandGuess guess = GuessHand(Write("row.urdf", RowHandUrdf(row)));
    *guessed = false;
    for (const std::string& note : guess.notes)
      *guessed = *guessed || note.starts_with("palm: its side is guessed");
    return guess.layout.X_HR.linear() * Turned(row.turn);
  }
};

// Published so: the outer joints turn by 90 degrees to either side, only the third from the tip
// tells; or none does, and only the fingers' places are left.
TEST_F(PalmTest, LiesTheSameWhicheverWayTheFileIsTurned) {
  Matrix3d expected;  // z stays, and the palm's side, +x of the row, is -y
  expected << 0, 1, 0, -1, 0, 0, 0, 0, 1;
  for (const double outer : {-0.2, -1.6})
    for (const double near : {-0.2, -1.6})
      for (const Vector3d& turn : {Vector3d(0, 0, 0), Vector3d(0, 0, M_PI / 2),
                                   Vector3d(0, 0, -M_PI / 2), Vector3d(1, 0.4, 2)}) {
        SCOPED_TRACE(fmt::format("{} {} {}", outer, near, turn[2]));
        bool guessed = false;
        const Matrix3d palm = Palm({.turn = turn, .outer = outer, .near = near}, &guessed);
        EXPECT_LT((palm - expected).norm(), 1e-6) << palm;
        EXPECT_EQ(guessed, outer == -1.6 && near == -1.6);
      }
}

// Fingers around a centre have no palm's side; which of equals tells must not hang on rounding.
TEST_F(PalmTest, OfEqualFingersAroundACentreTheFirstTells) {
  for (const double lower : {-0.2, -1.6})
    for (const double turn : {0.0, 1.0, 2.0, 3.0}) {
      const Matrix3d R = Turned({0.3, 0.2, turn});
      std::string text = RadialHandUrdf(3, R);
      for (const auto& [from, to] : {std::pair{"lower=\"-0.3\" upper=\"1.5\"", 1.5},
                                     std::pair{"lower=\"-0.2\" upper=\"1.7\"", 1.7}})
        for (std::size_t at = text.find(from); lower < -1 && at != std::string::npos;
             at = text.find(from))
          text.replace(at, std::string(from).size(),
                       fmt::format("lower=\"{}\" upper=\"{}\"", -to, to));
      const HandGuess guess = GuessHand(Write("radial.urdf", text));
      // The first finger stands at +x and bends to -x.
      EXPECT_LT((guess.layout.X_HR.linear() * R.col(0) - Vector3d::UnitY()).norm(), 1e-6)
          << lower << " " << turn;
    }
}

TEST_F(PalmTest, TwoHandsOnOneRobotAreRefusedWithTheirLinks) {
  std::string arms = "<robot name=\"two\"><link name=\"torso\"/>" + Link("chest") +
                     Joint("torso", "chest", "0 0 0.1", "0 0 1", -1, 1);
  for (const char* side : {"l_", "r_"}) {
    const std::string arm = std::string(side) + "arm", hand = std::string(side) + "hand";
    arms += Link(arm) + Link(hand) + Joint("chest", arm, "0 0.1 0", "0 0 1", -1, 1) +
            Joint(arm, hand, "0 0 0.1", "1 0 0", -1, 1);
  }
  // Two of three fingers, which could be one hand of six; and two of five, too many.
  for (const int count : {3, 5}) {
    std::string text = arms;
    for (const char* side : {"l_", "r_"}) {
      std::string fingers = Fingers(side + std::string("hand"), {.prefix = side});
      const std::size_t end = fingers.find(fmt::format("<link name=\"{}f{}_a\"", side, count));
      text += fingers.substr(0, end);
    }
    const std::string why = WhyNot(Write("two.urdf", text + "</robot>"));
    EXPECT_NE(
        why.find("more than one hand: link \"l_hand\" (fingers end in l_f0_d, l_f1_d, l_f2_d"),
        std::string::npos)
        << why;
    EXPECT_NE(why.find("link \"r_hand\" (fingers end in r_f0_d"), std::string::npos) << why;
    EXPECT_NE(why.find("write a file of one hand: one of these links as its root"),
              std::string::npos)
        << why;
    EXPECT_EQ(why.find("10 chains") != std::string::npos, count == 5) << why;
  }
  // One group is a palm that bends.
  std::string bent = RowHandUrdf({.near = -0.2});
  bent = Replaced(bent, "<parent link=\"palm\"/><child link=\"f3_a\"/>",
                  "<parent link=\"f2_a\"/><child link=\"f3_a\"/>");
  EXPECT_EQ(GuessHand(Write("bent.urdf", bent)).layout.fingers.size(), 5u);
}

TEST_F(PalmTest, TooManyChainsAreNamed) {
  const std::string why = WhyNot(Write("nine.urdf", RadialHandUrdf(9)));
  EXPECT_NE(why.find("they end in arm1c, arm2c, arm3c"), std::string::npos) << why;
  EXPECT_NE(why.find("take out of the file what is not of the hand"), std::string::npos) << why;
}

}  // namespace
}  // namespace regrasp
