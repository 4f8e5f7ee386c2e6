#include "core/sensing/fingertip_errors.h"

#include <algorithm>
#include <cmath>

namespace regrasp {
namespace {

constexpr std::uint64_t kErrorStream = 0x5e4600;  // and one for each finger after it

FingertipReading Moved(const FingertipReading& reading, const Isometry3d& X) {
  FingertipReading moved = reading;
  if (!reading.in_contact) return moved;
  moved.p_WC = X * reading.p_WC;
  moved.normal_W = X.linear() * reading.normal_W;
  return moved;
}

}  // namespace

void FingertipErrors::Reseed(std::uint64_t seed, int finger) {
  stream_ = RandomStream(seed, kErrorStream + static_cast<std::uint64_t>(finger));
  bias_L_ = stream_.Normal3();
  force_bias_ = stream_.Normal();
}

void FingertipErrors::Apply(const NoiseLevels& levels, const Isometry3d& X_WL, double sample_s,
                            FingertipReading* reading) {
  if (!levels.systematic()) return;
  if (levels.position_drift_m > 0)
    drift_L_ += levels.position_drift_m * std::sqrt(sample_s) * stream_.Normal3();
  if (levels.force_drift_n > 0)
    force_drift_ += levels.force_drift_n * std::sqrt(sample_s) * stream_.Normal();
  if (levels.dropout > 0) {
    // Gaps and the times between them are geometric; their means give the share of gaps.
    const double gap = std::max(levels.dropout_gap_s, sample_s);
    const double ends = sample_s / gap, begins = ends * levels.dropout / (1 - levels.dropout);
    out_ = stream_.Uniform() < (out_ ? 1 - ends : std::min(1.0, begins));
  } else {
    out_ = false;
  }
  if (reading->in_contact) {
    reading->p_WC += X_WL.linear() * (levels.position_bias_m * bias_L_ + drift_L_);
    reading->force =
        std::max(0.0, reading->force + levels.force_bias_n * force_bias_ + force_drift_);
  }
  if (levels.latency_s > 0) {
    const auto behind = static_cast<std::size_t>(
        std::clamp<long>(std::lround(levels.latency_s / sample_s), 0, kMaxLatencySamples));
    if (late_L_.size() > behind) {
      std::move(late_L_.end() - static_cast<std::ptrdiff_t>(behind), late_L_.end(),
                late_L_.begin());
      late_L_.resize(behind);
    }
    late_L_.push_back(Moved(*reading, X_WL.inverse()));
    *reading = Moved(late_L_[0], X_WL);
  } else {
    late_L_.resize(0);
  }
  if (out_) *reading = FingertipReading{};
}

}  // namespace regrasp
