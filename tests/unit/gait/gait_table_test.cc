// The gait's table, and how it is fitted to a hand.

#include "core/gait/gait_table.h"

#include <gtest/gtest.h>

#include "core/gait/gait_parameters.h"
#include "core/gait/stance_search.h"
#include "core/hand/scenario.h"
#include "core/quality/load_margin.h"

namespace regrasp {
namespace {

/// A hand whose fingers stand in a row, 2 cm apart, the first one next to the last one's root.
HandModel HandWith(std::initializer_list<const char*> names) {
  HandModel hand;
  hand.links.emplace_back();  // the palm
  int place = 0;
  for (const char* name : names) {
    Finger finger;
    finger.name = name;
    finger.joints = {hand.num_joints()};
    Joint joint;
    const bool last = place + 1 == static_cast<int>(names.size());
    joint.X_PJ.translation() = last ? Vector3d(0.015, 0, 0) : Vector3d(-0.02 * place, 0, 0);
    joint.parent_link = 0;
    joint.child_link = finger.tip_link = static_cast<int>(hand.links.size());
    hand.links.emplace_back().parent_joint = hand.num_joints();
    hand.joints.push_back(joint);
    hand.fingers.push_back(finger);
    ++place;
  }
  return hand;
}

/// Contacts with these outward normals on a ball of 25 mm at the origin.
Estimate Touching(std::initializer_list<Vector3d> normals) {
  Estimate estimate;
  for (const Vector3d& n : normals) {
    FingerEstimate finger;
    finger.ever_in_contact = finger.in_contact = true;
    finger.normal_W = n.normalized();
    finger.p_WC = 0.025 * finger.normal_W;
    estimate.fingers.push_back(finger);
  }
  return estimate;
}

TEST(GaitTable, ReadsLikeThePaper) {
  const HandModel hand = HandWith({"first", "middle", "ring", "little", "thumb"});
  const Estimate estimate =
      Touching({{0.3, 1, 0}, {0.1, 1, 0}, {-0.1, 1, 0}, {-0.3, 1, 0}, {0, -1, 0}});
  const GaitOrder order = MakeGaitOrder(hand, estimate, FingerSet::First(5));
  const char* states[] = {"S_L", "S_R", "S_M", "S_F", "S_T"};
  ASSERT_EQ(order.size(), 5u);
  for (std::size_t k = 0; k < order.size(); ++k) {
    EXPECT_EQ(GaitStateNameOf(hand, order[k].finger).view(), states[k]);
    EXPECT_EQ(order[k].objective == GaitObjective::kStabilityWithoutNext, k == 3);
  }
  EXPECT_EQ(GaitStateNameOf(hand, -1).view(), "object motion");
}

TEST(GaitTable, ShadowsModelHasThePapersOrder) {
  const HandModel hand = LoadScenario("shadow", "sphere", ModelSearchPath()).hand;
  Estimate estimate;
  for (const Finger& finger : hand.fingers) {
    FingerEstimate f;
    f.normal_W = Vector3d(0, finger.name == "thumb" ? -1 : 1, 0);
    estimate.fingers.push_back(f);
  }
  std::string states;
  for (const GaitStep& step : MakeGaitOrder(hand, estimate, FingerSet::First(5)))
    states += std::string(GaitStateNameOf(hand, step.finger).view()) + " ";
  EXPECT_EQ(states, "S_L S_R S_M S_F S_T ");
}

TEST(GaitTable, FingersThatBeginAlikeHaveTheirNamesInFull) {
  const HandModel hand = HandWith({"index", "inner", "thumb"});
  EXPECT_EQ(GaitStateNameOf(hand, 0).view(), "S_index");
  EXPECT_EQ(GaitStateNameOf(hand, 1).view(), "S_inner");
  EXPECT_EQ(GaitStateNameOf(hand, 2).view(), "S_T");
  const HandModel long_names = HandWith({"a_very_long_name_of_a_finger", "a_b", "c"});
  EXPECT_EQ(GaitStateNameOf(long_names, 0).view(), "S_a_very_long_name_of_a");
}

TEST(GaitOrder, FewerFingersHaveATableToo) {
  const HandModel hand = HandWith({"index", "middle", "ring", "thumb"});
  const Estimate estimate = Touching({{0.2, 1, 0}, {0, 1, 0}, {-0.2, 1, 0}, {0, -1, 0}});
  const GaitOrder order = MakeGaitOrder(hand, estimate, FingerSet::First(4));
  const int expected[] = {2, 1, 0, 3};
  ASSERT_EQ(order.size(), 4u);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(order[k].finger, expected[k]);
  EXPECT_EQ(order[2].objective, GaitObjective::kStabilityWithoutNext);
  EXPECT_EQ(MakeGaitOrder(hand, estimate, {1}).size(), 1u);  // nobody opposes it
  EXPECT_TRUE(MakeGaitOrder(hand, estimate, {}).empty());
}

TEST(GaitOrder, OfTheFiveFingeredHandIsTheTable) {
  const HandModel hand = HandWith({"first", "middle", "ring", "little", "thumb"});
  const Estimate estimate =
      Touching({{0.3, 1, 0}, {0.1, 1, 0}, {-0.1, 1, 0}, {-0.3, 1, 0}, {0, -1, 0}});
  const GaitOrder order = MakeGaitOrder(hand, estimate, FingerSet::First(5));
  const int expected[] = {3, 2, 1, 0, 4};
  ASSERT_EQ(order.size(), 5u);
  for (std::size_t k = 0; k < 5; ++k) EXPECT_EQ(order[k].finger, expected[k]);
  EXPECT_EQ(order[3].objective, GaitObjective::kStabilityWithoutNext);
}

TEST(GaitOrder, OpposingFingerComesLastWhateverItsName) {
  const HandModel hand = HandWith({"a", "b", "c"});
  const Estimate estimate = Touching({{0, -1, 0}, {0.3, 1, 0}, {-0.3, 1, 0}});
  const GaitOrder order = MakeGaitOrder(hand, estimate, FingerSet::First(3));
  ASSERT_EQ(order.size(), 3u);
  EXPECT_EQ(order[0].finger, 1);
  EXPECT_EQ(order[1].finger, 2);
  EXPECT_EQ(order[2].finger, 0);
  EXPECT_EQ(order[1].objective, GaitObjective::kStabilityWithoutNext);
}

TEST(GaitOrder, LeavesOutFingersThatDoNotHold) {
  const HandModel hand = HandWith({"first", "middle", "ring", "little", "thumb"});
  const Estimate estimate =
      Touching({{0.3, 1, 0}, {0.1, 1, 0}, {-0.1, 1, 0}, {-0.3, 1, 0}, {0, -1, 0}});
  const GaitOrder order = MakeGaitOrder(hand, estimate, {0, 2, 4});
  ASSERT_EQ(order.size(), 3u);
  for (const GaitStep& step : order) EXPECT_TRUE(step.finger % 2 == 0);
}

TEST(Stance, ShiftedContactStaysOnTheBall) {
  const double radius = 0.025, tip = 0.007;
  const Vector3d n = Vector3d(1, 2, 3).normalized();
  const StanceContact contact{radius * n, (radius + tip) * n, n};
  const Vector3d step = 0.006 * n.cross(Vector3d::UnitX()).normalized();
  const StanceContact moved = Shifted(contact, step);
  // Exact up to rounding: on a ball the surface model is the surface.
  EXPECT_NEAR(moved.p_OC_W.norm(), radius, 1e-12);
  EXPECT_LT((moved.normal_W - moved.p_OC_W.normalized()).norm(), 1e-12);
  EXPECT_NEAR((moved.p_OF_W - moved.p_OC_W).norm(), tip, 1e-12);
  // An arc of 6 mm on 25 mm has a chord of 2 * 25 * sin(6 / 50) mm.
  EXPECT_NEAR((moved.p_OC_W - contact.p_OC_W).norm(), 2 * radius * std::sin(0.006 / (2 * radius)),
              1e-12);
}

TEST(Stance, SearchRaisesTheMarginWithinItsBound) {
  Stance stance;
  // Four contacts that hardly hold the ball, and one opposing finger that is to leave.
  for (const Vector3d& direction :
       {Vector3d(0.5, 0.8, 0.6), Vector3d(0.15, 0.8, -0.75), Vector3d(-0.2, 0.75, -0.7),
        Vector3d(-0.75, -0.3, 0.4), Vector3d(0, -1, 0)}) {
    const Vector3d n = direction.normalized();
    stance.push_back({0.025 * n, 0.032 * n, n});
  }
  const Vector3d weight(0, 0, -0.785);
  StanceSearch search;
  search.Start(stance, stance, FingerSet::First(5), 4, 0.006, 7);
  search.Step(weight, 0.5, 0.025, 4.0, GaitParameters().search_step);
  const double first = search.margin();
  for (int k = 0; k < 200; ++k) search.Step(weight, 0.5, 0.025, 4.0, GaitParameters().search_step);
  EXPECT_GT(search.margin(), first);
  for (std::size_t i = 0; i < stance.size(); ++i)
    EXPECT_LE((search.stance()[i].p_OC_W - stance[i].p_OC_W).norm(), 0.006 + 1e-12);
  EXPECT_EQ(search.stance()[4].p_OC_W, stance[4].p_OC_W);
}

}  // namespace
}  // namespace regrasp
