#include "core/common/finger_letters.h"

#include <gtest/gtest.h>

namespace regrasp {
namespace {

std::string Letters(const std::vector<std::string>& names) {
  const std::vector<char> letters = FingerLetters(names);
  return {letters.begin(), letters.end()};
}

TEST(FingerLetters, AreInitialsWhereTheseDiffer) {
  EXPECT_EQ(Letters({"first", "middle", "ring", "little", "thumb"}), "FMRLT");
  EXPECT_EQ(Letters({}), "");
}

TEST(FingerLetters, NoTwoAreAlike) {
  EXPECT_EQ(Letters({"finger1", "finger2", "finger3", "thumb"}), "123T");
  EXPECT_EQ(Letters({"finger_a", "Finger_b", "a"}), "RBA");
  EXPECT_EQ(Letters({"", "x", "x", "_"}), "1X23");
}

}  // namespace
}  // namespace regrasp
