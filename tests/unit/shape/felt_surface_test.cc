#include "core/shape/felt_surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/common/random.h"

namespace regrasp {
namespace {

using Surface = std::function<void(const Vector3d& direction, Vector3d* p, Vector3d* n)>;

Surface Ellipsoid(const Vector3d& half) {
  return [half](const Vector3d& d, Vector3d* p, Vector3d* n) {
    *p = d / d.cwiseQuotient(half).norm();
    *n = p->cwiseQuotient(half.cwiseProduct(half)).normalized();
  };
}

Surface Box(const Vector3d& half) {
  return [half](const Vector3d& d, Vector3d* p, Vector3d* n) {
    int axis = 0;
    const double stretch = d.cwiseAbs().cwiseQuotient(half).maxCoeff(&axis);
    *p = d / stretch;
    *n = Vector3d::Unit(axis) * (d[axis] < 0 ? -1.0 : 1.0);
  };
}

/// Contacts as a finger leaves them: it stays a while wherever it stands. Noise of the filtered
/// contact, one standard deviation: 0.2 mm and 1 degree.
FeltSurface Felt(const Surface& surface, int places, std::uint64_t seed) {
  FeltSurface felt;
  RandomStream random(seed, 1);
  for (int i = 0; i < places; ++i) {
    Vector3d p, n;
    surface(random.Normal3().normalized(), &p, &n);
    for (int k = 0; k < 30; ++k)
      felt.Add(p + 2e-4 * random.Normal3(), (n + 0.0175 * random.Normal3()).normalized());
  }
  return felt;
}

struct Errors {
  double rms_m = 0, median_normal_rad = 0;
};

/// Over directions within `known` of a felt one.
Errors Compare(const FeltSurface& felt, const Surface& surface, double known) {
  RandomStream random(99, 2);
  double square = 0;
  std::vector<double> angles;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d d = random.Normal3().normalized();
    const SurfacePoint point = felt.At(d);
    if (point.unknown > known) continue;
    Vector3d p, n;
    surface(d, &p, &n);
    square += std::pow((point.p_O - p).dot(n), 2);
    angles.push_back(std::acos(std::min(1.0, point.normal_O.dot(n))));
  }
  EXPECT_GT(angles.size(), 100u);
  std::nth_element(angles.begin(), angles.begin() + angles.size() / 2, angles.end());
  return {std::sqrt(square / static_cast<double>(angles.size())), angles[angles.size() / 2]};
}

TEST(FeltSurface, KnowsNothingAtFirst) {
  const FeltSurface felt;
  const SurfacePoint point = felt.At({0, 0, 2});
  EXPECT_EQ(point.p_O, Vector3d(0, 0, ShapeParameters().default_radius));
  EXPECT_EQ(point.normal_O, Vector3d::UnitZ());
  EXPECT_NEAR(point.unknown, M_PI, 1e-12);
  EXPECT_EQ(felt.touched_share(), 0);
}

// Five contacts of a ball whose size nobody told: the radius in any other direction.
TEST(FeltSurface, FiveContactsGiveABallItsRadius) {
  const FeltSurface felt = Felt(Ellipsoid(Vector3d::Constant(0.031)), 5, 3);
  EXPECT_NEAR(felt.mean_radius(), 0.031, 2e-4);  // the noise of one contact
  RandomStream random(5, 1);
  for (int i = 0; i < 200; ++i)
    EXPECT_NEAR(felt.At(random.Normal3()).p_O.norm(), 0.031, 6e-4);  // slopes: 1 deg over 0.4 rad
}

TEST(FeltSurface, FollowsSmoothBodiesAndFlats) {
  const Errors ellipsoid = Compare(Felt(Ellipsoid({0.033, 0.022, 0.022}), 300, 1),
                                   Ellipsoid({0.033, 0.022, 0.022}), 0.1);
  EXPECT_LT(ellipsoid.rms_m, 3e-4);
  EXPECT_LT(ellipsoid.median_normal_rad, 0.052);  // 3 deg
  const Surface cube = Box(Vector3d::Constant(0.02));
  const Errors box = Compare(Felt(cube, 300, 1), cube, 0.1);
  EXPECT_LT(box.rms_m, 5e-4);  // its edges are rounded by a cell's size
  EXPECT_LT(box.median_normal_rad, 0.052);
}

TEST(FeltSurface, BendsAtAnEdgeAndNotOnAFlat) {
  // An edge at 35 degrees, in the middle of its cells.
  const Surface box = Box({0.02, 0.014, 0.02});
  const FeltSurface felt = Felt(box, 4000, 2);
  const Vector3d edge(0.02, 0.014, 0.002);
  EXPECT_LT(felt.At({1, 0.05, 0.05}).bend, 0.1);
  EXPECT_GT(felt.At(edge).bend, 0.5);  // half of the normals 90 degrees from the others: 0.77
  EXPECT_NEAR(felt.BendAt(edge), felt.At(edge).bend, 1e-9);
}

// The pose is noisy and contacts wander: what was felt long ago gives way to what is felt now.
TEST(FeltSurface, Forgets) {
  FeltSurface felt;
  for (int i = 0; i < 1000; ++i) felt.Add({0, 0, 0.030}, Vector3d::UnitZ());
  for (int i = 0; i < 2 * ShapeParameters().memory; ++i) felt.Add({0, 0, 0.025}, Vector3d::UnitZ());
  EXPECT_NEAR(felt.At(Vector3d::UnitZ()).p_O.z(), 0.025, 0.005 * std::exp(-2) + 1e-4);
}

TEST(FeltSurface, LeavesOutWhatNoStarShapedBodyHas) {
  FeltSurface felt;
  felt.Add({0, 0, 0.025}, -Vector3d::UnitZ());
  felt.Add({0, 0, 1e-5}, Vector3d::UnitZ());
  felt.Add(Vector3d::Constant(std::nan("")), Vector3d::UnitZ());
  EXPECT_EQ(felt.touched_cells(), 0);
}

TEST(FeltSurface, EveryDirectionHasItsCell) {
  for (int i = 0; i < FeltSurface::kCells; ++i)
    EXPECT_EQ(FeltSurface::CellOf(FeltSurface::CellDirection(i)), i);
}

TEST(FeltSurface, HashSeesEverySample) {
  FeltSurface felt = Felt(Box(Vector3d::Constant(0.02)), 3, 2);
  StateHasher before, after;
  HashFields(felt, &before);
  felt.Add({0, 0, 0.0201}, Vector3d::UnitZ());
  HashFields(felt, &after);
  EXPECT_NE(before.Digest(), after.Digest());
}

std::string Saved(const FeltSurface& felt) {
  std::string bytes;
  FieldSaver saver(&bytes);
  FeltSurface copy = felt;
  copy.Fields(saver);
  return bytes;
}

void Load(const std::string& bytes, FeltSurface* felt) {
  FieldLoader loader(bytes, 5);
  felt->Fields(loader);
  loader.Finish();
}

TEST(FeltSurface, ALoadedOneKnowsNothingOfWhatWasFeltBefore) {
  const Surface sphere = Ellipsoid(Vector3d::Constant(0.02));
  const FeltSurface little = Felt(sphere, 3, 1);
  FeltSurface loaded = Felt(Ellipsoid(Vector3d::Constant(0.05)), 60, 2);
  Load(Saved(little), &loaded);
  for (int i = 0; i < FeltSurface::kCells; ++i) ASSERT_EQ(loaded.cell(i), little.cell(i)) << i;
  // Both go on to feel the rest, also where the larger one had been felt.
  FeltSurface fresh;
  Load(Saved(little), &fresh);
  RandomStream random(3, 1);
  for (int k = 0; k < 500; ++k) {
    Vector3d p, n;
    sphere(random.Normal3().normalized(), &p, &n);
    fresh.Add(p, n);
    loaded.Add(p, n);
  }
  EXPECT_EQ(Saved(loaded), Saved(fresh));
}

TEST(FeltSurface, AStateThatNamesACellTwiceIsRefused) {
  FeltSurface felt;
  felt.Add({0.02, 0, 0}, {1, 0, 0});
  felt.Add({0, 0.02, 0}, {0, 1, 0});
  ASSERT_EQ(felt.touched_cells(), 2);
  std::string bytes = Saved(felt);
  // A number of cells of 32 bits, then for each its index, two vectors, a radius and a count.
  constexpr std::size_t kIndex = sizeof(std::int16_t);
  constexpr std::size_t kFirst = sizeof(std::int32_t);
  constexpr std::size_t kEach = kIndex + 7 * sizeof(double) + sizeof(std::int32_t);
  ASSERT_EQ(bytes.size(), kFirst + 2 * kEach + sizeof(double));
  FeltSurface loaded;
  EXPECT_NO_THROW(Load(bytes, &loaded));
  bytes.replace(kFirst + kEach, kIndex, bytes, kFirst, kIndex);
  EXPECT_THROW(Load(bytes, &loaded), StateError);
}

}  // namespace
}  // namespace regrasp
