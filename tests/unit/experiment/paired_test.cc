#include "cli/experiment/paired.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/common/random.h"

namespace regrasp::cli {
namespace {

TEST(McNemarP, IsTwiceTheBinomialTail) {
  // 2 (1 + 12 + 66) / 2^12, as R's binom.test(2, 12).
  EXPECT_NEAR(McNemarP(10, 2), 158.0 / 4096, 1e-12);
  EXPECT_EQ(McNemarP(10, 2), McNemarP(2, 10));
  EXPECT_NEAR(McNemarP(0, 5), 2.0 / 32, 1e-12);
  EXPECT_EQ(McNemarP(7, 7), 1.0);  // twice the half with the middle is more than one
  EXPECT_EQ(McNemarP(0, 0), 1.0);
}

/// Two-sided p by the definition: how many of the 2^n signs give a sum of ranks as extreme.
double EnumeratedP(std::vector<double> d) {
  std::erase(d, 0.0);
  std::vector<double> rank;
  double total = 0, positive = 0;
  for (const double x : d) {
    const auto smaller =
        std::count_if(d.begin(), d.end(), [x](double y) { return std::abs(y) < std::abs(x); });
    const auto equal =
        std::count_if(d.begin(), d.end(), [x](double y) { return std::abs(y) == std::abs(x); });
    rank.push_back(static_cast<double>(smaller) + (static_cast<double>(equal) + 1) / 2);
    total += rank.back();
    positive += x > 0 ? rank.back() : 0;
  }
  const double less = std::min(positive, total - positive);
  std::uint64_t extreme = 0;
  const std::uint64_t all = std::uint64_t{1} << d.size();
  for (std::uint64_t signs = 0; signs < all; ++signs) {
    double sum = 0;
    for (std::size_t i = 0; i < d.size(); ++i) sum += (signs >> i & 1) != 0 ? rank[i] : 0;
    extreme += sum <= less;
  }
  return std::min(1.0, 2.0 * static_cast<double>(extreme) / static_cast<double>(all));
}

TEST(WilcoxonP, AgreesWithPublishedExamples) {
  // Depression scores [Hollander and Wolfe 1973], as R's help of wilcox.test has them: V = 40.
  const std::vector<double> x = {1.83, 0.50, 1.62, 2.48, 1.68, 1.88, 1.55, 3.06, 1.30};
  const std::vector<double> y = {0.878, 0.647, 0.598, 2.05, 1.06, 1.29, 1.06, 3.14, 1.29};
  std::vector<double> difference;
  for (std::size_t i = 0; i < x.size(); ++i) difference.push_back(x[i] - y[i]);
  EXPECT_NEAR(WilcoxonP(difference), 0.0390625, 1e-12);
  // Darwin's maize [Fisher 1935], with a tie.
  EXPECT_NEAR(WilcoxonP({49, -67, 8, 16, 6, 23, 28, 41, 14, 29, 56, 24, 75, 60, -48}),
              0.041259765625, 1e-12);
}

TEST(WilcoxonP, IsExactWithTiesAndZeros) {
  EXPECT_NEAR(WilcoxonP({1, 1, -1, 2, 2, -3, 4, 0, 0, 5, 5}), 0.08203125, 1e-12);
  RandomStream random(7, 0);
  for (int n = 1; n <= 12; ++n) {
    std::vector<double> d;
    // Small integers, so that ties and zeros are common.
    for (int i = 0; i < n; ++i) d.push_back(std::round(2 * random.Normal() + 1));
    EXPECT_NEAR(WilcoxonP(d), EnumeratedP(d), 1e-12) << n;
  }
  EXPECT_EQ(WilcoxonP({0, 0, 0}), 1.0);
  EXPECT_EQ(WilcoxonP({}), 1.0);
}

TEST(WilcoxonP, ApproximatesTheExactOneWhereItTakesOver) {
  // 100 differences are exact, 101 approximated: one more small difference hardly changes p.
  RandomStream random(3, 0);
  std::vector<double> d;
  for (int i = 0; i < 100; ++i) d.push_back(random.Normal() + 0.15);
  const double exact = WilcoxonP(d);
  d.push_back(1e-6);
  EXPECT_NEAR(WilcoxonP(d), exact, 0.02 * exact + 1e-3);
}

TEST(BootstrapInterval, OfZerosAndOnesIsBinomial) {
  // A resample of n values of which k are 1 has a binomial sum: its quantiles are known.
  const int n = 30, k = 12;
  std::vector<double> values(n, 0.0);
  std::fill_n(values.begin(), k, 1.0);
  const double p = static_cast<double>(k) / n;
  const auto quantile = [&](double share) {
    double below = 0;
    for (int s = 0; s <= n; ++s) {
      below += std::exp(std::lgamma(n + 1.0) - std::lgamma(s + 1.0) - std::lgamma(n - s + 1.0) +
                        s * std::log(p) + (n - s) * std::log(1 - p));
      if (below >= share) return static_cast<double>(s) / n;
    }
    return 1.0;
  };
  const Interval interval = *BootstrapInterval(values);
  // One step of 1/n: 10 000 resamples place a quantile to 0.16 %, which may lie at a step's edge.
  EXPECT_NEAR(interval.low, quantile(0.025), 1.0 / n + 1e-12);
  EXPECT_NEAR(interval.high, quantile(0.975), 1.0 / n + 1e-12);
}

TEST(BootstrapInterval, IsTheSameEveryTime) {
  const std::vector<double> values = {0.3, -0.1, 2.5, 0.7, 0.2, 1.1};
  const Interval one = *BootstrapInterval(values), two = *BootstrapInterval(values);
  EXPECT_EQ(one.low, two.low);
  EXPECT_EQ(one.high, two.high);
}

TEST(BootstrapInterval, ThereIsNoneBelowTheSixValuesThatAMedianTakes) {
  for (std::size_t n = 1; n <= 8; ++n) {
    std::vector<double> values;
    for (std::size_t i = 0; i < n; ++i) values.push_back(static_cast<double>(i));
    EXPECT_EQ(BootstrapInterval(values).has_value(), n >= 6) << n;
    EXPECT_EQ(MedianInterval(values).has_value(), n >= 6) << n;
  }
}

TEST(HolmAdjusted, AgreesWithThePublishedProcedure) {
  // As R's p.adjust(c(0.01, 0.02, 0.03, 0.04), "holm").
  const std::vector<double> in_order = HolmAdjusted({0.01, 0.02, 0.03, 0.04});
  const std::vector<double> expected = {0.04, 0.06, 0.06, 0.06};
  const std::vector<double> mixed = HolmAdjusted({0.01, 0.04, 0.03, 0.005});
  const std::vector<double> expected_mixed = {0.03, 0.06, 0.06, 0.02};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(in_order[i], expected[i], 1e-12);
    EXPECT_NEAR(mixed[i], expected_mixed[i], 1e-12);
  }
  EXPECT_EQ(HolmAdjusted({0.7, 0.8}), (std::vector<double>{1.0, 1.0}));
  EXPECT_TRUE(HolmAdjusted({}).empty());
}

TEST(SampleSize, IsTheLeastThatIsEnough) {
  // The textbook's 385 for +-5 % at 50 % is of the normal approximation; Wilson's needs z^2 less.
  EXPECT_EQ(TrialsForShare(0.5, 0.05), 381);
  for (const double share : {0.0, 0.3, 0.5, 0.9, 1.0})
    for (const double precision : {0.02, 0.1}) {
      const int n = TrialsForShare(share, precision);
      const auto half = [&](int trials) {
        const double z2 = 1.959963984540054 * 1.959963984540054;
        return std::sqrt(z2 * (share * (1 - share) / trials + z2 / (4.0 * trials * trials))) /
               (1 + z2 / trials);
      };
      EXPECT_LE(half(n), precision);
      if (n > 1) EXPECT_GT(half(n - 1), precision);
    }
  EXPECT_EQ(TrialsForMean(1.0, 0.5), 16);  // (1.96 / 0.5)^2 = 15.4
  EXPECT_EQ(TrialsForMean(0.01, 0.5), 6);  // fewer have no interval
  EXPECT_EQ(TrialsForMean(0.0, 0.5), std::nullopt);
}

TEST(SampleSize, PairsThatAllAgreeDoNotMakeTwoEnough) {
  // None of n pairs differs: Wilson's interval of their share ends at z^2 / (n + z^2).
  const double z2 = 1.959963984540054 * 1.959963984540054;
  for (const double precision : {0.02, 0.1, 0.3}) {
    const int n = TrialsForDifference(0, precision);
    EXPECT_LE(z2 / (n + z2), precision);
    EXPECT_GT(z2 / (n - 1 + z2), precision);
  }
  EXPECT_EQ(TrialsForDifference(0, 0.1), 35);
  EXPECT_EQ(TrialsForDifference(0.5, 0.1), *TrialsForMean(0.5, 0.1));
}

TEST(MedianInterval, HasThePublishedRanks) {
  // Ranks of the 95 % interval of a median [Conover 1999, table A3 for p = 1/2].
  std::vector<double> values;
  for (int i = 1; i <= 5; ++i) values.push_back(i);
  EXPECT_FALSE(MedianInterval(values).has_value());
  values.push_back(6);
  EXPECT_EQ(MedianInterval(values)->low, 1);
  EXPECT_EQ(MedianInterval(values)->high, 6);
  for (int i = 7; i <= 10; ++i) values.push_back(i);
  EXPECT_EQ(MedianInterval(values)->low, 2);
  EXPECT_EQ(MedianInterval(values)->high, 9);
  for (int i = 11; i <= 20; ++i) values.push_back(i);
  EXPECT_EQ(MedianInterval(values)->low, 6);
  EXPECT_EQ(MedianInterval(values)->high, 15);
}

}  // namespace
}  // namespace regrasp::cli
