// The table of measures: each row computes what it says.

#include "core/quality/measures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/unit/quality/grasps.h"

namespace regrasp::test {
namespace {

constexpr double kScale = 0.025;

TEST(Measures, EveryRowIsComplete) {
  std::set<std::string_view> names;
  for (const MeasureInfo& info : kMeasureTable) {
    EXPECT_TRUE(names.insert(info.name).second) << info.name;
    EXPECT_FALSE(info.label.empty()) << info.name;
    EXPECT_FALSE(info.meaning.empty()) << info.name;
    EXPECT_EQ(InfoOf(info.id).name, info.name);
  }
  EXPECT_EQ(kFrameMeasureNames.front(), "min_singular_value");
  EXPECT_FALSE(names.contains("load_margin"));  // needs a weight: not of the contacts alone
}

/// By hand. Six contacts p = +-R e_k: G Gᵀ is the sum of [I, -[n]x; [n]x, I - n nᵀ] over n = +-e_k,
/// torques divided by R: 6 I of forces, 6 I - 2 I = 4 I of torques, nothing between. The hull is
/// that of the frictionless cube (grasps.h).
double ByHand(Measure measure) {
  switch (measure) {
    case Measure::kMinSingularValue:
      return 2;
    case Measure::kSqrtDet:
      return 48 * std::sqrt(6.0);  // of 6³ 4³
    case Measure::kIsotropy:
      return 2 / std::sqrt(6.0);
    case Measure::kEpsilon:
      return 1 / std::sqrt(3.0);
    case Measure::kVolume:
      return 64.0 * 8 / 720;
  }
  return -1;
}

TEST(Measures, EveryRowComputesWhatItIsNamedAfter) {
  const Contacts octahedron =
      OnSphere({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}, kScale, 0.8);
  const Contacts cube = Cube(kScale);
  for (const MeasureInfo& info : kMeasureTable) {
    const bool hull = info.id == Measure::kEpsilon || info.id == Measure::kVolume;
    MeasureInput input(hull ? cube : octahedron, kScale, 8);
    // Singular values are good to 1e-7 of the largest one.
    EXPECT_NEAR(info.compute(input), ByHand(info.id), 1e-6 * ByHand(info.id)) << info.name;
  }
}

}  // namespace
}  // namespace regrasp::test
