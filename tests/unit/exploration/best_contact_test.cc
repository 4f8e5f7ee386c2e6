#include "core/exploration/best_contact.h"

#include <gtest/gtest.h>

namespace regrasp {
namespace {

constexpr double kDt = 1e-3, kFilter_s = 0.01, kGain = 1.01;

void Stay(BestContact* best, double phi, double seconds) {
  for (int k = 0; k < static_cast<int>(seconds / kDt); ++k)
    best->Add(Vector3d(phi, 0, 0), phi, kFilter_s, kGain, kDt);
}

TEST(BestContact, RemembersWherePhiWasHighestAndNotItsPeaks) {
  BestContact best;
  best.Start(Vector3d(1, 0, 0), 1);
  Stay(&best, 2, 0.2);
  best.Add(Vector3d(9, 0, 0), 9, kFilter_s, kGain, kDt);  // one tick
  Stay(&best, 1.5, 0.2);
  EXPECT_LT(best.phi(), 3);
  EXPECT_NEAR(best.p_WC().x(), best.phi(), 1e-9);
  EXPECT_TRUE(best.worth_returning(1.2));
  EXPECT_FALSE(best.worth_returning(2));
}

TEST(RelativeGain, IsOfTheSizeWhateverTheSign) {
  EXPECT_DOUBLE_EQ(RelativeGain(1.5, 1), 0.5);
  EXPECT_DOUBLE_EQ(RelativeGain(0.5, 2), -0.75);
  EXPECT_DOUBLE_EQ(RelativeGain(-0.5, -1), 0.5);
  EXPECT_DOUBLE_EQ(RelativeGain(-3, -2), -0.5);
  EXPECT_DOUBLE_EQ(RelativeGain(1, -1), 2);
  EXPECT_TRUE(std::isfinite(RelativeGain(1, 0)));
  EXPECT_EQ(RelativeGain(1.37, 1.19), 1.37 / 1.19 - 1);  // to the bit
}

TEST(BestContact, CountsTheTimeSinceItsLastGain) {
  BestContact best;
  best.Start(Vector3d::Zero(), 1);
  Stay(&best, 2, 0.3);
  EXPECT_LT(best.no_gain_s(), 0.3);
  EXPECT_GT(best.no_gain_s(), 0.2);  // the low pass was there after some time constants
  Stay(&best, 2.01, 0.3);            // half of what counts as a gain
  EXPECT_GT(best.no_gain_s(), 0.5);
  Stay(&best, 2.03, 0.1);
  EXPECT_LT(best.no_gain_s(), 0.1);
  best.StartWaiting();
  EXPECT_EQ(best.no_gain_s(), 0);
}

TEST(BestContact, GainsAreOfTheSizeOfPhiWhateverItsSign) {
  EXPECT_TRUE(Gains(1.03, 1, 1.02));
  EXPECT_FALSE(Gains(1.01, 1, 1.02));
  EXPECT_TRUE(Gains(-0.97, -1, 1.02));
  EXPECT_FALSE(Gains(-0.99, -1, 1.02));
  EXPECT_FALSE(Gains(-1.01, -1, 1.02));
  EXPECT_FALSE(Gains(0, 0, 1.02));
}

}  // namespace
}  // namespace regrasp
