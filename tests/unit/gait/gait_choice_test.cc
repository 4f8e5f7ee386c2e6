// What the two gaits answer, one choice after the other.

#include "core/gait/gait_choice.h"

#include <gtest/gtest.h>

#include "core/gait/planned_gait.h"
#include "core/gait/table_gait.h"
#include "tests/unit/gait/held_tick.h"

namespace regrasp {
namespace {

using Kind = GaitChoice::Kind;

struct GaitChoiceTest : HeldTick {
  GaitChoiceTest() {
    margins.all = 2;
    margins.without.fill(1);
    cycle.order = MakeGaitOrder(hand, estimate, all);
    cycle.waiting = all;
    now.since_s = gait.second_thought_s;
    for (FingerEstimate& f : estimate.fingers) {
      f.ticks_in_contact = 1000;
      now.homes.push_back({f.p_WC + Vector3d(0.01, 0, 0), f.p_WF, f.normal_W});
    }
  }
  int opposing() const { return cycle.order.back().finger; }

  GaitCycle cycle;
  GaitSituation now;
};

TEST_F(GaitChoiceTest, TheTableGoesThroughItsFingersInOrder) {
  TableGait table;
  for (const GaitStep& step : cycle.order) {
    const GaitChoice choice = table.Next(Tick(), now, &cycle);
    EXPECT_EQ(choice.kind, Kind::kRegrasp);
    EXPECT_EQ(choice.finger, step.finger);
    EXPECT_FALSE(choice.planned || choice.landing.found);
  }
  EXPECT_EQ(table.Next(Tick(), now, &cycle).kind, Kind::kCycleEnds);
}

TEST_F(GaitChoiceTest, AFingerAtItsHomeStays) {
  const int first = cycle.order[0].finger;
  now.homes[first].p_OC_W = estimate.fingers[first].p_WC;
  TableGait table;
  EXPECT_EQ(table.Next(Tick(), now, &cycle).finger, cycle.order[1].finger);
  EXPECT_EQ(cycle.refused.finger, -1);
}

TEST_F(GaitChoiceTest, TheTableSeeksAStanceForTheOpposingFingerOnceACycle) {
  cycle.waiting = FingerSet{opposing()};
  margins.without[opposing()] = 0;
  TableGait table;
  now.since_s = 0;
  EXPECT_EQ(table.Next(Tick(), now, &cycle).kind, Kind::kWait);
  EXPECT_EQ(cycle.refused.finger, -1);
  now.since_s = gait.second_thought_s;
  const GaitChoice choice = table.Next(Tick(), now, &cycle);
  EXPECT_EQ(choice.kind, Kind::kStance);
  EXPECT_TRUE(choice.refuses);
  EXPECT_EQ(cycle.refused.finger, opposing());
  EXPECT_EQ(cycle.refused.below, gait.margin_min);
  EXPECT_EQ(table.Next(Tick(), now, &cycle).kind, Kind::kCycleEnds);
}

TEST_F(GaitChoiceTest, ThePlanPutsOffWhoMayNotLeave) {
  margins.without[cycle.order[0].finger] = 0;
  PlannedGait planned;
  EXPECT_EQ(planned.Next(Tick(), now, &cycle).kind, Kind::kPlan);
  EXPECT_EQ(cycle.waiting, all.without(cycle.order[1].finger));
}

// Room by one finger after the other, by all of them, then a refusal; in this order.
TEST_F(GaitChoiceTest, ThePlanMakesRoomForOneThatMustComeAlong) {
  margins.without.fill(0);
  cycle.idle = 1;
  cycle.waiting = FingerSet{opposing()};
  PlannedGait planned;
  const GaitChoice room = planned.Next(Tick(), now, &cycle);
  EXPECT_TRUE(room.kind == Kind::kWait && !room.refuses);
  EXPECT_EQ(planned.Next(Tick(), now, &cycle).kind, Kind::kStance);
  EXPECT_TRUE(planned.plans_stance());
  EXPECT_EQ(cycle.searches, 1);
  const GaitChoice refusal = planned.Next(Tick(), now, &cycle);
  EXPECT_TRUE(refusal.kind == Kind::kWait && refusal.refuses);
  EXPECT_EQ(cycle.refused.finger, opposing());
  EXPECT_EQ(cycle.refused.below, gait.margin_min / 2);  // after an idle cycle
  const GaitChoice end = planned.Next(Tick(), now, &cycle);
  EXPECT_EQ(end.kind, Kind::kCycleEnds);
  EXPECT_EQ(end.most_idle, gait.patience);
}

}  // namespace
}  // namespace regrasp
