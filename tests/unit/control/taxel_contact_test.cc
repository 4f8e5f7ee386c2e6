#include "core/control/taxel_contact.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/common/random.h"

namespace regrasp {
namespace {

constexpr double kPitch = 6.6e-3, kDegree = M_PI / 180;

/// A rounded tip of 7 mm radius on a capsule of 20 mm, pad towards +y.
TipAxes Tip() {
  TipAxes tip;
  tip.radius = 0.007;
  tip.segment = 0.020;
  return tip;
}

/// An outward normal of an object that touches the rounding on the pad's side.
Vector3d NormalOnPad(RandomStream* random) {
  const double polar = (20 + 60 * random->Uniform()) * kDegree,
               azimuth = 80 * kDegree * (random->Uniform() - 0.5);
  return -Vector3d(std::sin(polar) * std::sin(azimuth), std::sin(polar) * std::cos(azimuth),
                   std::cos(polar));
}

double Angle(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

TEST(TaxelContact, WithinTheCellTheNormalStays) {
  const TaxelContact contact(Tip(), kPitch);
  const auto taxels = MakeTaxels(Tip(), kPitch);
  RandomStream random(3, 0);
  for (int trial = 0; trial < 200; ++trial) {
    const Vector3d normal = NormalOnPad(&random);
    const Taxel& taxel = NearestTaxel(taxels, -Tip().radius * normal);
    EXPECT_EQ(contact.IntoCell(taxel.p_LT, normal), normal) << trial;
  }
}

TEST(TaxelContact, FromOutsideItIsTakenToTheBorderAndNoFarther) {
  const TaxelContact contact(Tip(), kPitch);
  const auto taxels = MakeTaxels(Tip(), kPitch);
  RandomStream random(4, 0);
  int outside = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Vector3d truth = NormalOnPad(&random), believed = NormalOnPad(&random);
    const Taxel& reported = NearestTaxel(taxels, -Tip().radius * truth);
    const Vector3d n = contact.IntoCell(reported.p_LT, believed);
    EXPECT_NEAR(n.norm(), 1, 1e-12);
    EXPECT_EQ(&NearestTaxel(taxels, -Tip().radius * n), &reported) << trial;
    if (&NearestTaxel(taxels, -Tip().radius * believed) == &reported) continue;
    ++outside;
    // Half a degree back towards what was believed lies outside.
    const Vector3d axis = n.cross(believed).normalized();
    const Vector3d back = Eigen::AngleAxisd(0.5 * kDegree, axis) * n;
    EXPECT_NE(&NearestTaxel(taxels, -Tip().radius * back), &reported) << trial;
  }
  EXPECT_GT(outside, 50);
}

// A normal that wanders over the pad, followed from the middle of the first cell by what is told of
// its motion, a fifth too much: the borders it crosses keep it near the truth.
TEST(TaxelContact, BordersCorrectWhatMotionTells) {
  const TaxelContact contact(Tip(), kPitch);
  const auto taxels = MakeTaxels(Tip(), kPitch);
  double followed = 0, by_centre = 0, by_motion = 0;
  Vector3d believed, unbounded, before;
  for (int k = 0; k < 4000; ++k) {
    const double polar = (50 + 28 * std::sin(0.010 * k)) * kDegree,
                 azimuth = 35 * std::sin(0.0171 * k) * kDegree;
    const Vector3d truth = -Vector3d(std::sin(polar) * std::sin(azimuth),
                                     std::sin(polar) * std::cos(azimuth), std::cos(polar));
    const Taxel& taxel = NearestTaxel(taxels, -Tip().radius * truth);
    if (k == 0) believed = unbounded = -taxel.outward_L;
    const Vector3d moved = k == 0 ? Vector3d(Vector3d::Zero()) : Vector3d(1.2 * (truth - before));
    before = truth;
    believed = contact.IntoCell(taxel.p_LT, (believed + moved).normalized());
    unbounded = (unbounded + moved).normalized();
    followed += Angle(believed, truth);
    by_motion += Angle(unbounded, truth);
    by_centre += Angle(-taxel.outward_L, truth);
  }
  EXPECT_LT(followed, 0.6 * by_centre);
  EXPECT_LT(followed, by_motion);
}

}  // namespace
}  // namespace regrasp
