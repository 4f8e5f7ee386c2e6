// The table of measures: each row computes what it says.

#include "core/quality/measures.h"

#include <gtest/gtest.h>

#include <set>

#include "core/quality/epsilon.h"
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

TEST(Measures, EveryRowComputesWhatItIsNamedAfter) {
  const auto contacts = Ring(5, kScale, 0.8);
  MeasureInput input(contacts, kScale, 8);
  const SingularMeasures singular = ComputeSingularMeasures(contacts, kScale);
  EpsilonSolver solver;
  const auto value = [&](Measure measure) { return InfoOf(measure).compute(input); };
  EXPECT_EQ(value(Measure::kMinSingularValue), singular.min_singular_value);
  EXPECT_EQ(value(Measure::kSqrtDet), singular.sqrt_det);
  EXPECT_EQ(value(Measure::kIsotropy), singular.isotropy);
  EXPECT_EQ(value(Measure::kEpsilon), solver.Compute(contacts, kScale, 8));
  EXPECT_EQ(value(Measure::kVolume), WrenchHullVolume(contacts, kScale, 8));
  EXPECT_GT(value(Measure::kVolume), 0);
}

}  // namespace
}  // namespace regrasp::test
