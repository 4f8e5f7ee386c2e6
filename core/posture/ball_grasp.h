#pragma once

/// How good a posture is in which every fingertip touches a ball: the score that the search climbs
/// and the sheet that users read.

#include <vector>

#include "core/hand/hand_model.h"
#include "core/hand/kinematics.h"

namespace regrasp {

/// Leaves 9 mm to a ball 18 mm larger across [m].
inline constexpr double kOpenGap = 0.018;

/// What is grasped, and how contacts are judged.
struct BallTask {
  double radius = 0.025;                                    ///< [m]
  Vector3d weight = 0.08 * 9.81 * Vector3d(0, 0.42, 0.91);  ///< of the ball, in W [N]
  double friction = 0.5;                                    ///< that is counted on
  double max_force = 4.0;                                   ///< of a finger [N]
  double gap = kOpenGap;  ///< of the open hand's fingertips to the ball [m]
};

struct BallGrasp {
  JointVector q;                     ///< driven joints [rad]
  Vector3d p_WO = Vector3d::Zero();  ///< centre of the ball [m]
  double score = -1e9;
  double load_margin = 0;              ///< rho with every finger [N]
  std::vector<double> margin_without;  ///< rho without each finger, negative where it drops [N]
  std::vector<double> manipulability;  ///< of each finger at its contact [m³],
                                       ///< not in kManipulabilityUnit
  double room = 0;  ///< least distance to a joint limit, in shares of half the joint's range
  double clearance =
      0;              ///< least gap of links of different fingers, of the ball to other links [m]
  double sigma = 0;   ///< least singular value of a finger's Jacobian; of fingers of 3 joints [m]
  double climb = 0;   ///< least gain of manipulability within 5 mm of the contact, in shares
  double push = 0;    ///< least share of a fingertip's motion that can go along its contact's
                      ///< normal; of fingers of fewer than 3 joints, which must press so
  double facing = 0;  ///< least cosine of a fingertip's axis to the ball's centre
  int opposing = -1;  ///< finger without which the margin is least
};

/// Angle of `link`-chain outer axis: unit vector from the tip link's inside to its rounded end, W.
Vector3d TipAxis(const HandModel& hand, const KinematicsData& data, int finger);

/// Moves the joints of `q` until every fingertip touches the ball; false where one cannot within
/// its limits. Newton's method on the distance, one finger after the other, for any number of
/// joints.
bool TouchBall(const HandModel& hand, double radius, const Vector3d& p_WO, JointVector* q);

/// The same for one fingertip that shall touch at the direction `outward` (unit) from the ball's
/// centre.
bool TouchAt(const HandModel& hand, double radius, const Vector3d& p_WO, int finger,
             const Vector3d& outward, JointVector* q);

/// Smallest gap of links of different fingers, and of all shapes but the rounded tips (and the
/// palm) to the ball [m].
double Clearance(const HandModel& hand, const KinematicsData& data, const Vector3d& p_WO,
                 double radius);

/// Fills everything but `q` and `p_WO`, which must touch. Where the score cannot exceed `enough`
/// it stops early and leaves the score at or below it.
void RateGrasp(const HandModel& hand, const BallTask& task, double enough, BallGrasp* grasp);

}  // namespace regrasp
