#pragma once

/// A hand whose sensors read a grasp that stays the same.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/hand/scenario.h"
#include "core/sensing/sensors.h"

namespace regrasp {

/// Every finger presses once on the object, with a normal of its own.
class SensorsTest : public testing::Test {
 protected:
  SensorsTest() : hand_(LoadScenario("shadow", "sphere", ModelSearchPath()).hand) {
    truth_.q = JointVector::LinSpaced(hand_.num_joints(), 0.1, 0.7);
    truth_.qdot = truth_.torque = JointVector::Zero(hand_.num_joints());
    truth_.p_WO = Vector3d(0.01, -0.06, 0.1);
    truth_.q_WO = FromRotationVector(Vector3d(0.3, -0.2, 0.5));
    ForwardKinematics(hand_, truth_.q, &kinematics_);
    for (int f = 0; f < hand_.num_fingers(); ++f) {
      ObjectContact contact;
      contact.finger = f;
      contact.link = hand_.fingers[f].tip_link;
      contact.normal_W = Vector3d(0.3 * f - 0.5, 0.4, 0.2 * f - 0.7).normalized();
      contact.p_WC =
          FingertipCentre(hand_, kinematics_, f) - hand_.fingers[f].tip_radius * contact.normal_W;
      contact.force_W = -(0.5 + f) * contact.normal_W;
      truth_.contacts.push_back(contact);
    }
  }
  /// Calls `visit` with `count` readings, one per tick.
  void Collect(const NoiseLevels& levels, int count,
               const std::function<void(const SensorReading&)>& visit, std::uint64_t seed = 7) {
    Sensors sensors(hand_, 1e-3, seed);
    sensors.SetNoise(levels);
    for (int tick = 0; tick < count; ++tick) visit(sensors.Read(tick, truth_));
  }

  HandModel hand_;
  WorldState truth_;
  KinematicsData kinematics_;
};

struct Moments {
  double sum = 0, sum2 = 0;
  int n = 0;
  void Add(double x) { sum += x, sum2 += x * x, ++n; }
  double mean() const { return sum / n; }
  double sigma() const { return std::sqrt(sum2 / n - mean() * mean()); }
};

}  // namespace regrasp
