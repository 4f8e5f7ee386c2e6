#include "core/sensing/sensors.h"

#include <algorithm>
#include <cmath>

namespace regrasp {
namespace {

constexpr double kContactForce = 0.01;  // [N]

// Stream numbers of a run; far from the small numbers that other parts may use.
enum Stream : std::uint64_t {
  kPositionStream = 0x5e4500,
  kNormalStream,
  kForceStream,
  kJointStream,
  kPosePositionStream,
  kPoseRotationStream,
  kBiasStream,
  kObjectDriftStream,
};

/// Index of the period of length 1/rate that contains the tick. The slack lets a period that begins
/// exactly at a tick begin there in spite of rounding.
std::int64_t PeriodIndex(std::int64_t tick, double dt, double rate_hz) {
  return static_cast<std::int64_t>(std::floor(static_cast<double>(tick) * dt * rate_hz + 1e-6));
}

/// `n` turned by the rotation vector a t1 + b t2 in its tangent plane; exactly `n` for a = b = 0.
Vector3d Tilted(const Vector3d& n, double a, double b) {
  const double angle = std::hypot(a, b);
  if (angle == 0) return n;
  const Matrix3d R = RotationFromZ(n);
  const Vector3d direction = (b * R.col(0) - a * R.col(1)) / angle;
  return (std::cos(angle) * n + std::sin(angle) * direction).normalized();
}

}  // namespace

FingertipReading TrueFingertip(const WorldState& truth, int finger) {
  FingertipReading mean;
  Vector3d p = Vector3d::Zero(), n = Vector3d::Zero(), f = Vector3d::Zero();
  double weight = 0;
  int count = 0;
  for (const ObjectContact& contact : truth.contacts) {
    const double pressure = -contact.force_W.dot(contact.normal_W);
    if (contact.finger != finger || !(pressure > 0)) continue;
    if (++count == 1) {
      mean.p_WC = contact.p_WC;
      mean.normal_W = contact.normal_W;
      mean.force = pressure;
    }
    weight += pressure;
    p += pressure * contact.p_WC;
    n += pressure * contact.normal_W;
    f += contact.force_W;
  }
  if (count > 1) {
    mean.p_WC = p / weight;
    if (n.norm() > 1e-9 * weight) mean.normal_W = n.normalized();
    mean.force = std::max(0.0, -f.dot(mean.normal_W));
  }
  mean.in_contact = mean.force > kContactForce;
  return mean;
}

Sensors::Sensors(const HandModel& hand, double dt, std::uint64_t seed) : hand_(&hand), dt_(dt) {
  Reseed(seed);
  for (int f = 0; f < hand.num_fingers(); ++f) tips_[f] = MakeTipAxes(hand, f);
  reading_.fingertips.resize(static_cast<std::size_t>(hand.num_fingers()));
  reading_.q = JointVector::Zero(hand.num_joints());
}

void Sensors::Reseed(std::uint64_t seed) {
  position_stream_ = RandomStream(seed, kPositionStream);
  normal_stream_ = RandomStream(seed, kNormalStream);
  force_stream_ = RandomStream(seed, kForceStream);
  joint_stream_ = RandomStream(seed, kJointStream);
  pose_position_stream_ = RandomStream(seed, kPosePositionStream);
  pose_rotation_stream_ = RandomStream(seed, kPoseRotationStream);
  object_drift_stream_ = RandomStream(seed, kObjectDriftStream);
  RandomStream biases(seed, kBiasStream);
  object_bias_ = biases.Normal3();
  joint_biases_.resize(hand_->num_joints());
  for (double& bias : joint_biases_) bias = biases.Normal();
  for (int f = 0; f < hand_->num_fingers(); ++f) errors_[f].Reseed(seed, f);
}

void Sensors::SetNoise(const NoiseLevels& levels) {
  if (levels.object_rate_hz != levels_.object_rate_hz ||
      levels.object_delay_frames != levels_.object_delay_frames) {
    num_pose_frames_ = 0;
    last_pose_frame_ = -1;
  }
  levels_ = levels;
}

const SensorReading& Sensors::Read(std::int64_t tick, const WorldState& truth) {
  reading_.tick = tick;
  reading_.object_rate_hz = levels_.object_rate_hz;
  reading_.taxel_pitch_m = levels_.taxel_pitch_m;
  const std::int64_t sample = PeriodIndex(tick, dt_, kSensorRateHz);
  if (sample == last_sample_) return reading_;
  last_sample_ = sample;

  ReadFingertips(truth);
  for (int j = 0; j < hand_->num_joints(); ++j)
    reading_.q[j] = truth.q[j] + levels_.joint_bias_rad * joint_biases_[j] +
                    levels_.joint_rad * joint_stream_.Normal();
  ReadObject(tick, truth);
  return reading_;
}

void Sensors::ReadFingertips(const WorldState& truth) {
  const bool systematic = levels_.systematic();
  if (levels_.taxel_pitch_m > 0 || systematic) ForwardKinematics(*hand_, truth.q, &kinematics_);
  for (int f = 0; f < hand_->num_fingers(); ++f) {
    const Vector3d position_noise = levels_.position_m * position_stream_.Normal3();
    const double tilt_a = levels_.normal_rad * normal_stream_.Normal();
    const double tilt_b = levels_.normal_rad * normal_stream_.Normal();
    const double force_noise = levels_.force_n * force_stream_.Normal();

    FingertipReading& out = reading_.fingertips[f];
    out = TrueFingertip(truth, f);
    const Isometry3d& X_WL = kinematics_.X_WL[hand_->fingers[f].tip_link];
    if (!out.in_contact) {
      out = FingertipReading{};
      errors_[f].Apply(levels_, X_WL, SampleTime(dt_), &out);
      continue;
    }
    out.p_WC += position_noise;
    out.force = std::max(0.0, out.force + force_noise);
    if (levels_.taxel_pitch_m > 0) {
      const Vector3d p_LC = X_WL.inverse() * out.p_WC;
      const auto taxels = MakeTaxels(tips_[f], levels_.taxel_pitch_m);
      const Taxel& nearest = NearestTaxel(taxels, p_LC);
      out.p_WC = X_WL * nearest.p_LT;
      out.normal_W = -(X_WL.linear() * nearest.outward_L).normalized();
    }
    out.normal_W = Tilted(out.normal_W, tilt_a, tilt_b);
    errors_[f].Apply(levels_, X_WL, SampleTime(dt_), &out);
  }
}

void Sensors::ReadObject(std::int64_t tick, const WorldState& truth) {
  const Vector3d translation = levels_.object_position_m * pose_position_stream_.Normal3();
  const Vector3d rotation = levels_.object_rotation_rad * pose_rotation_stream_.Normal3();
  if (levels_.object_drift_m > 0)
    object_drift_ +=
        levels_.object_drift_m * std::sqrt(SampleTime(dt_)) * object_drift_stream_.Normal3();
  if (levels_.object_rate_hz > 0) {
    const std::int64_t frame = PeriodIndex(tick, dt_, levels_.object_rate_hz);
    if (frame == last_pose_frame_) return;
    last_pose_frame_ = frame;
  }
  const int kept = levels_.object_rate_hz > 0
                       ? std::clamp(levels_.object_delay_frames, 0, kMaxPoseDelay) + 1
                       : 1;
  for (int i = kept - 1; i > 0; --i) pose_frames_[i] = pose_frames_[i - 1];
  num_pose_frames_ = std::min(num_pose_frames_ + 1, kept);
  Pose& newest = pose_frames_[0];
  newest.tick = tick;
  newest.p = truth.p_WO + translation + levels_.object_bias_m * object_bias_ + object_drift_;
  newest.q = truth.q_WO;
  if (rotation != Vector3d::Zero())
    newest.q = (FromRotationVector(rotation) * truth.q_WO).normalized();
  const Pose& reported = pose_frames_[num_pose_frames_ - 1];
  reading_.p_WO = reported.p;
  reading_.q_WO = reported.q;
  reading_.object_tick = reported.tick;
}

}  // namespace regrasp
