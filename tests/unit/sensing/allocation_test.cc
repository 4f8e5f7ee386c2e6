/// Nothing that a tick reaches may allocate: counts every malloc of this program while it is on.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "core/hand/scenario.h"
#include "core/sensing/sensors.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define REGRASP_SANITIZED 1
#else
#define REGRASP_SANITIZED 0
#endif

namespace {
bool counting = false;
int allocations = 0;
}  // namespace

#if !REGRASP_SANITIZED
extern "C" void* __libc_malloc(std::size_t size);
extern "C" void* malloc(std::size_t size) noexcept {
  if (counting) ++allocations;
  return __libc_malloc(size);
}
#endif

namespace regrasp {
namespace {

TEST(SensorsAndKinematics, AllocateNothing) {
  if (REGRASP_SANITIZED) GTEST_SKIP() << "the sanitizer owns malloc";
  const HandModel hand = LoadScenario("shadow", "sphere", ModelSearchPath()).hand;
  WorldState truth;
  truth.q = truth.qdot = truth.torque = JointVector::Constant(hand.num_joints(), 0.1);
  ObjectContact contact;
  contact.finger = 1;
  contact.link = hand.fingers[1].tip_link;
  contact.force_W = Vector3d(0, 0, -1);
  truth.contacts.push_back(contact);
  Sensors sensors(hand, 1e-3, 1);
  KinematicsData data;
  double sum = 0;

  counting = true;
  void* volatile canary = std::malloc(8);
  const int counted = allocations;  // the counter itself works
  counting = false;
  std::free(canary);
  EXPECT_GE(counted, 1);

  allocations = 0;
  for (const std::string_view preset : NoisePresetNames()) {
    counting = true;
    sensors.SetNoise(*NoisePreset(preset));
    for (int tick = 0; tick < 200; ++tick) {
      sum += sensors.Read(tick, truth).q.sum();
      ForwardKinematics(hand, truth.q, &data);
      for (int f = 0; f < hand.num_fingers(); ++f)
        sum += PointJacobian(hand, data, f, FingertipCentre(hand, data, f)).sum();
      sum += GravityTorque(hand, data, Vector3d(0, 0, -9.81)).sum();
      StateHasher hasher;
      HashFields(sensors, &hasher);
      sum += static_cast<double>(hasher.Digest() & 1);
    }
    counting = false;
    EXPECT_EQ(allocations, 0) << preset;
  }
  EXPECT_TRUE(std::isfinite(sum));
}

}  // namespace
}  // namespace regrasp
