#pragma once

#include <span>

#include "core/quality/grasp.h"

namespace regrasp {

/// Load margin rho [N]: the largest delta for which the contacts, inside their (round) friction
/// cones, balance the weight plus delta * d for all 12 unit wrenches d = +-force along the axes,
/// +-torque about the axes (torques divided by torque_scale). Our addition to the paper: it decides
/// whether a finger may leave.
///
/// 0 where the contacts cannot hold the weight. +infinity where nothing bounds it: a force-closure
/// grasp without a force cap balances every load by squeezing harder.
///
/// contacts: any number; weight: the force of gravity on the object [N], along any direction;
/// torque_scale: [m], > 0; max_force: cap on each normal force [N], > 0; 1e29 and more means none.
/// Error at most 1e-4 |weight| (1e-5 on the grasps of the tests). No allocation for up to
/// kMaxFingers contacts. Deterministic; bounded work.
///
/// Method: for each d a linear programme over all wrenches of the round cones, solved by the
/// revised simplex method; instead of linearising a cone beforehand, the best of its infinitely
/// many edges is found in closed form at each step (column generation [Dantzig, Wolfe 1960]). The
/// 12 programmes advance in turn, always the one that has come least far, until that one is done.
double LoadMargin(std::span<const GraspContact> contacts, const Vector3d& weight,
                  double torque_scale, double max_force = 1e30);

/// LoadMargin(), but negative where the contacts cannot hold the weight: minus the least sum of the
/// components of wrench (torques divided by torque_scale) by which they miss it [N]. For searches,
/// which must see whether they come nearer.
double SignedLoadMargin(std::span<const GraspContact> contacts, const Vector3d& weight,
                        double torque_scale, double max_force = 1e30);

}  // namespace regrasp
