#include "core/common/limit_text.h"

#include <gtest/gtest.h>

#include <numbers>

namespace regrasp {
namespace {

TEST(LimitText, HasNoExponentAndAtMostSixDigitsBehindAWholeNumber) {
  EXPECT_EQ(MostText(0), "0");
  EXPECT_EQ(MostText(-50), "-50");
  EXPECT_EQ(MostText(1e6), "1000000");
  EXPECT_EQ(MostText(-1e9), "-1000000000");
  EXPECT_EQ(LeastText(1234567.5), "1234568");  // six digits would be too few for its whole part
  EXPECT_EQ(MostText(1e-5), "0.00001");
  EXPECT_EQ(MostText(0.001), "0.001");
  EXPECT_EQ(MostText(std::numbers::pi), "3.14159");
  EXPECT_EQ(MostText(-std::numbers::pi / (std::numbers::pi / 180)), "-180");
}

TEST(LimitText, WhatIsWrittenIsAllowed) {
  EXPECT_EQ(MostText(0.5 / (std::numbers::pi / 180)), "28.6478");  // 28.64789
  EXPECT_EQ(MostText(2 * std::numbers::pi), "6.28318");            // 6.283185
  EXPECT_EQ(LeastText(-2 * std::numbers::pi), "-6.28318");
  EXPECT_EQ(LeastText(0.5 / (std::numbers::pi / 180)), "28.6479");
  EXPECT_EQ(LeastText(0.99999996), "1");
  EXPECT_EQ(MostText(-0.99999996), "-1");
}

TEST(LimitText, TheLargestIntegerOfJsonIsAPowerOfTwo) {
  EXPECT_EQ(MostText(9007199254740992.0), "2^53");
  EXPECT_EQ(MostText(9007199254740992.0 - 1e6), "2^53 - 1000000");
  EXPECT_EQ(MostText(9e15), "9000000000000000");
}

}  // namespace
}  // namespace regrasp
