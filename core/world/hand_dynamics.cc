#include "core/world/hand_dynamics.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace regrasp {

HandDynamics::HandDynamics(const HandModel& hand, const Articulation& articulation,
                           const std::vector<Following>& following)
    : hand_(hand),
      n_(static_cast<int>(hand.joints.size())),
      driven_(n_),
      following_(following),
      bodies_(articulation.bodies) {
  body_.assign(static_cast<std::size_t>(n_), -1);
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    body_[hand.links[bodies_[b].link].parent_joint] = static_cast<int>(b);
  for (int i = 0; i < n_; ++i) {
    const int parent = hand.links[hand.joints[i].parent_link].parent_joint;
    parent_.push_back(parent);
    chain_.push_back((parent >= 0 ? chain_[parent] : 0u) | (1u << i));
  }
  folded_ = false;
  if (!following_.empty()) {
    driven_ = 0;
    for (const Following& f : following_) driven_ = std::max(driven_, f.driven + 1);
    folded_ = driven_ < n_;
  }
  above_ = parent_;
  if (folded_) {  // a driver may have followers in several fingers: all may couple
    above_.resize(static_cast<std::size_t>(driven_));
    for (int i = 0; i < driven_; ++i) above_[i] = i - 1;
  }
  bias_ = JointVector::Zero(driven_);
  factor_.setZero();
}

JointVector HandDynamics::Fold(const JointVector& torque) const {
  if (!folded_) return torque;
  JointVector folded = JointVector::Zero(driven_);
  for (int i = 0; i < n_; ++i) folded[following_[i].driven] += following_[i].ratio * torque[i];
  return folded;
}

JointVector HandDynamics::Driven(const JointVector& all) const {
  if (!folded_) return all;
  JointVector driven = JointVector::Zero(driven_);
  for (int i = 0; i < n_; ++i)
    if (following_[i].ratio == 1 && following_[i].offset == 0)
      driven[following_[i].driven] = all[i];
  return driven;
}

void HandDynamics::Move(const JointVector& rate, double dt, JointVector* q,
                        JointVector* qdot) const {
  if (!folded_) {
    *qdot = rate;
    *q += dt * rate;
    return;
  }
  JointVector angle = Driven(*q);
  angle += dt * rate;
  for (int i = 0; i < n_; ++i) {
    const Following& f = following_[i];
    (*q)[i] = f.ratio * angle[f.driven] + f.offset;
    (*qdot)[i] = f.ratio * rate[f.driven];
  }
}

void HandDynamics::SetPosture(const JointVector& q) { ForwardKinematics(hand_, q, &kinematics_); }

void HandDynamics::Update(const JointVector& qdot, const Vector3d& gravity_W,
                          const JointVector& extra) {
  JointVector bias = JointVector::Zero(n_);
  const Vector3d zero = Vector3d::Zero(), fall = -gravity_W;
  for (int i = 0; i < n_; ++i) {
    const Vector3d& axis = kinematics_.axis_W[i];
    lever_[i] = kinematics_.p_WJ[i].cross(axis);
    const int p = parent_[i];
    const Vector3d &w = p >= 0 ? w_[p] : zero, &v = p >= 0 ? v_[p] : zero;
    w_[i] = w + axis * qdot[i];
    v_[i] = v + lever_[i] * qdot[i];
    alpha_[i] = (p >= 0 ? alpha_[p] : zero) + w.cross(axis) * qdot[i];
    a_[i] = (p >= 0 ? a_[p] : fall) + (w.cross(lever_[i]) + v.cross(axis)) * qdot[i];
    inertia_[i] = Inertia();
    force_[i].setZero();
    torque_[i].setZero();
    if (body_[i] < 0) continue;
    const BodyPlan& body = bodies_[body_[i]];
    const Isometry3d& X_WL = kinematics_.X_WL[body.link];
    const Vector3d c = X_WL * body.p_LB;
    const Matrix3d I = X_WL.linear() * body.I_B * X_WL.linear().transpose();
    const Vector3d a_c = a_[i] + alpha_[i].cross(c) + w_[i].cross(v_[i] + w_[i].cross(c));
    force_[i] = body.mass * a_c;
    torque_[i] = I * alpha_[i] + c.cross(force_[i]);
    inertia_[i].mass = body.mass;
    inertia_[i].moment = body.mass * c;
    inertia_[i].J = I;
    inertia_[i].J.diagonal().array() += body.mass * c.squaredNorm();
    inertia_[i].J.noalias() -= body.mass * c * c.transpose();
  }
  for (int i = n_ - 1; i >= 0; --i) {
    const Vector3d& axis = kinematics_.axis_W[i];
    bias[i] = axis.dot(torque_[i]) + lever_[i].dot(force_[i]);
    const Inertia& I = inertia_[i];
    const Vector3d f = I.mass * lever_[i] + axis.cross(I.moment);
    const Vector3d n = I.J * axis + I.moment.cross(lever_[i]);
    for (int j = i; j >= 0; j = parent_[j])
      factor_(i, j) = kinematics_.axis_W[j].dot(n) + lever_[j].dot(f);
    const int p = parent_[i];
    if (p < 0) continue;
    inertia_[p].mass += I.mass;
    inertia_[p].moment += I.moment;
    inertia_[p].J += I.J;
    force_[p] += force_[i];
    torque_[p] += torque_[i];
  }
  for (int i = 0; i < n_; ++i) factor_(i, i) += extra[i];
  bias_ = Fold(bias);
  if (folded_) FoldMassMatrix();
  Factorise();
}

