#pragma once

/// A made-up run of a made-up hand, for tests of the pictures: three fingers hold a sphere of 25
/// mm, and the second one ("two") explores in the middle third.

#include <cmath>
#include <string>
#include <vector>

#include "core/hand/hand_model.h"
#include "core/sensing/noise.h"
#include "core/session/frame.h"

namespace regrasp {

inline constexpr double kSyntheticThreshold = 0.4;
inline constexpr int kSyntheticExplorer = 1;

/// Each finger is one link on one joint about y, hanging over the sphere.
inline HandModel SyntheticHand() {
  HandModel hand;
  hand.name = "synthetic";
  Link palm;
  palm.name = "palm";
  Shape box;
  box.kind = Shape::Kind::kBox;
  box.half_extents = {0.04, 0.01, 0.04};
  palm.shapes = {box};
  hand.links = {palm};
  const std::vector<std::string> names = {"one", "two", "three"};
  for (int i = 0; i < 3; ++i) {
    Joint joint;
    joint.name = names[i] + "_joint";
    joint.parent_link = 0;
    joint.child_link = i + 1;
    joint.X_PJ.translation() = Vector3d(0.03 * (i - 1), 0, 0.05);
    joint.lower = -1;
    joint.upper = 1;
    hand.joints.push_back(joint);
    Link link;
    link.name = names[i] + "_link";
    link.parent_joint = i;
    Shape capsule;
    capsule.b_L = {0, -0.03, 0.04};
    capsule.radius = 0.008;
    link.shapes = {capsule};
    hand.links.push_back(link);
    hand.fingers.push_back({names[i], {i}, i + 1, capsule.b_L, capsule.radius});
  }
  return hand;
}

/// 50 frames per second. Manipulability of the explorer rises from 1 to 2; the others stay at 0.5
/// and 0.8.
inline std::vector<Frame> SyntheticRun(double seconds, double start_s = 0) {
  std::vector<Frame> frames;
  const int count = static_cast<int>(std::lround(seconds * 50));
  for (int k = 0; k < count; ++k) {
    Frame frame;
    frame.tick = static_cast<std::int64_t>(std::lround(start_s * 1000)) + 20 * k;
    frame.time_s = static_cast<double>(frame.tick) * 1e-3;
    frame.seed = 7;
    frame.noise = *NoisePreset("paper");
    const bool exploring = k > count / 3 && k <= 2 * count / 3;
    frame.state = k < count / 6 ? SessionState::kGrasping
                  : exploring   ? SessionState::kExploring
                                : SessionState::kHolding;
    frame.stand_in = frame.state == SessionState::kGrasping;
    frame.num_fingers = 3;
    frame.fingers.resize(3);
    frame.q = JointVector::Zero(3);
    frame.p_WO = frame.p_WO_sensed = {0, -0.04, 0.1};
    frame.mass_kg = 0.08;
    frame.friction = 0.8;
    frame.gravity_W = {0, 0, -9.81};
    const double progress = std::clamp(3.0 * k / count - 1, 0.0, 1.0);
    for (int f = 0; f < 3; ++f) {
      FingerFrame& finger = frame.fingers[f];
      finger.role = f == kSyntheticExplorer && exploring ? FingerRole::kExplore : FingerRole::kHold;
      finger.in_contact = finger.true_contact = true;
      const double around = 2 * f + progress * (f == kSyntheticExplorer),
                   up = 0.3 * f + 0.2 * std::sin(0.1 * k);
      const Vector3d n(std::cos(around) * std::cos(up), std::sin(around) * std::cos(up),
                       std::sin(up));
      finger.p_WC = finger.true_p_WC = frame.p_WO + 0.025 * n;
      finger.normal_W = finger.true_normal_W = n;
      finger.true_force_W = -0.5 * n;
      finger.true_tip_W = frame.p_WO + 0.033 * n;
      finger.true_manipulability = f == kSyntheticExplorer ? 1 + progress : f == 0 ? 0.5 : 0.8;
      finger.manipulability = finger.true_manipulability + 0.01 * std::sin(1.7 * k);
      frame.contacts.push_back({f + 1, f, finger.p_WC, n, finger.true_force_W, 1e-4});
    }
    frame.stability.active = frame.stability.values[0] = 1 - 0.3 * progress;
    frame.stability.threshold = kSyntheticThreshold;
    frame.stability.load_margin = 0.5;
    frame.exploration.active = exploring;
    frame.exploration.finger = exploring ? kSyntheticExplorer : -1;
    frames.push_back(frame);
  }
  return frames;
}

}  // namespace regrasp
