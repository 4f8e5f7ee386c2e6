#include "core/common/limit_text.h"

#include <gtest/gtest.h>

#include <numbers>

namespace regrasp {
namespace {

TEST(LimitText, HasNoExponentAndAtMostSixDigitsBehindAWholeNumber) {
  EXPECT_EQ(LimitText(0), "0");
  EXPECT_EQ(LimitText(-50), "-50");
  EXPECT_EQ(LimitText(1e6), "1000000");
  EXPECT_EQ(LimitText(-1e9), "-1000000000");
  EXPECT_EQ(LimitText(1234567.5), "1234568");  // six digits would be too few for its whole part
  EXPECT_EQ(LimitText(1e-5), "0.00001");
  EXPECT_EQ(LimitText(0.001), "0.001");
  EXPECT_EQ(LimitText(std::numbers::pi), "3.14159");
  EXPECT_EQ(LimitText(-std::numbers::pi / (std::numbers::pi / 180)), "-180");
}

TEST(LimitText, TheLargestIntegerOfJsonIsAPowerOfTwo) {
  EXPECT_EQ(LimitText(9007199254740992.0), "2^53");
  EXPECT_EQ(LimitText(9007199254740992.0 - 1e6), "2^53 - 1000000");
  EXPECT_EQ(LimitText(9e15), "9000000000000000");
}

}  // namespace
}  // namespace regrasp
