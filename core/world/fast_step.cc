#include "core/world/fast_step.h"

#include <ode/ode.h>

#include <Eigen/Cholesky>
#include <cmath>

namespace regrasp {
namespace {

Vector3d ToVector(const dReal* v) { return {v[0], v[1], v[2]}; }

// Free rotation by one implicit step of Euler's equations in the body frame [Catto, GDC 2015].
Vector3d Gyroscopic(const Matrix3d& R, const Matrix3d& I, const Vector3d& w_W, double dt) {
  const auto cross = [](const Vector3d& v) {
    Matrix3d M;
    M << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return M;
  };
  Vector3d w = R.transpose() * w_W;
  const Vector3d residual = dt * w.cross(I * w);
  const Matrix3d J = I + dt * (cross(w) * I - cross(I * w));
  w -= J.inverse() * residual;
  return R * w;
}

}  // namespace

FastStep::FastStep(const HandModel& hand, const Articulation& articulation,
                   const ObjectModel& object, const WorldConfig& config,
                   const std::vector<Following>& following)
    : object_(object), config_(config), dynamics_(hand, articulation, following) {
  const double hk = config.dt * config.contact_stiffness;
  contact_erp_ = hk / (hk + config.contact_damping);
  contact_softness_ = 1.0 / (hk + config.contact_damping);
}

const KinematicsData& FastStep::SetPosture(const JointVector& q) {
  dynamics_.SetPosture(q);
  return dynamics_.kinematics();
}

void FastStep::FreeMotion(const Load& load, const WorldState& state) {
  // (M + dt D) (qdot' - qdot) = dt (tau - b - D qdot): damping D acts at the rate after the step.
  dynamics_.Update(state.qdot, load.gravity_W, config_.dt * load.damping);
  rate_ = dynamics_.Fold(load.torque - load.damping.cwiseProduct(state.qdot)) - dynamics_.bias();
  dynamics_.Solve(&rate_);
  rate_ = dynamics_.Driven(state.qdot) + config_.dt * rate_;

  R_WO_ = state.q_WO.toRotationMatrix();
  v_.setZero();
  w_.setZero();
  root_mass_inverse_ = 0;
  root_inertia_inverse_.setZero();
  if (load.held) return;
  const Matrix3d I = object_.I_OCom * (load.mass / object_.mass);
  v_ = state.v_WO + config_.dt * (load.gravity_W + load.push_W / load.mass);
  w_ = Gyroscopic(R_WO_, I, state.w_WO, config_.dt);
  root_mass_inverse_ = 1.0 / std::sqrt(load.mass);
  root_inertia_inverse_ = I.llt().matrixL().solve(R_WO_.transpose());
}

// Rows of a contact: the speed of the object over the link along the normal (into the object) and
// the two axes of the friction pyramid.
void FastStep::MakeObjectRows(const FixedVector<ObjectHit, kMaxObjectContacts>& hits,
                              const WorldState& state) {
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const ObjectHit& hit = hits[i];
    const int row = 3 * static_cast<int>(i);
    auto& axes = axes_W_[i];
    dVector3 t1, t2;
    dPlaneSpace(hit.geom.normal, t1, t2);
    axes = {ToVector(hit.geom.normal), ToVector(t1), ToVector(t2)};
    const Vector3d p = ToVector(hit.geom.pos);
    const Vector3d r = p - state.p_WO;
    dynamics_.MakeRows(hit.link, p, -1.0, rate_, 3, axes.data(), &hand_rows_[row],
                       &solver_.rate[row]);
    for (int k = 0; k < 3; ++k) {
      const Vector3d turn = r.cross(axes[k]);
      object_rows_[row + k] << root_mass_inverse_ * axes[k], root_inertia_inverse_ * turn;
      solver_.rate[row + k] += axes[k].dot(v_) + turn.dot(w_);
      solver_.softness[row + k] = k == 0 ? contact_softness_ : config_.joint_cfm;
      solver_.normal[row + k] = k == 0 ? -1 : row;
      solver_.force[row + k] = axes[k].dot(state.contacts[i].force_W);
    }
    solver_.rate[row] -= contact_erp_ / config_.dt * hit.geom.depth;
  }
}

// Links slide on each other without friction: one row each.
void FastStep::MakeLinkRows(const FixedVector<LinkHit, kMaxLinkHits>& hits, int first) {
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const LinkHit& hit = hits[i];
    const int row = first + static_cast<int>(i);
    const Vector3d p = ToVector(hit.geom.pos), n = ToVector(hit.geom.normal);
    HandDynamics::Row other;
    double other_rate = 0;
    dynamics_.MakeRows(hit.link_a, p, 1.0, rate_, 1, &n, &hand_rows_[row], &solver_.rate[row]);
    dynamics_.MakeRows(hit.link_b, p, -1.0, rate_, 1, &n, &other, &other_rate);
    HandDynamics::Add(other, &hand_rows_[row]);
    solver_.rate[row] += other_rate - contact_erp_ / config_.dt * hit.geom.depth;
    solver_.softness[row] = contact_softness_;
    solver_.normal[row] = -1;
    solver_.force[row] = 0;
  }
}

void FastStep::FillMatrix() {
  for (int r = 0; r < solver_.rows(); ++r)
    for (int s = 0; s <= r; ++s) {
      double rate = HandDynamics::Dot(hand_rows_[r], hand_rows_[s]);
      if (r < object_row_count_) rate += object_rows_[r].dot(object_rows_[s]);
      solver_.A(r, s) = solver_.A(s, r) = config_.dt * rate;
    }
}

void FastStep::Integrate(WorldState* state) {
  const double dt = config_.dt;
  JointVector impulse = JointVector::Zero(rate_.size());
  Vector6d object_impulse = Vector6d::Zero();
  for (int r = 0; r < solver_.rows(); ++r) {
    HandDynamics::Accumulate(hand_rows_[r], dt * solver_.force[r], &impulse);
    if (r < object_row_count_) object_impulse += dt * solver_.force[r] * object_rows_[r];
  }
  dynamics_.Finish(&impulse);
  dynamics_.Move(rate_ + impulse, dt, &state->q, &state->qdot);
  state->v_WO = v_ + root_mass_inverse_ * object_impulse.head<3>();
  state->w_WO = w_ + root_inertia_inverse_.transpose() * object_impulse.tail<3>();
  state->p_WO += dt * state->v_WO;
  state->q_WO = (FromRotationVector(dt * state->w_WO) * state->q_WO).normalized();
}

const KinematicsData& FastStep::Advance(const Load& load,
                                        const FixedVector<ObjectHit, kMaxObjectContacts>& hits,
                                        const FixedVector<LinkHit, kMaxLinkHits>& link_hits,
                                        WorldState* state) {
  FreeMotion(load, *state);
  object_row_count_ = 3 * static_cast<int>(hits.size());
  solver_.Resize(object_row_count_ + static_cast<int>(link_hits.size()));
  MakeObjectRows(hits, *state);
  MakeLinkRows(link_hits, object_row_count_);
  FillMatrix();
  sweeps_ =
      solver_.Solve(load.friction, config_.stepper == Stepper::kRound, config_.contact_solver);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const auto& axes = axes_W_[i];
    Vector3d& force_W = state->contacts[i].force_W;
    force_W.setZero();
    for (int k = 0; k < 3; ++k) force_W += solver_.force[3 * static_cast<int>(i) + k] * axes[k];
  }
  Integrate(state);
  return SetPosture(state->q);
}

}  // namespace regrasp
