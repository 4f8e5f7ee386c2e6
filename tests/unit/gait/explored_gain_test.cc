#include "core/gait/explored_gain.h"

#include <gtest/gtest.h>

namespace regrasp {
namespace {

TEST(ExploredGain, ExploresUntilItKnowsThatLittleIsGained) {
  ExploredGain gain;
  EXPECT_FALSE(gain.known());
  EXPECT_TRUE(gain.at_least(1.0));
  gain.Add(0.125, 0.25);
  EXPECT_EQ(gain.value(), 0.125);  // the first one counts in full
  gain.Add(-0.375, 0.25);
  EXPECT_EQ(gain.value(), 0);
  EXPECT_TRUE(gain.at_least(0));
  EXPECT_FALSE(gain.at_least(0.01));
}

TEST(ExploredGain, AGainOfTheWholeIsKnown) {
  ExploredGain gain;
  gain.Add(1.0, 0.25);
  EXPECT_TRUE(gain.known());
  EXPECT_FALSE(gain.at_least(1.01));
  gain.Add(0.0, 0.25);
  EXPECT_NEAR(gain.value(), 0.75, 1e-12);
}

}  // namespace
}  // namespace regrasp
