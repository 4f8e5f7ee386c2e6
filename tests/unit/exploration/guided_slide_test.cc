// The guided slide, driven by a finger that follows every command at once over an analytic
// surface: a ball on which phi has one maximum. No physics.

#include "core/exploration/guided_slide.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/gait/gait_parameters.h"
#include "core/shape/felt_surface.h"

namespace regrasp {
namespace {

constexpr double kDt = 1e-3;
constexpr double kRadius = 0.025;    // of the ball [m]
constexpr double kCurvature = 3000;  // phi = 1.5 - k |p - top|² [1/m²]
using Phase = GuidedSlide::Phase;
using End = GuidedSlide::End;

Vector3d Top() { return kRadius * Vector3d(0.3, -0.5, 0.8).normalized(); }
/// A point of the ball, `distance` [m] of arc from the maximum.
Vector3d StartAt(double distance) {
  const Vector3d n = Top().normalized();
  const Vector3d t = n.cross(Vector3d::UnitX()).normalized();
  return kRadius * (std::cos(distance / kRadius) * n + std::sin(distance / kRadius) * t);
}

/// Three fingers of one joint each, without shapes: the only walls are joint limits, wide here.
HandModel ThreeFingers() {
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
    f.manipulability = 1.5 - kCurvature * (p - Top()).squaredNorm();
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

TEST_F(SlideTest, UnloadsFromTheForceItHasWithoutAStep) {
  estimate_.fingers[0].force = 1.7;
  Start();
  Tick();
  double before = tasks_[0].cap;
  EXPECT_NEAR(before, 1.7, 1.7 * kDt / profile_.transfer_s);
  const double step = 1.7 / profile_.transfer_s * kDt;
  while (slide_.phase() == Phase::kUnload) {
    Tick();
    EXPECT_LE(tasks_[0].cap, before);
    EXPECT_LE(before - tasks_[0].cap, step);
    before = tasks_[0].cap;
  }
  EXPECT_EQ(slide_.phase(), Phase::kSettle);
  EXPECT_DOUBLE_EQ(before, parameters_.normal_force);
  EXPECT_EQ(ticks_, static_cast<int>(std::lround(profile_.transfer_s / kDt)));
}

TEST_F(SlideTest, PressesLessWhereTheOthersCanCarryLess) {
  for (const double margin : {0.0, 0.6, 5.0}) {
    margins_.without[0] = margin;
    Start();
    ASSERT_TRUE(RunTo(Phase::kSettle));
    Tick();
    EXPECT_DOUBLE_EQ(tasks_[0].force, std::clamp(parameters_.force_share * margin,
                                                 parameters_.least_force * parameters_.normal_force,
                                                 parameters_.normal_force));
  }
}

TEST_F(SlideTest, FindsTheMaximumAndTakesUpItsLoad) {
  const double first = FromTop();
  Start();
  ASSERT_TRUE(RunTo(Phase::kExplore));
  EXPECT_TRUE(slide_.slide_began());
  while (!slide_.slide_ended()) Tick();
  EXPECT_LT(FromTop(), 0.5 * first);
  EXPECT_GT(slide_.phi_final(), slide_.phi_initial());
  EXPECT_TRUE(slide_.end() == End::kGradient || slide_.end() == End::kNoGain);
  ASSERT_TRUE(RunTo(Phase::kDone));
  EXPECT_EQ(tasks_[0].mode, FingerMode::kHold);
  EXPECT_EQ(tasks_[0].cap, control_.max_normal_force);
  EXPECT_FALSE(slide_.no_surface());
}

// With epsilon 0 no gradient counts as converged.
TEST_F(SlideTest, EndsWhereNothingIsGainedAnyMore) {
  parameters_.epsilon = 0;
  parameters_.no_gain_s = 0.5;
  Start();
  ASSERT_TRUE(RunTo(Phase::kExplore));
  double best = slide_.phi(), gained_s = 0;
  while (slide_.phase() == Phase::kExplore) {
    Tick();
    if (slide_.phi() < parameters_.worth_returning * best) continue;
    best = slide_.phi();
    gained_s = slide_.cycles() * kDt;
  }
  EXPECT_GT(slide_.cycles() * kDt, gained_s + 0.9 * parameters_.no_gain_s);
  EXPECT_LT(slide_.cycles() * kDt, gained_s + 2 * parameters_.no_gain_s);
  while (!slide_.slide_ended()) Tick();
  EXPECT_EQ(slide_.end(), End::kNoGain);
  EXPECT_LT(FromTop(), 1e-3);

  parameters_.no_gain_s = 0;
  Place(StartAt(4e-3));
  Start();
  while (!slide_.slide_ended()) Tick();
  EXPECT_EQ(slide_.end(), End::kMaxCycles);
}

TEST_F(SlideTest, EndsAfterItsTime) {
  profile_.explore_s = 0.2;
  Start();
  ASSERT_TRUE(RunTo(Phase::kExplore));
  const int begin = ticks_;
  while (!slide_.slide_ended()) Tick();
  EXPECT_EQ(slide_.end(), End::kTime);
  // The way back to the best contact comes on top.
  EXPECT_LE((ticks_ - begin) * kDt, profile_.explore_s + profile_.return_limit_s + 3 * kDt);
}

TEST_F(SlideTest, LosesItsContactOnceWhateverThePhase) {
  for (const Phase phase : {Phase::kRecall, Phase::kExplore}) {
    guide_.recall_W =
        phase == Phase::kRecall ? std::optional<Vector3d>(StartAt(8e-3)) : std::nullopt;
    Place(StartAt(4e-3));
    Contact(true);
    Start();
    ASSERT_TRUE(RunTo(phase));
    const int begin = ticks_;
    while (!slide_.slide_ended() && ticks_ < begin + 2000) {
      Contact(false);
      Tick();
    }
    EXPECT_EQ(slide_.end(), End::kContactLost);
    EXPECT_NEAR((ticks_ - begin) * kDt, parameters_.lost_contact_s, 1.5 * kDt);
    // Without a surface the load is not taken up for ever.
    ASSERT_TRUE(RunTo(Phase::kDone));
    EXPECT_TRUE(slide_.no_surface());
  }
}

TEST_F(SlideTest, AShortLossIsNone) {
  Start();
  ASSERT_TRUE(RunTo(Phase::kExplore));
  for (int k = 0; k < static_cast<int>(parameters_.lost_contact_s / kDt) - 1; ++k) {
    Contact(false);
    Tick();
  }
  Contact(true);
  Tick();
  EXPECT_EQ(slide_.phase(), Phase::kExplore);
}

TEST_F(SlideTest, AJointLimitIsAWall) {
  // The maximum lies at larger x than the start: the joint that carries it stops half way.
  const double way = Top().x() - StartAt(4e-3).x();
  hand_.joints[0].lower = -10;
  hand_.joints[0].upper = 10;
  const double half = 0.5 * way / kLever;
  (half > 0 ? hand_.joints[0].upper : hand_.joints[0].lower) =
      half + (half > 0 ? 1 : -1) * parameters_.limit_margin;
  Start();
  double deepest = 0;
  while (slide_.phase() != Phase::kDone) {
    Tick();
    deepest = std::max(deepest, (estimate_.q[0] - half) * (half > 0 ? 1 : -1) * kLever);
  }
  EXPECT_LT(deepest, 1e-3);  // the dither's circle has a radius of 0.5 mm
}

// On the side of its link, and its joint held by a limit that is in the way onto the round tip: it
// tries to leave for onto_tip_s, then explores where it is.
TEST_F(SlideTest, ExploresOnTheSideOfItsLinkThatItCannotLeave) {
  const Vector3d p = StartAt(4e-3), n = p.normalized();
  const Vector3d along = TangentPart(Vector3d::UnitX(), n).normalized();
  Shape capsule;
  capsule.radius = 0.007;
  capsule.b_L = p + capsule.radius * n + 3e-3 * along;  // its round end 3 mm ahead
  capsule.a_L = capsule.b_L - 0.02 * along;
  hand_.links[1].shapes = {capsule};
  hand_.joints[0].axis_J = Vector3d::UnitZ();
  hand_.joints[0].X_PJ.translation() = Vector3d(0, kLever, 0);
  hand_.joints[0].lower = -1e-3;
  ForwardKinematics(hand_, estimate_.q, &estimate_.kinematics);
  parameters_.onto_tip_s = 0.1;
  Start();
  ASSERT_TRUE(RunTo(Phase::kExplore));
  const int begin = ticks_;
  while (slide_.phase() == Phase::kExplore &&
         (ticks_ - begin) * kDt < 0.9 * parameters_.onto_tip_s) {
    Tick();
    ASSERT_EQ((estimate_.fingers[0].p_WC - p).norm(), 0) << "the limit";
  }
  ASSERT_EQ(slide_.phase(), Phase::kExplore);
  while (!slide_.slide_ended()) Tick();
  EXPECT_TRUE(slide_.end() == End::kGradient || slide_.end() == End::kNoGain);
  EXPECT_GT(slide_.phi_final(), slide_.phi_initial() + 0.01);

  // All of it counts for the time that a gait gives it.
  Place(p);
  ForwardKinematics(hand_, estimate_.q, &estimate_.kinematics);
  profile_.explore_s = 0.15;
  Start();
  ASSERT_TRUE(RunTo(Phase::kExplore));
  const int start = ticks_;
  while (slide_.phase() == Phase::kExplore) Tick();
  EXPECT_NEAR((ticks_ - start) * kDt, profile_.explore_s, 2 * kDt);
}

TEST_F(SlideTest, StaysInItsDiscAndEndsInside) {
  guide_.disc_centre_W = StartAt(4e-3);
  guide_.disc_radius = 1.5e-3;
  Start();
  double farthest = 0;
  while (!slide_.slide_ended()) {
    Tick();
    farthest = std::max(farthest, (estimate_.fingers[0].p_WC - guide_.disc_centre_W).norm());
  }
  EXPECT_LT(farthest, guide_.disc_radius + 1e-3);  // the dither's circle
  EXPECT_LT((estimate_.fingers[0].p_WC - guide_.disc_centre_W).norm(),
            guide_.disc_radius + parameters_.disc_slack + parameters_.arrived);
}

TEST_F(SlideTest, WaitsForTheObjectThenGivesUp) {
  Start();
  ASSERT_TRUE(RunTo(Phase::kExplore));
  estimate_.p_WO.x() += 1.01 * parameters_.object_stop;
  const int begin = ticks_;
  while (!slide_.slide_ended() && ticks_ < begin + 2000) {
    Tick();
    if (slide_.slide_ended()) break;
    EXPECT_EQ(tasks_[0].v_W.norm(), 0);
  }
  EXPECT_EQ(slide_.end(), End::kObjectMoved);
  EXPECT_NEAR((ticks_ - begin) * kDt, parameters_.object_wait_s, 1.5 * kDt);
}

TEST_F(SlideTest, StopsInEveryPhase) {
  for (const Phase phase :
       {Phase::kUnload, Phase::kSettle, Phase::kRecall, Phase::kExplore, Phase::kReload}) {
    Place(StartAt(4e-3));
    guide_.recall_W = StartAt(6e-3);
    Start();
    ASSERT_TRUE(RunTo(phase));
    slide_.Stop();
    const int begin = ticks_;
    ASSERT_TRUE(RunTo(Phase::kDone));
    // At once into the load transfer.
    EXPECT_LE((ticks_ - begin) * kDt, profile_.transfer_s + 2 * kDt);
    EXPECT_EQ(tasks_[0].mode, FingerMode::kHold);
    EXPECT_EQ(tasks_[0].cap, control_.max_normal_force);
  }
}

TEST_F(SlideTest, AFingerThatGoesAwayIsLeftToItsMover) {
  profile_.leave_force = 0.05;
  Start(true);
  ASSERT_TRUE(RunTo(Phase::kAway));
  EXPECT_NEAR(tasks_[0].cap, profile_.leave_force, 1e-12);
  tasks_[0].mode = FingerMode::kReach;
  for (int k = 0; k < 100; ++k) Tick();
  EXPECT_EQ(slide_.phase(), Phase::kAway);
  EXPECT_EQ(tasks_[0].mode, FingerMode::kReach);
  slide_.Land(true);
  EXPECT_EQ(slide_.phase(), Phase::kSettle);
  Start(true);
  ASSERT_TRUE(RunTo(Phase::kAway));
  slide_.Stop();
  slide_.Land(true);  // wanted to explore, but is stopped
  EXPECT_EQ(slide_.phase(), Phase::kReload);
}

}  // namespace
}  // namespace regrasp
