#include "core/control/contact_force_qp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/common/random.h"
#include "tests/unit/control/truncated_cone.h"

namespace regrasp {
namespace {

/// Contacts on a sphere of 25 mm, normals up to some degrees off, a load of the order of an
/// object's weight.
ForceProblem RandomProblem(RandomStream* random, int contacts) {
  ForceProblem problem;
  problem.torque_scale = 0.025;
  for (int i = 0; i < contacts; ++i) {
    ForceContact c;
    c.finger = i;
    const Vector3d p = RandomDirection(random);
    c.r = 0.025 * p;
    c.inward_normal = (-p + 0.1 * random->Normal3()).normalized();
    c.cap = Uniform(random, 0.2, 4.0);
    c.grip = std::min(1.0, c.cap);
    problem.contacts.push_back(c);
  }
  problem.force = random->Normal3();
  problem.torque = 0.005 * random->Normal3();
  return problem;
}

using Forces = std::vector<Vector3d>;

Forces ToVector(const FixedVector<Vector3d, kMaxFingers>& forces) {
  return {forces.begin(), forces.end()};
}

/// The problem as one stacked least-squares problem, |A x - b|² + w |x - x0|²: written from the
/// definition and not from the solver.
struct Stacked {
  Eigen::MatrixXd A;
  Eigen::VectorXd b, x0;
  explicit Stacked(const ForceProblem& problem) {
    const auto n = static_cast<Eigen::Index>(problem.contacts.size());
    A.setZero(6, 3 * n);
    x0.resize(3 * n);
    b.resize(6);
    b << problem.force, problem.torque / problem.torque_scale;
    for (Eigen::Index i = 0; i < n; ++i) {
      const ForceContact& c = problem.contacts[static_cast<std::size_t>(i)];
      A.block<3, 3>(0, 3 * i).setIdentity();
      Matrix3d cross;
      cross << 0, -c.r.z(), c.r.y(), c.r.z(), 0, -c.r.x(), -c.r.y(), c.r.x(), 0;
      A.block<3, 3>(3, 3 * i) = cross / problem.torque_scale;
      x0.segment<3>(3 * i) = c.grip * c.inward_normal;
    }
  }
  static Eigen::VectorXd Join(const Forces& forces) {
    Eigen::VectorXd x(3 * static_cast<Eigen::Index>(forces.size()));
    for (std::size_t i = 0; i < forces.size(); ++i)
      x.segment<3>(3 * static_cast<Eigen::Index>(i)) = forces[i];
    return x;
  }
  double Objective(const ForceProblem& problem, const Forces& forces) const {
    const Eigen::VectorXd x = Join(forces);
    return (A * x - b).squaredNorm() + problem.grip_weight * (x - x0).squaredNorm();
  }
  Eigen::VectorXd Gradient(const ForceProblem& problem, const Forces& forces) const {
    const Eigen::VectorXd x = Join(forces);
    return 2 * (A.transpose() * (A * x - b) + problem.grip_weight * (x - x0));
  }
};

/// A rigorous bound on objective(forces) - optimum: the Frank-Wolfe gap.
double OptimalityGap(const ForceProblem& problem, const Forces& forces) {
  const Eigen::VectorXd g = Stacked(problem).Gradient(problem, forces);
  double gap = 0;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const ForceContact& c = problem.contacts[i];
    const Vector3d g_i = g.segment<3>(3 * static_cast<Eigen::Index>(i));
    gap += g_i.dot(forces[i]) +
           SupportOfTruncatedCone(-g_i, c.inward_normal, problem.mu, problem.lower, c.cap);
  }
  return gap;
}

/// Plain projected gradient: slow and hard to get wrong.
Forces SolveSlowly(const ForceProblem& problem) {
  const Stacked stacked(problem);
  const double step = 0.5 / (stacked.A.squaredNorm() + problem.grip_weight);
  Forces x(problem.contacts.size(), Vector3d::Zero());
  for (int k = 0; k < 60000; ++k) {
    const Eigen::VectorXd g = stacked.Gradient(problem, x);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const ForceContact& c = problem.contacts[i];
      x[i] = ProjectOntoTruncatedCone(x[i] - step * g.segment<3>(3 * static_cast<Eigen::Index>(i)),
                                      c.inward_normal, problem.mu, problem.lower, c.cap);
    }
  }
  return x;
}

