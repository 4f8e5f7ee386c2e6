#include "core/common/finger_set.h"

#include <gtest/gtest.h>

#include <vector>

namespace regrasp {
namespace {

std::vector<int> List(FingerSet set) {
  std::vector<int> fingers;
  for (int finger : set) fingers.push_back(finger);
  return fingers;
}

TEST(FingerSet, AgreesWithAListOfFingersForEverySet) {
  for (std::uint32_t bits = 0; bits < 1u << kMaxFingers; ++bits) {
    FingerSet set;
    std::vector<int> expected;
    for (int i = 0; i < kMaxFingers; ++i) {
      if (!(bits >> i & 1u)) continue;
      expected.push_back(i);
      set.add(i);
    }
    EXPECT_EQ(List(set), expected);
    EXPECT_EQ(set.size(), static_cast<int>(expected.size()));
    EXPECT_EQ(set.empty(), expected.empty());
    EXPECT_EQ(set.bits(), bits);
    for (int i = 0; i < kMaxFingers; ++i) {
      EXPECT_EQ(set.contains(i), (bits >> i & 1u) == 1);
      EXPECT_FALSE(set.without(i).contains(i));
      EXPECT_EQ(set.without(i).with(i), set.with(i));
      EXPECT_EQ(set.with(i).size() - set.without(i).size(), 1);
    }
  }
}

TEST(FingerSet, NoFingerIsInNoSetAndChangesNone) {
  for (const FingerSet set : {FingerSet(), FingerSet{0}, FingerSet{2, 4}, FingerSet::First(8)}) {
    EXPECT_FALSE(set.contains(-1));
    EXPECT_EQ(set.with(-1), set);
    EXPECT_EQ(set.without(-1), set);
  }
}

TEST(FingerSet, IsMadeAtCompileTime) {
  static_assert(FingerSet::First(0).empty());
  static_assert(FingerSet::First(3) == FingerSet{0, 1, 2});
  static_assert(FingerSet{1, 3}.without(1) == FingerSet{3});
  static_assert(FingerSet{}.size() == 0);
}

}  // namespace
}  // namespace regrasp
