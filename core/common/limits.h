#pragma once

/// Compile-time capacities. They bound memory so that a tick never allocates; the actual numbers of
/// joints and fingers come from the hand model.

#include <Eigen/Core>

namespace regrasp {

inline constexpr int kMaxFingers = 8;       ///< fingers per hand
inline constexpr int kMaxJoints = 32;       ///< joints per hand
inline constexpr int kMaxFingerJoints = 8;  ///< joints on the chain palm -> fingertip
inline constexpr int kMaxLinks = kMaxJoints + 1;
inline constexpr int kMaxObjectContacts = 24;  ///< simultaneous contacts of the object

/// One value per joint of the hand, in the model's joint order.
using JointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxJoints, 1>;
/// One value per joint of one finger, root to tip.
using FingerVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxFingerJoints, 1>;
/// Translational Jacobian of a point on a fingertip: 3 x (joints of the finger), columns root to
/// tip.
using FingerJacobian = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMaxFingerJoints>;

}  // namespace regrasp
