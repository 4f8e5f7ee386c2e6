#include "core/hand/segment_distance.h"

#include <gtest/gtest.h>

#include "core/common/random.h"
#include "core/hand/finger_reach.h"

namespace regrasp {
namespace {

constexpr std::uint64_t kStream = 9000;

double Between(const SegmentPoints& points) { return (points.on_two - points.on_one).norm(); }

TEST(SegmentDistance, OfSegmentsWhoseDistanceIsKnown) {
  const Vector3d o = Vector3d::Zero(), x = Vector3d::UnitX(), y = Vector3d::UnitY(),
                 z = Vector3d::UnitZ();
  // Crossing at a height of 1.
  SegmentPoints points = ClosestOfSegments(-x, x, z - y, z + y);
  EXPECT_EQ(points.on_one, o);
  EXPECT_EQ(points.on_two, z);
  // End to end, end to middle, point to segment, point to point.
  EXPECT_DOUBLE_EQ(Between(ClosestOfSegments(o, x, 3 * x, 4 * x)), 2.0);
  points = ClosestOfSegments(-x, x, 2 * y, 3 * y);
  EXPECT_EQ(points.on_one, o);
  EXPECT_EQ(points.on_two, 2 * y);
  EXPECT_DOUBLE_EQ(Between(ClosestOfSegments(y, y, -x, x)), 1.0);
  EXPECT_DOUBLE_EQ(Between(ClosestOfSegments(-x, x, y, y)), 1.0);
  EXPECT_DOUBLE_EQ(Between(ClosestOfSegments(y, y, z, z)), std::sqrt(2.0));
  // Parallel, beside each other and apart.
  EXPECT_DOUBLE_EQ(Between(ClosestOfSegments(o, x, y, x + y)), 1.0);
  EXPECT_DOUBLE_EQ(Between(ClosestOfSegments(o, x, y + 2 * x, y + 3 * x)), std::sqrt(2.0));
}

// Of 51 by 51 points of two segments of some 30 mm none is nearer, and the gap of two bones, found
// without branches, is the same up to rounding.
TEST(SegmentDistance, NoOtherPairOfPointsIsNearer) {
  RandomStream random(1, kStream);
  for (int trial = 0; trial < 500; ++trial) {
    const Vector3d a1 = 0.02 * random.Normal3(), b1 = 0.02 * random.Normal3(),
                   a2 = 0.02 * random.Normal3(), b2 = 0.02 * random.Normal3();
    const double distance = Between(ClosestOfSegments(a1, b1, a2, b2));
    for (int i = 0; i <= 50; ++i)
      for (int k = 0; k <= 50; ++k)
        ASSERT_LE(distance, (a1 + i / 50.0 * (b1 - a1) - a2 - k / 50.0 * (b2 - a2)).norm() + 1e-15);
    EXPECT_NEAR(Gap({a1, b1, 0.001}, {a2, b2, 0.002}), distance - 0.003, 1e-12);
  }
}

}  // namespace
}  // namespace regrasp
