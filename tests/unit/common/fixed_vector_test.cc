#include "core/common/fixed_vector.h"

#include <gtest/gtest.h>

#include "core/common/frames.h"

namespace regrasp {
namespace {

TEST(FixedVector, ElementsThatComeBackAreZero) {
  FixedVector<Vector3d, 2> vectors;
  vectors.push_back(Vector3d(1, 2, 3));
  FixedVector<int, 2> numbers;
  numbers.push_back(7);
  vectors.resize(0);
  numbers.resize(0);
  vectors.resize(2);
  numbers.resize(2);
  EXPECT_EQ(vectors[0], Vector3d::Zero());
  EXPECT_EQ(vectors[1], Vector3d::Zero());
  EXPECT_EQ(numbers[0], 0);
}

}  // namespace
}  // namespace regrasp
