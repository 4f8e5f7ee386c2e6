/// Nothing a tick calls may allocate. This program's operator new and every call of malloc from its
/// own objects (Eigen allocates with it; the linker wraps it) are counted.

#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "core/quality/epsilon.h"
#include "core/quality/load_margin.h"
#include "core/quality/manipulability.h"
#include "core/quality/stability.h"
#include "tests/unit/quality/grasps.h"

namespace {
volatile long g_allocations = 0;  // volatile: the compiler knows that malloc changes no variable
}

extern "C" {
void* __real_malloc(std::size_t size);
void* __wrap_malloc(std::size_t size) {
  g_allocations = g_allocations + 1;
  return __real_malloc(size);
}
}

void* operator new(std::size_t size) {
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace regrasp {
namespace {

using namespace test;

TEST(Allocation, IsCounted) {
  const long before = g_allocations;
  volatile Eigen::Index size = 10;  // known to the compiler, the matrix would be folded away
  const Eigen::MatrixXd large = Eigen::MatrixXd::Ones(size, size);
  void* block = ::operator new(16);  // a direct call: a new-expression may be optimised away
  EXPECT_EQ(g_allocations, before + 2);
  EXPECT_EQ(large.sum(), 100.0);
  ::operator delete(block);
}

TEST(Allocation, HappensInNoQualityMeasureOfATick) {
  RandomStream random(1, 0);
  EpsilonSolver solver;
  const FingerJacobian J = FingerJacobian::Random(3, 5);
  const Vector3d weight(0, 0, -0.785);
  double sum = 0.0;
  for (int i = 0; i < 40; ++i) {
    const Contacts contacts = i == 0 ? Ring(kMaxFingers, 0.025, 0.8) : Random(random, 3 + i % 6);
    const long before = g_allocations;
    sum += Manipulability(J);
    sum += ComputeSingularMeasures(contacts, 0.025).min_singular_value;
    sum += LoadMargin(contacts, weight, 0.025, 4.0);
    sum += LoadMargin(contacts, weight, 0.025) > 0;
    sum += solver.Compute(contacts, 0.025, 8);
    solver.Begin(contacts, 0.025, 8);
    while (!solver.Step(100)) {
    }
    EXPECT_EQ(g_allocations, before);
  }
  EXPECT_GT(sum, 0.0);
}

}  // namespace
}  // namespace regrasp
