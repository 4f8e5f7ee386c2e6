#pragma once

/// Seeded random numbers that are the same on every machine: xoshiro256++ seeded by SplitMix64, and
/// a polar normal sampler of our own (std::normal_distribution differs between standard libraries).

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>

namespace regrasp {

/// One step of SplitMix64 [Steele, Lea, Flood 2014]; advances `state`.
inline std::uint64_t SplitMix64(std::uint64_t& state) {
  std::uint64_t z = (state += 0x9e3779b97f4a7c15ULL);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

/// xoshiro256++ 1.0 [Blackman, Vigna 2019]. Trivially copyable: copying it copies the stream.
class RandomStream {
 public:
  RandomStream() : RandomStream(0, 0) {}
  /// Stream number `stream` of the run with this seed. Streams of one seed are independent.
  RandomStream(std::uint64_t seed, std::uint64_t stream) {
    std::uint64_t mix = seed;
    std::uint64_t state = SplitMix64(mix) ^ (0xd1342543de82ef95ULL * (stream + 1));
    for (auto& word : s_) word = SplitMix64(state);
  }
  std::uint64_t NextBits() {
    const std::uint64_t result = Rotl(s_[0] + s_[3], 23) + s_[0];
    const std::uint64_t t = s_[1] << 17;
    s_[2] ^= s_[0];
    s_[3] ^= s_[1];
    s_[1] ^= s_[2];
    s_[0] ^= s_[3];
    s_[2] ^= t;
    s_[3] = Rotl(s_[3], 45);
    return result;
  }
  /// Uniform in [0, 1).
  double Uniform() { return static_cast<double>(NextBits() >> 11) * 0x1.0p-53; }
  /// Standard normal, Marsaglia's polar method.
  double Normal() {
    if (has_spare_) {
      has_spare_ = 0;
      return spare_;
    }
    double u, v, s;
    do {
      u = 2.0 * Uniform() - 1.0;
      v = 2.0 * Uniform() - 1.0;
      s = u * u + v * v;
    } while (s >= 1.0 || s == 0.0);
    const double scale = std::sqrt(-2.0 * std::log(s) / s);
    spare_ = v * scale;
    has_spare_ = 1;
    return u * scale;
  }
  /// Three independent standard normals.
  Eigen::Vector3d Normal3() {
    const double x = Normal(), y = Normal(), z = Normal();
    return {x, y, z};
  }
  template <typename V>
  void Fields(V& v) {
    v("s", s_);
    v("spare", spare_);
    v("has_spare", has_spare_);
  }

 private:
  static std::uint64_t Rotl(std::uint64_t x, int k) { return (x << k) | (x >> (64 - k)); }
  std::array<std::uint64_t, 4> s_{};
  double spare_ = 0.0;
  std::uint64_t has_spare_ = 0;
};

}  // namespace regrasp
