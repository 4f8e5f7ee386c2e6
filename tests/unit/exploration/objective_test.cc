#include "core/exploration/objective.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/hand/finger_reach.h"
#include "core/quality/stability.h"
#include "tests/unit/control/held_sphere.h"

namespace regrasp {
namespace {

constexpr FingerSet kAll = FingerSet::First(5);

class ObjectiveTest : public ::testing::Test {
 protected:
  ObjectiveValue Value(Criterion criterion, double weight = 1, bool was_on_stability = false) {
    ExplorationParameters exploration;
    exploration.stability_weight = weight;
    return Objective(hand_, {criterion, 2, kAll}, estimate_, parameters_, exploration,
                     was_on_stability);
  }
  const LoadedScenario scenario_ = ShadowHand();
  const HandModel& hand_ = scenario_.hand;
  const Estimate estimate_ = TouchingEstimate(hand_, GraspPosture(hand_));
  ControlParameters parameters_;
};

/// Four contacts at the corners of a regular tetrahedron about the object, and what is sensed of
/// them: G Gᵀ is 4 I of forces and 4 I - (sum of n nᵀ = 4/3 I) = 8/3 I of torques, so that the
/// smallest singular value is √(8/3).
Estimate OnTetrahedron(Estimate estimate) {
  constexpr double kRadius = 0.03;
  const Vector3d corners[] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  for (int i = 0; i < 4; ++i) {
    estimate.fingers[i].normal_W = corners[i].normalized();
    estimate.fingers[i].p_WC = estimate.p_WO + kRadius * corners[i].normalized();
  }
  estimate.object_scale = kRadius;
  estimate.fingers[2].manipulability = 0.7;
  return estimate;
}

/// phi by hand, with the weights of the test below.
double ByHand(Criterion criterion, bool stable_enough) {
  const double stability = std::sqrt(8.0 / 3);
  switch (criterion) {
    case Criterion::kManipulability:
      return 0.7;
    case Criterion::kStability:
      return stability;
    case Criterion::kSwitched:
      return stable_enough ? 0.7 : stability;
    case Criterion::kCombined:
      return 0.7 + 2.5 * stability;
    case Criterion::kReserve:  // without an axis of the turn the reserve is the most, 2
      return 2 + 0.3 * 0.7 - 2 * (0.5 - 0.4);
  }
  return -1;
}

TEST_F(ObjectiveTest, EveryCriterionIsItsDefinition) {
  const Estimate estimate = OnTetrahedron(estimate_);
  ExplorationParameters exploration;
  exploration.stability_weight = 2.5;
  exploration.reserve_manipulability = 0.3;
  exploration.reserve_margin_wanted = 0.5;
  exploration.reserve_margin_cost = 2;
  for (const CriterionInfo& row : kCriterionTable)
    for (const bool stable_enough : {false, true}) {
      parameters_.stability_threshold = stable_enough ? 1.6 : 1.7;
      const ObjectiveValue value =
          Objective(hand_, {row.id, 2, FingerSet::First(4), Vector3d::Zero(), 0.4}, estimate,
                    parameters_, exploration, false);
      EXPECT_NEAR(value.phi, ByHand(row.id, stable_enough), 1e-6) << row.name;
      const bool on_stability =
          row.phi_of == PhiOf::kStability || (row.phi_of == PhiOf::kEither && !stable_enough);
      EXPECT_EQ(value.on_stability, on_stability) << row.name;
    }
}

TEST_F(ObjectiveTest, StabilityMeasureIsSelectable) {
  const Grasp grasp = GraspOf(estimate_, kAll, parameters_.friction_estimate);
  const SingularMeasures m =
      ComputeSingularMeasures({grasp.data(), grasp.size()}, estimate_.object_scale);
  const auto With = [&](Measure measure) {
    parameters_.stability_measure = measure;
    return GraspStability(estimate_, kAll, parameters_);
  };
  EXPECT_EQ(With(Measure::kMinSingularValue), m.min_singular_value);
  EXPECT_EQ(With(Measure::kSqrtDet), m.sqrt_det);
  EXPECT_EQ(With(Measure::kIsotropy), m.isotropy);
}

TEST_F(ObjectiveTest, SwitchHasHysteresis) {
  const double stability = GraspStability(estimate_, kAll, parameters_);
  const auto On = [&](double threshold, bool was) {
    parameters_.stability_threshold = threshold;
    const ObjectiveValue value = Value(Criterion::kSwitched, 1, was);
    EXPECT_EQ(value.phi, value.on_stability ? stability : estimate_.fingers[2].manipulability);
    return value.on_stability;
  };
  EXPECT_FALSE(On(0.99 * stability, false));
  EXPECT_TRUE(On(1.01 * stability, false));
  EXPECT_TRUE(On(0.99 * stability, true));  // stays until 5 % above the threshold
  EXPECT_FALSE(On(0.94 * stability, true));
}

TEST_F(ObjectiveTest, ReserveCountsManipulabilityAndAMarginThatIsMissing) {
  const Vector3d axis = -Vector3d::UnitZ();
  ExplorationParameters exploration;
  exploration.reserve_manipulability = 0.3;
  exploration.reserve_margin_wanted = 0.5;
  exploration.reserve_margin_cost = 2;
  const auto phi = [&](const Vector3d& turn_axis_W, double margin) {
    const ObjectiveValue value =
        Objective(hand_, {Criterion::kReserve, 2, kAll, turn_axis_W, margin}, estimate_,
                  parameters_, exploration, false);
    EXPECT_FALSE(value.on_stability);
    return value.phi;
  };
  const FingerPosture now = PostureAt(hand_, 2, AnglesOf(hand_, 2, estimate_.q));
  const auto reserve_by = [&](const ReachRule& rule) {
    return MotionReserve(hand_, 2, now, estimate_.p_WO, axis, exploration.limit_margin,
                         kMostReserve, rule);
  };
  const double reserve = reserve_by({});
  EXPECT_GT(reserve, 0.05);
  EXPECT_LT(reserve, kMostReserve);
  const double manipulability = 0.3 * estimate_.fingers[2].manipulability;
  EXPECT_NEAR(phi(axis, 1), reserve + manipulability, 1e-12);
  EXPECT_NEAR(phi(axis, 0.4), reserve + manipulability - 0.2, 1e-12);
  EXPECT_NEAR(phi(Vector3d::Zero(), 1), kMostReserve + manipulability, 1e-12);
  parameters_.reach = {.middle_pull = 0, .tolerance = 0.0005};
  EXPECT_NE(reserve_by(parameters_.reach), reserve);
  EXPECT_NEAR(phi(axis, 1), reserve_by(parameters_.reach) + manipulability, 1e-12);
}

TEST_F(ObjectiveTest, TheAxisOfTheTurnHasNoLength) {
  ExplorationParameters exploration;
  exploration.turn_axis_W = Vector3d(0, 0.3, 0.4);
  EXPECT_LT((TurnAxisOf(exploration) - Vector3d(0, 0.6, 0.8)).norm(), 1e-12);
  exploration.turn_axis_W.setZero();
  EXPECT_TRUE(TurnAxisOf(exploration).isZero(0));
}

}  // namespace
}  // namespace regrasp
