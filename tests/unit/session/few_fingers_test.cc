#include "core/session/few_fingers.h"

#include <gtest/gtest.h>

#include <string>

#include "core/gait/may_not_leave.h"
#include "core/hand/scenario.h"
#include "core/session/activity/activity.h"
#include "core/session/event_log.h"

namespace regrasp {
namespace {

class FewFingers : public ::testing::Test {
 protected:
  bool Allows(CommandType type, int finger, double angle_rad) const {
    Command command;
    command.type = type;
    command.finger = finger;
    command.angle_rad = angle_rad;
    return CheckFingers(hand, parameters, command).kind == Verdict::Kind::kAllowed;
  }
  HandModel hand = LoadScenario("shadow", "", ModelSearchPath()).hand;
  Parameters parameters;
};

TEST_F(FewFingers, AFingerOfTwoDrivenJointsDoesNotExplore) {
  hand.fingers[1].joints.resize(2);
  EXPECT_FALSE(Allows(CommandType::kExplore, 1, 0));
  EXPECT_TRUE(Allows(CommandType::kExplore, 0, 0));
}

TEST_F(FewFingers, AHandWithSuchAFingerTurnsAnObjectByOneMotionOnly) {
  EXPECT_TRUE(Allows(CommandType::kRotate, -1, 1));
  hand.fingers[1].joints.resize(2);
  EXPECT_FALSE(Allows(CommandType::kRotate, -1, 1));
  EXPECT_TRUE(Allows(CommandType::kRotate, -1, parameters.gait.step_rad));
  EXPECT_TRUE(Allows(CommandType::kGrasp, -1, 0));
}

// The longest name that a file may give a finger.
TEST_F(FewFingers, WhatIsSaidOfAFingerHasRoomForItsName) {
  hand.fingers[0].name = std::string(kMaxNameBytes, 'x');
  const std::string reason = MayNotLeave(hand, 0, -0.123, 0.25).data();
  EXPECT_TRUE(reason.ends_with(" without it is -0.123 N, below 0.250 N")) << reason;
  EventLog log;
  log.Emit(0, EventKind::kRefused, 0, 0, "job %lld: %s: %s", 123456789LL, "failed", reason.c_str());
  EXPECT_EQ(log.Take().front().text, "job 123456789: failed: " + reason);
  EXPECT_EQ(ActivityStep::Failed(reason.c_str()).error, reason);
}

TEST_F(FewFingers, OfThreeFingersNoneExplores) {
  hand.fingers.resize(3);
  EXPECT_FALSE(Allows(CommandType::kExplore, 0, 0));
  EXPECT_FALSE(Allows(CommandType::kRotate, -1, -1));
  EXPECT_TRUE(Allows(CommandType::kRotate, -1, -parameters.gait.step_rad));
}

}  // namespace
}  // namespace regrasp
