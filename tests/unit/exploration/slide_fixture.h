#pragma once

/// The guided slide, driven by a finger that follows every command at once over the ball of
/// sphere_climb.h, on which phi has one maximum. No physics.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/exploration/guided_slide.h"
#include "core/gait/gait_parameters.h"
#include "core/shape/felt_surface.h"
#include "tests/unit/exploration/sphere_climb.h"

namespace regrasp {

using Phase = GuidedSlide::Phase;
using End = GuidedSlide::End;

/// A point of the ball, `distance` [m] of arc from the maximum.
inline Vector3d StartAt(double distance) {
  const Vector3d n = Top().normalized();
  const Vector3d t = n.cross(Vector3d::UnitX()).normalized();
  return kRadius * (std::cos(distance / kRadius) * n + std::sin(distance / kRadius) * t);
}

/// Three fingers of one joint each, without shapes: the only walls are joint limits, wide here.
inline HandModel ThreeFingers() {
  HandModel hand;
  hand.links.push_back({});
  for (int i = 0; i < 3; ++i) {
    Joint joint;
    joint.parent_link = 0;
    joint.child_link = i + 1;
    joint.lower = -10;
    joint.upper = 10;
    Link link;
    link.parent_joint = i;
    Finger finger;
    finger.joints = {i};
    finger.tip_link = i + 1;
    hand.joints.push_back(joint);
    hand.links.push_back(link);
    hand.fingers.push_back(finger);
  }
  return hand;
}

/// Finger 0 slides; its joint angle is its way along x, 50 mm per rad.
class SlideTest : public ::testing::Test {
 protected:
  SlideTest() {
    parameters_.max_cycles = 4000;
    margins_.without.fill(1.0);
    profile_.explore_s = 10;
    profile_.tries = 1;
    for (int i = 0; i < 3; ++i) {
      FingerEstimate f;
      f.in_contact = f.ever_in_contact = true;
      f.ticks_in_contact = 1000;
      f.force = 1.0;
      f.J = FingerJacobian::Zero(3, 1);
      f.J(0, 0) = kLever;
      estimate_.fingers.push_back(f);
    }
    estimate_.q = JointVector::Zero(3);
    tasks_.resize(3);
    Place(StartAt(4e-3));
    controller_.StartHolding(estimate_, gravity_, control_);
  }

  void Place(const Vector3d& p) {
    FingerEstimate& f = estimate_.fingers[0];
    f.p_WC = f.p_WF = p;
    f.normal_W = p.normalized();
    f.manipulability = Phi(p);
    estimate_.q[0] = (p.x() - StartAt(4e-3).x()) / kLever;
  }
  void Contact(bool touches) {
    FingerEstimate& f = estimate_.fingers[0];
    f.in_contact = touches;
    f.ticks_without_contact = touches ? 0 : f.ticks_without_contact + 1;
  }
  /// One tick of the slide, then the finger does as it is told.
  void Tick() {
    const ControlTick tick{hand_,    estimate_, FingerSet::First(3), margins_, felt_,
                           gravity_, control_,  parameters_,         gait_,    kDt};
    slide_.Update(tick, profile_, guide_, &controller_, &tasks_);
    ++ticks_;
    const FingerTask& task = tasks_[0];
    FingerEstimate& f = estimate_.fingers[0];
    if (task.mode == FingerMode::kHold) f.force = std::min(task.cap, 1.0);
    if (task.mode != FingerMode::kSlide) return;
    f.force = task.force;
    Place(kRadius * (f.p_WC + task.v_W * kDt).normalized());
  }
  /// Until `phase`; false when it does not come.
  bool RunTo(Phase phase, int most = 20000) {
    for (int k = 0; k < most && slide_.phase() != phase && slide_.phase() != Phase::kDone; ++k)
      Tick();
    return slide_.phase() == phase;
  }
  void Start(bool leaves = false) {
    GuidedSlide::Request request;
    request.finger = 0;
    request.seed = 3;
    request.leaves = leaves;
    slide_ = GuidedSlide();
    slide_.Start(request);
  }
  double FromTop() const { return (estimate_.fingers[0].p_WC - Top()).norm(); }

  static constexpr double kLever = 0.05;  // of the joint about z [m/rad]
  HandModel hand_ = ThreeFingers();
  const Vector3d gravity_ = Vector3d(0, 0, -9.81);
  ControlParameters control_;
  ExplorationParameters parameters_;
  const GaitParameters gait_;
  FeltSurface felt_;
  LoadMargins margins_;
  SlideProfile profile_;
  SlideGuide guide_;
  Estimate estimate_;
  HybridController controller_{hand_, kDt};
  FingerTasks tasks_;
  GuidedSlide slide_;
  int ticks_ = 0;
};

}  // namespace regrasp