/// The forces after `calls` ticks with the same problem.
Forces SolveRepeatedly(ContactForceQp* qp, const ForceProblem& problem, int calls) {
  for (int k = 1; k < calls; ++k) qp->Solve(problem);
  return ToVector(qp->Solve(problem));
}

TEST(ContactForceQp, ForcesStayInTheirConesWhateverIsAsked) {
  RandomStream random(3, 0);
  ContactForceQp qp;  // one solver: its warm starts come from other problems
  for (int trial = 0; trial < 2000; ++trial) {
    ForceProblem problem = RandomProblem(&random, 1 + trial % kMaxFingers);
    problem.force *= 10;  // mostly out of reach
    problem.mu = Uniform(&random, 0.05, 1.0);
    const auto& forces = qp.Solve(problem);
    ASSERT_EQ(forces.size(), problem.contacts.size());
    for (std::size_t i = 0; i < forces.size(); ++i) {
      const ForceContact& c = problem.contacts[i];
      // A cap below the lower bound means the lower bound. 1e-12: rounding.
      ASSERT_LE(Violation(forces[i], c.inward_normal, problem.mu, problem.lower,
                          std::max(c.cap, problem.lower)),
                1e-12);
    }
  }
}

TEST(ContactForceQp, MeetsAFeasibleWrench) {
  RandomStream random(4, 0);
  for (int trial = 0; trial < 200; ++trial) {
    ForceProblem problem = RandomProblem(&random, 3 + trial % 3);
    problem.grip_weight = 0;  // nothing but the wrench
    problem.force.setZero();
    problem.torque.setZero();
    // The wrench of forces inside their cones: reachable by construction.
    for (ForceContact& c : problem.contacts) {
      c.cap = 4;
      const Vector3d f = ProjectOntoTruncatedCone(
          Uniform(&random, 0.3, 3.0) * c.inward_normal + 0.5 * random.Normal3(), c.inward_normal,
          0.4, 0.2, 3.5);
      problem.force += f;
      problem.torque += c.r.cross(f);
    }
    ContactForceQp qp;
    SolveRepeatedly(&qp, problem, 1000);
    // 30 000 iterations of a method whose objective falls at least like 2 L |x|² / k² (restarted
    // every 30): far below a thousandth of the weight of the reference object, 0.8 N.
    EXPECT_LT(qp.residual(), 1e-3) << "trial " << trial;
  }
}

TEST(ContactForceQp, ResidualIsWhatTheForcesMiss) {
  RandomStream random(5, 0);
  for (int trial = 0; trial < 100; ++trial) {
    const ForceProblem problem = RandomProblem(&random, 4);
    ContactForceQp qp;
    const Forces forces = ToVector(qp.Solve(problem));
    const Stacked stacked(problem);
    EXPECT_NEAR(qp.residual(), (stacked.A * Stacked::Join(forces) - stacked.b).norm(), 1e-12);
  }
}

TEST(ContactForceQp, ConvergesToTheOptimum) {
  RandomStream random(6, 0);
  for (int trial = 0; trial < 200; ++trial) {
    const ForceProblem problem = RandomProblem(&random, 2 + trial % 4);
    ContactForceQp qp;
    const Forces forces = SolveRepeatedly(&qp, problem, 300);
    // The objective is strongly convex with modulus 2 w = 0.04, so that a gap of 1e-8 N² bounds the
    // error of the forces by sqrt(1e-8 / 0.02) = 0.7 mN.
    EXPECT_LT(OptimalityGap(problem, forces), 1e-8) << "trial " << trial;
  }
}

TEST(ContactForceQp, AgreesWithASlowIndependentSolver) {
  RandomStream random(7, 0);
  for (int trial = 0; trial < 20; ++trial) {
    const ForceProblem problem = RandomProblem(&random, 3 + trial % 3);
    const Forces slow = SolveSlowly(problem);
    ASSERT_LT(OptimalityGap(problem, slow), 1e-8);  // the oracle itself has converged: 0.7 mN
    ContactForceQp qp;
    const Forces fast = SolveRepeatedly(&qp, problem, 300);
    for (std::size_t i = 0; i < fast.size(); ++i)
      EXPECT_LT((fast[i] - slow[i]).norm(), 2e-3) << "trial " << trial;  // twice 0.7 mN
  }
}