// The lower half of Gᵀ M G from the entries of M that chains couple.
void HandDynamics::FoldMassMatrix() {
  Eigen::Matrix<double, kMaxJoints, kMaxJoints> folded;
  folded.setZero();
  for (int i = 0; i < n_; ++i)
    for (int j = i; j >= 0; j = parent_[j]) {
      const Following &a = following_[i], &b = following_[j];
      const double m = a.ratio * b.ratio * factor_(i, j);
      folded(a.driven, b.driven) += m;
      if (i != j) folded(b.driven, a.driven) += m;
    }
  factor_.template triangularView<Eigen::Lower>() = folded;
}

// M = LᵀL in place; only joints that `above_` leads to couple.
void HandDynamics::Factorise() {
  for (int k = driven_ - 1; k >= 0; --k) {
    factor_(k, k) = std::sqrt(factor_(k, k));
    inverse_diagonal_[k] = 1.0 / factor_(k, k);
    for (int i = above_[k]; i >= 0; i = above_[i]) factor_(k, i) *= inverse_diagonal_[k];
    for (int i = above_[k]; i >= 0; i = above_[i])
      for (int j = i; j >= 0; j = above_[j]) factor_(i, j) -= factor_(k, i) * factor_(k, j);
  }
}

void HandDynamics::Transpose(std::uint32_t joints, double* x) const {
  while (joints != 0) {
    const int i = 31 - std::countl_zero(joints);
    joints &= ~(1u << i);
    x[i] *= inverse_diagonal_[i];
    for (int j = above_[i]; j >= 0; j = above_[j]) x[j] -= factor_(i, j) * x[i];
  }
}

void HandDynamics::Finish(JointVector* x) const {
  for (int i = 0; i < driven_; ++i) {
    double sum = (*x)[i];
    for (int j = above_[i]; j >= 0; j = above_[j]) sum -= factor_(i, j) * (*x)[j];
    (*x)[i] = sum * inverse_diagonal_[i];
  }
}

void HandDynamics::Solve(JointVector* x) const {
  for (int i = driven_ - 1; i >= 0; --i) {
    (*x)[i] *= inverse_diagonal_[i];
    for (int j = above_[i]; j >= 0; j = above_[j]) (*x)[j] -= factor_(i, j) * (*x)[i];
  }
  Finish(x);
}

void HandDynamics::MakeRows(int link, const Vector3d& p_W, double sign, const JointVector& qdot,
                            int count, const Vector3d* axes_W, Row* rows, double* rate) const {
  const int tip = hand_.links[link].parent_joint;
  for (int k = 0; k < count; ++k) {
    rows[k].joints = tip < 0 ? 0u : folded_ ? ~0u >> (32 - driven_) : chain_[tip];
    rate[k] = 0;
    if (folded_) std::fill_n(rows[k].y.begin(), driven_, 0.0);
  }
  for (int j = tip; j >= 0; j = parent_[j]) {
    const Vector3d moved = sign * kinematics_.axis_W[j].cross(p_W - kinematics_.p_WJ[j]);
    for (int k = 0; k < count; ++k) {
      const double along = axes_W[k].dot(moved);
      if (folded_) {
        const Following& f = following_[j];
        rows[k].y[f.driven] += f.ratio * along;
        rate[k] += f.ratio * along * qdot[f.driven];
      } else {
        rows[k].y[j] = along;
        rate[k] += along * qdot[j];
      }
    }
  }
  for (int k = 0; k < count; ++k) Transpose(rows[k].joints, rows[k].y.data());
}

void HandDynamics::Add(const Row& b, Row* a) {
  for (std::uint32_t rest = b.joints; rest != 0; rest &= rest - 1) {
    const int i = std::countr_zero(rest);
    a->y[i] = (a->joints >> i & 1u ? a->y[i] : 0.0) + b.y[i];
  }
  a->joints |= b.joints;
}

double HandDynamics::Dot(const Row& a, const Row& b) {
  double sum = 0;
  for (std::uint32_t rest = a.joints & b.joints; rest != 0; rest &= rest - 1) {
    const int i = std::countr_zero(rest);
    sum += a.y[i] * b.y[i];
  }
  return sum;
}

void HandDynamics::Accumulate(const Row& row, double size, JointVector* impulse) {
  for (std::uint32_t rest = row.joints; rest != 0; rest &= rest - 1) {
    const int i = std::countr_zero(rest);
    (*impulse)[i] += size * row.y[i];
  }
}

}  // namespace regrasp
