#include "core/gait/landing_plan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "core/gait/sure_grasp.h"
#include "core/hand/shape_distance.h"
#include "tests/unit/gait/held_tick.h"

namespace regrasp {
namespace {

constexpr double kRadius = 0.025;

struct LandingPlanTest : HeldTick {
  LandingPlanTest() {
    for (int i = 0; i < FeltSurface::kCells; ++i) {
      const Vector3d d = FeltSurface::CellDirection(i);
      for (int k = 0; k < ShapeParameters().full; ++k) felt.Add(kRadius * d, d);
    }
  }
  LandingPlan::Request Home(int finger) {
    LandingPlan::Request request;
    request.finger = finger;
    const FingerEstimate& f = estimate.fingers[finger];
    request.home = {f.p_WC - estimate.p_WO, f.p_WF - estimate.p_WO, f.normal_W};
    request.axis_W = -Vector3d::UnitZ();
    return request;
  }
  int Plan(LandingPlan* plan) {
    int ticks = 1;
    while (!plan->Step(Tick())) ++ticks;
    return ticks;
  }
};

TEST_F(LandingPlanTest, ReachesWhatTheFingerReachesAndNoMore) {
  for (int finger = 0; finger < hand.num_fingers(); ++finger) {
    SCOPED_TRACE(hand.fingers[finger].name);
    const FingerPosture now = PostureAt(hand, finger, AnglesOf(hand, finger, estimate.q));
    EXPECT_LT((now.p_WF - estimate.fingers[finger].p_WF).norm(), 1e-12);  // the hand's kinematics
    const FingerPosture there =
        ReachFor(hand, finger, now, now.p_WF + Vector3d(0.002, 0.001, -0.003), 0.0, 12);
    EXPECT_LT((there.p_WF - now.p_WF - Vector3d(0.002, 0.001, -0.003)).norm(), 2e-4);
    const FingerPosture far = ReachFor(hand, finger, now, Vector3d(0, 0, 0.5), 0.05, 12);
    EXPECT_GT((far.p_WF - Vector3d(0, 0, 0.5)).norm(), 0.1);
    for (std::size_t k = 0; k < hand.fingers[finger].joints.size(); ++k) {
      const Joint& joint = hand.joints[hand.fingers[finger].joints[k]];
      EXPECT_GE(far.q[static_cast<Eigen::Index>(k)], joint.lower);
      EXPECT_LE(far.q[static_cast<Eigen::Index>(k)], joint.upper);
    }
  }
}

// The reserve of a posture that has already turned by an angle is what is left of it.
TEST_F(LandingPlanTest, ReserveShrinksByWhatTheObjectHasTurned) {
  int finger = -1;
  double all = 0;
  for (int i = 0; i < hand.num_fingers(); ++i) {
    const FingerPosture posture = PostureAt(hand, i, AnglesOf(hand, i, estimate.q));
    const double reserve = MotionReserve(hand, i, posture, estimate.p_WO, -Vector3d::UnitZ(), 0.03,
                                         3.0, control.reach);
    if (reserve > all) finger = i;
    all = std::max(all, reserve);
  }
  ASSERT_GT(all, 0.3);
  ASSERT_LT(all, 3.0);
  const FingerPosture now = PostureAt(hand, finger, AnglesOf(hand, finger, estimate.q));
  const Vector3d r = FromRotationVector({0, 0, -0.2}) * (now.p_WF - estimate.p_WO);
  const FingerPosture turned = ReachFor(hand, finger, now, estimate.p_WO + r, 0.0, 20);
  const double rest = MotionReserve(hand, finger, turned, estimate.p_WO, -Vector3d::UnitZ(), 0.03,
                                    3.0, control.reach);
  EXPECT_NEAR(all - rest, 0.2, 0.13);  // steps of 0.06 rad, and another way through the null space
}

TEST_F(LandingPlanTest, LandsOnTheFeltSurfaceWithinReachOfHome) {
  LandingPlan plan;
  for (int finger = 0; finger < hand.num_fingers(); ++finger) {
    SCOPED_TRACE(hand.fingers[finger].name);
    plan.Start(Home(finger));
    const int ticks = Plan(&plan);
    EXPECT_LT(ticks, 120);
    const Landing& landing = plan.landing();
    ASSERT_TRUE(landing.found);
    EXPECT_NEAR(landing.p_OC.norm(), kRadius, 1e-4);
    EXPECT_LT((landing.p_OC - estimate.q_WO.conjugate() * plan.request().home.p_OC_W).norm(),
              0.0105);
    EXPECT_GT(landing.normal_O.dot(landing.p_OC.normalized()), std::cos(0.02));
    EXPECT_GT(landing.reserve, 0.1);
  }
}

TEST_F(LandingPlanTest, KeepsOffGroundThatNobodyHasFelt) {
  const int ring = hand.FindFinger("ring");
  LandingPlan plan;
  plan.Start(Home(ring));
  Plan(&plan);
  const Vector3d free = plan.landing().p_OC;
  // Nothing felt beyond home on the side to which the free plan went.
  const Vector3d home = Home(ring).home.p_OC_W;
  const Vector3d side =
      (free - home - (free - home).dot(home) / home.squaredNorm() * home).normalized();
  felt.Reset();
  for (int i = 0; i < FeltSurface::kCells; ++i) {
    const Vector3d d = FeltSurface::CellDirection(i);
    if (d.dot(side) > 0.05) continue;
    for (int k = 0; k < ShapeParameters().full; ++k) felt.Add(kRadius * d, d);
  }
  plan.Start(Home(ring));
  Plan(&plan);
  EXPECT_LT(plan.landing().p_OC.dot(side), free.dot(side) + 1e-9);
  EXPECT_LT(plan.landing().unknown, 0.36);
}

// A finger at a joint limit holds up the turn for all of them: it goes on to where nothing is felt
// yet rather than stay on known ground.
TEST_F(LandingPlanTest, AFingerAtTheEndOfItsWayDoesNotStay) {
  const Vector3d axis_W = -Vector3d::UnitZ();
  int tested = 0;
  for (int finger = 0; finger < hand.num_fingers(); ++finger) {
    SCOPED_TRACE(hand.fingers[finger].name);
    const LandingPlan::Request request = Home(finger);
    const FingerPosture at_home = PostureAt(hand, finger, AnglesOf(hand, finger, estimate.q));
    const double reserve = MotionReserve(hand, finger, at_home, estimate.p_WO, axis_W,
                                         gait.limit_margin, 3.0, control.reach);
    if (reserve < gait.step_rad) continue;
    ++tested;
    // The object turns nearly as far as the finger follows.
    const Vector3d r = at_home.p_WF - estimate.p_WO;
    FingerPosture at_end = at_home;
    for (double angle = 0; angle <= reserve - 0.12; angle += 0.02)
      at_end = ReachFor(hand, finger, at_end,
                        estimate.p_WO + FromRotationVector(angle * axis_W) * r, 0.0, 10);
    JointVector q = estimate.q;
    const auto& joints = hand.fingers[finger].joints;
    for (std::size_t k = 0; k < joints.size(); ++k)
      q[joints[k]] = at_end.q[static_cast<Eigen::Index>(k)];
    estimate = TouchingEstimate(hand, q);
    const double rest = MotionReserve(hand, finger, at_end, estimate.p_WO, axis_W,
                                      gait.limit_margin, 3.0, control.reach);
    ASSERT_LT(rest, 0.19);
    ASSERT_GT(rest, 0.06);  // a whole step of what the gait counts on
    // Only where it stands the object has been felt.
    felt.Reset();
    const Vector3d here = estimate.fingers[finger].p_WC - estimate.p_WO;
    for (int i = 0; i < FeltSurface::kCells; ++i) {
      const Vector3d d = FeltSurface::CellDirection(i);
      if (d.dot(here.normalized()) < std::cos(0.2)) continue;
      for (int k = 0; k < ShapeParameters().full; ++k) felt.Add(kRadius * d, d);
    }
    LandingPlan plan;
    plan.Start(request);
    Plan(&plan);
    EXPECT_FALSE(plan.landing().stays);
    EXPECT_GT(plan.landing().reserve, 0.5 * gait.step_rad);
    // It is the coming step that it may not hold up: for hardly any there is less to leave for.
    const double gain = plan.landing().gain;
    const double step = std::exchange(gait.step_rad, 0.01);
    plan.Start(request);
    Plan(&plan);
    EXPECT_GT(gain, plan.landing().gain + 0.5);
    gait.step_rad = step;
    estimate = TouchingEstimate(hand, GraspPosture(hand));
  }
  EXPECT_GE(tested, 2);
}

TEST_F(LandingPlanTest, TellsThatAnotherFingerStandsInTheWay) {
  const int ring = hand.FindFinger("ring"), middle = hand.FindFinger("middle");
  LandingPlan::Request request = Home(middle);
  request.reach = 0.002;
  LandingPlan plan;
  plan.Start(request);
  Plan(&plan);
  EXPECT_FALSE(plan.landing().blocked);
  EXPECT_FALSE(plan.crowded());
  // Its home is where the ring finger stands.
  request.home = Home(ring).home;
  plan.Start(request);
  Plan(&plan);
  EXPECT_TRUE(plan.crowded());
  EXPECT_TRUE(plan.landing().stays);
  // In the air it cannot stay.
  estimate.fingers[middle].ticks_without_contact = 100;
  plan.Start(request);
  Plan(&plan);
  EXPECT_TRUE(plan.crowded());
  EXPECT_TRUE(plan.landing().blocked);
}

// As published hands have them: boxes, and beside the fingertip another shape of the same link.
TEST_F(LandingPlanTest, BoxesAreInTheWayAsCapsulesAre) {
  const int ring = hand.FindFinger("ring"), middle = hand.FindFinger("middle");
  const auto blocked = [&] {
    LandingPlan::Request request = Home(middle);
    request.reach = 0.002;
    request.home = Home(ring).home;
    estimate.fingers[middle].ticks_without_contact = 100;
    LandingPlan plan;
    plan.Start(request);
    Plan(&plan);
    return plan.landing().blocked;
  };
  ASSERT_TRUE(blocked());
  // Nothing of the ring finger but its tip's end: the middle finger lands where its links were.
  Link& last = model.hand.links[hand.fingers[ring].tip_link];
  Link& before = model.hand.links[hand.joints[last.parent_joint].parent_link];
  const Shape tip = last.shapes.front(), link = before.shapes.front();
  const auto box = [](const Shape& capsule) {
    Shape box;
    box.kind = Shape::Kind::kBox;
    box.X_LB.linear() = RotationFromZ((capsule.b_L - capsule.a_L).normalized());
    box.X_LB.translation() = 0.5 * (capsule.a_L + capsule.b_L);
    box.half_extents = {capsule.radius, capsule.radius,
                        0.5 * (capsule.b_L - capsule.a_L).norm() + capsule.radius};
    return box;
  };
  last.shapes.front().radius = 0;
  before.shapes.clear();
  ASSERT_FALSE(blocked());
  last.shapes.push_back(box(tip));
  before.shapes.push_back(box(link));
  EXPECT_TRUE(blocked());
}

// Least height of the finger's middle link above the felt surface, once its tip has landed [m].
double HeightOfMiddleLink(const ControlTick& tick, int finger, const Landing& landing) {
  const Vector3d& p_WO = tick.estimate.p_WO;
  const Quaterniond& q_WO = tick.estimate.q_WO;
  const FingerPosture now =
      PostureAt(tick.hand, finger, AnglesOf(tick.hand, finger, tick.estimate.q));
  const FingerPosture there =
      ReachFor(tick.hand, finger, now, p_WO + q_WO * landing.p_OF, 0.05, 20);
  double height = 1;
  for (double share = 0; share <= 1; share += 0.125) {
    const Bone& bone = there.middle[0];
    const Vector3d r = q_WO.conjugate() * (bone.a_W + share * (bone.b_W - bone.a_W) - p_WO);
    height = std::min(height, r.norm() - tick.felt.At(r).p_O.norm() - bone.radius);
  }
  return height;
}

TEST_F(LandingPlanTest, KeepsTheLinkBeforeTheTipOffTheObject) {
  const int first = hand.FindFinger("first");
  LandingPlan plan;
  plan.Start(Home(first));
  Plan(&plan);
  const Landing free = plan.landing();
  // A bump grows into the middle link of a finger that stands there.
  const FingerPosture now = PostureAt(hand, first, AnglesOf(hand, first, estimate.q));
  const FingerPosture there =
      ReachFor(hand, first, now, estimate.p_WO + estimate.q_WO * free.p_OF, 0.05, 20);
  const Vector3d r = estimate.q_WO.conjugate() *
                     (0.5 * (there.middle[0].a_W + there.middle[0].b_W) - estimate.p_WO);
  const double bump = r.norm() - there.middle[0].radius + 0.002;
  ASSERT_GT(bump, kRadius);
  felt.Reset();
  for (int i = 0; i < FeltSurface::kCells; ++i) {
    const Vector3d d = FeltSurface::CellDirection(i);
    const bool near = d.dot(r.normalized()) > std::cos(0.35);
    for (int k = 0; k < ShapeParameters().full; ++k) felt.Add((near ? bump : kRadius) * d, d);
  }
  const double blocked = HeightOfMiddleLink(Tick(), first, free);
  ASSERT_LT(blocked, 0);
  plan.Start(Home(first));
  Plan(&plan);
  EXPECT_GT(HeightOfMiddleLink(Tick(), first, plan.landing()), blocked + 0.001);
}

TEST_F(LandingPlanTest, KeepsWhatIsBesideTheFingertipOffTheObject) {
  const int first = hand.FindFinger("first");
  Link& last = model.hand.links[static_cast<std::size_t>(hand.fingers[first].tip_link)];
  const auto posture = [&](const Landing& landing) {
    return ReachFor(hand, first, PostureAt(hand, first, AnglesOf(hand, first, estimate.q)),
                    estimate.p_WO + estimate.q_WO * landing.p_OF, 0.05, 20);
  };
  const auto gap = [&](const Landing& landing) {
    return GapBesideTip(last, posture(landing).X_WT, estimate.p_WO, kRadius, 1);
  };
  LandingPlan plan;
  plan.Start(Home(first));
  Plan(&plan);
  const Landing free = plan.landing();
  // A knob grows beside the fingertip, 1 mm into the object where the finger would have stood.
  const FingerPosture there = posture(free);
  const Vector3d up = (there.p_WF - estimate.p_WO).normalized();
  const Vector3d aside = TangentPart(there.along_W, up).normalized();
  Shape knob;
  knob.radius = 0.003;
  knob.a_L = knob.b_L =
      there.X_WT.inverse() * (estimate.p_WO + (kRadius + knob.radius - 0.001) *
                                                  (std::cos(0.6) * up - std::sin(0.6) * aside));
  last.shapes.push_back(knob);
  ASSERT_NEAR(gap(free), -0.001, 1e-9);
  plan.Start(Home(first));
  Plan(&plan);
  EXPECT_GT(gap(plan.landing()), 0);
}

// Of a friction cone about a normal that may be off by an angle, that much of its half angle is
// sure.
TEST(FrictionUnderTilt, IsThatOfTheInscribedCone) {
  EXPECT_NEAR(FrictionUnderTilt(0.5, 0), 0.5, 1e-12);
  EXPECT_NEAR(std::atan(FrictionUnderTilt(0.5, 0.1)), std::atan(0.5) - 0.1, 1e-12);
  EXPECT_GT(FrictionUnderTilt(0.5, 2.0), 0);
}

}  // namespace
}  // namespace regrasp