// What one tick delivers: the problem of the last tick, a little changed, from its warm start.
TEST(ContactForceQp, OneTickFollowsAMovingProblem) {
  RandomStream random(8, 0);
  double worst = 0;
  for (int trial = 0; trial < 50; ++trial) {
    ForceProblem problem = RandomProblem(&random, 5);
    ContactForceQp qp;
    SolveRepeatedly(&qp, problem, 100);
    const Vector3d drift = 2e-3 * RandomDirection(&random);  // 2 N/s, twice the weight in a second
    for (int tick = 0; tick < 200; ++tick) {
      problem.force += drift;
      const Forces forces = ToVector(qp.Solve(problem));
      const Stacked stacked(problem);
      ContactForceQp patient = qp;
      const Forces best = SolveRepeatedly(&patient, problem, 100);
      const double objective = stacked.Objective(problem, forces);
      worst = std::max(worst, objective - stacked.Objective(problem, best));
    }
  }
  // The part of the objective that lags, as a force: sqrt(1e-4) N = 0.01 N, 1 % of the grip force.
  EXPECT_LT(worst, 1e-4);
  RecordProperty("worst_lag_n2", std::to_string(worst));
}

TEST(ContactForceQp, ForgetsItsWarmStart) {
  RandomStream random(9, 0);
  for (int trial = 0; trial < 50; ++trial) {
    const ForceProblem other = RandomProblem(&random, 5), problem = RandomProblem(&random, 5);
    ContactForceQp warm, cold;
    warm.Solve(other);
    const Forces from_other = SolveRepeatedly(&warm, problem, 300);
    const Forces from_nothing = SolveRepeatedly(&cold, problem, 300);
    for (std::size_t i = 0; i < from_other.size(); ++i)
      EXPECT_LT((from_other[i] - from_nothing[i]).norm(), 2e-3);  // twice 0.7 mN, as above
    warm.Reset();
    ContactForceQp fresh;
    const Forces after_reset = ToVector(warm.Solve(problem)),
                 first = ToVector(fresh.Solve(problem));
    for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(after_reset[i], first[i]);
  }
}

// Warm starts belong to fingers, not to places in the list.
TEST(ContactForceQp, AFingerThatLeavesDoesNotDisturbTheOthersWarmStart) {
  RandomStream random(10, 0);
  const ForceProblem all = RandomProblem(&random, 5);
  ContactForceQp qp;
  SolveRepeatedly(&qp, all, 300);
  ForceProblem rest = all;
  rest.contacts.clear();
  for (const ForceContact& c : all.contacts)
    if (c.finger != 0) rest.contacts.push_back(c);
  ForceProblem reversed = rest;
  std::reverse(reversed.contacts.begin(), reversed.contacts.end());
  ContactForceQp other = qp;
  const Forces forward = ToVector(qp.Solve(rest)), backward = ToVector(other.Solve(reversed));
  // Sums in another order: rounding only, over 30 iterations.
  for (std::size_t i = 0; i < forward.size(); ++i)
    EXPECT_LT((forward[i] - backward[forward.size() - 1 - i]).norm(), 1e-12);
}

TEST(ContactForceQp, CapAndLowerBoundHoldAtTheirLimits) {
  RandomStream random(11, 0);
  ForceProblem problem = RandomProblem(&random, 5);
  for (ForceContact& c : problem.contacts) c.cap = c.grip = 0.3;
  problem.force = Vector3d(0, 0, 50);  // nobody can
  ContactForceQp qp;
  const Forces pushed = SolveRepeatedly(&qp, problem, 100);
  bool at_cap = false;
  for (std::size_t i = 0; i < pushed.size(); ++i) {
    const double n = pushed[i].dot(problem.contacts[i].inward_normal);
    EXPECT_LE(n, 0.3 + 1e-12);
    at_cap = at_cap || n > 0.3 - 1e-6;
  }
  EXPECT_TRUE(at_cap);
  EXPECT_GT(qp.residual(), 40);  // five times 0.3 N, friction included, is far below 10 N
  problem.force.setZero();
  for (ForceContact& c : problem.contacts) c.grip = 0;
  const Forces relaxed = SolveRepeatedly(&qp, problem, 100);
  for (std::size_t i = 0; i < relaxed.size(); ++i)
    EXPECT_GE(relaxed[i].dot(problem.contacts[i].inward_normal), problem.lower - 1e-12);
}

TEST(ContactForceQp, NoContactsGiveNoForces) {
  ForceProblem problem;
  problem.force = Vector3d(0, 0, 0.8);
  ContactForceQp qp;
  EXPECT_TRUE(qp.Solve(problem).empty());
  EXPECT_NEAR(qp.residual(), 0.8, 1e-15);
}

}  // namespace
}  // namespace regrasp
