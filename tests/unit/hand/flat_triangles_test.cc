#include "core/hand/flat_triangles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "core/common/random.h"

namespace regrasp {
namespace {

/// A tetrahedron of 40 mm whose edge from corner 0 to corner 1 has further corners, which only one
/// of the two sides knows; the other side has others, or none.
class TwoFaces {
 public:
  explicit TwoFaces(std::uint64_t seed) : random_(seed, 0) {
    mesh_.vertices = {{0, 0, 0}, {0.04, 0, 0}, {0, 0.04, 0}, {0, 0, 0.04}};
    mesh_.triangles = {{0, 3, 2}, {1, 2, 3}};  // and 0 2 1, 0 1 3, which share the edge
  }

  /// Flat triangles close what is between. They are cut at random.
  TriangleMesh Make(int one, int other) {
    const std::vector<int> there = Along(0, 1, one), back = Along(1, 0, other);
    for (std::size_t i = 0; i + 1 < there.size(); ++i)
      mesh_.triangles.emplace_back(there[i], there[i + 1], 3);
    for (std::size_t i = 0; i + 1 < back.size(); ++i)
      mesh_.triangles.emplace_back(back[i], back[i + 1], 2);
    // Each runs the other way round than the triangles above, and once along the whole edge.
    Fill({there.rbegin(), there.rend()});
    Fill({back.rbegin(), back.rend()});
    return mesh_;
  }

 private:
  std::vector<int> Along(int from, int to, int corners) {
    std::vector<double> places;
    for (int i = 0; i < corners; ++i) places.push_back(0.01 + 0.98 * random_.Uniform());
    std::sort(places.begin(), places.end());
    std::vector<int> run = {from};
    for (const double place : places) {
      run.push_back(static_cast<int>(mesh_.vertices.size()));
      mesh_.vertices.push_back((1 - place) * mesh_.vertices[static_cast<std::size_t>(from)] +
                               place * mesh_.vertices[static_cast<std::size_t>(to)]);
    }
    run.push_back(to);
    return run;
  }
  void Fill(const std::vector<int>& run) {
    if (run.size() < 3) return;
    const auto at =
        run.begin() + 1 + static_cast<int>(random_.Uniform() * static_cast<double>(run.size() - 2));
    mesh_.triangles.emplace_back(run.front(), *at, run.back());
    Fill({run.begin(), at + 1});
    Fill({at, run.end()});
  }

  RandomStream random_;
  TriangleMesh mesh_;
};

/// Edges that are not run through once in each sense.
int OpenEdges(const TriangleMesh& mesh) {
  std::map<std::pair<int, int>, int> of;
  for (const auto& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) ++of[{t[k], t[(k + 1) % 3]}];
  int open = 0;
  for (const auto& [edge, count] : of) {
    const auto back = of.find({edge.second, edge.first});
    open += count != 1 || back == of.end() || back->second != 1;
  }
  return open;
}

TEST(FlatTriangles, AreFlippedUntilTheSurfaceIsClosedWithoutThem) {
  int flat = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const int one = 1 + static_cast<int>(seed % 7), other = static_cast<int>(seed % 5);
    TriangleMesh mesh = TwoFaces(seed).Make(one, other);
    ASSERT_EQ(OpenEdges(mesh), 0);
    TriangleMesh dropped = mesh;
    flat += static_cast<int>(
        std::erase_if(dropped.triangles, [&](const auto& t) { return IsFlat(dropped, t); }));
    ASSERT_GT(OpenEdges(dropped), 0);
    const double volume = Volume(mesh);

    CloseMesh("two faces", false, &mesh);
    EXPECT_EQ(OpenEdges(mesh), 0) << "seed " << seed;
    for (const auto& t : mesh.triangles) EXPECT_FALSE(IsFlat(mesh, t)) << "seed " << seed;
    EXPECT_NEAR(Volume(mesh), volume, 1e-9 * volume);
    // Every corner is one of both sides now.
    EXPECT_EQ(mesh.triangles.size(), 4u + 2 * static_cast<std::size_t>(one + other));
  }
  EXPECT_EQ(flat, [] {
    int corners = 0;
    for (int seed = 1; seed <= 200; ++seed) corners += 1 + seed % 7 + seed % 5;
    return corners;
  }());
}

}  // namespace
}  // namespace regrasp
