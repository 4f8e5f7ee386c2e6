#pragma once

/// Colours and marks with one meaning in every picture. The hues are those of Okabe and Ito (2008),
/// which readers with any of the common colour deficiencies can tell apart; every distinction that
/// matters is also made by dash or marker.

#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/session/frame.h"

namespace regrasp {

struct Colour {
  std::uint8_t r = 0, g = 0, b = 0;
  bool operator==(const Colour&) const = default;
};

inline constexpr Colour kOrange{230, 159, 0}, kSkyBlue{86, 180, 233}, kGreen{0, 158, 115},
    kYellow{240, 228, 66}, kBlue{0, 114, 178}, kVermillion{213, 94, 0}, kPurple{204, 121, 167};
inline constexpr Colour kWhite{255, 255, 255}, kInk{25, 25, 25}, kGrey{105, 105, 105},
    kLightGrey{190, 190, 190}, kGridGrey{226, 226, 226};

/// `colour` moved towards white: amount 0 leaves it, 1 makes it white.
inline Colour Tint(Colour colour, double amount) {
  const auto mix = [amount](std::uint8_t c) {
    return static_cast<std::uint8_t>(std::lround(c + (255 - c) * amount));
  };
  return {mix(colour.r), mix(colour.g), mix(colour.b)};
}
/// `colour` moved towards black: amount 0 leaves it, 1 makes it black.
inline Colour Shade(Colour colour, double amount) {
  const auto mix = [amount](std::uint8_t c) {
    return static_cast<std::uint8_t>(std::lround(c * (1 - amount)));
  };
  return {mix(colour.r), mix(colour.g), mix(colour.b)};
}

enum class Marker : std::uint8_t {
  kDisc,
  kSquare,
  kUp,
  kDiamond,
  kDown,
  kCross,
  kPlus,
  kStar,
  kRing,
  kRight
};

/// Look of one finger; `finger` is its index in the hand model.
struct FingerLook {
  Colour colour;
  Marker marker;
  std::vector<double> dash;  ///< lengths of stroke and gap in turn; empty = solid
};
inline FingerLook LookOfFinger(int finger) {
  static constexpr std::array<Colour, kMaxFingers> kColours = {
      kBlue,   kGreen,   kVermillion,         kPurple,
      kOrange, kSkyBlue, Colour{120, 94, 20}, Colour{60, 60, 60}};
  const auto i = static_cast<std::size_t>(finger < 0 ? 0 : finger) % kMaxFingers;
  static const std::array<std::vector<double>, 5> kDashes = {
      std::vector<double>{}, {12, 5}, {3, 4}, {12, 4, 3, 4}, {20, 4}};
  return {kColours[i], static_cast<Marker>(i), kDashes[i % kDashes.size()]};
}

/// Band colour of a state of the session: pale, for backgrounds.
inline Colour StateColour(SessionState state) {
  // In the order of the table of jobs; the last are for jobs to come.
  static const std::array<Colour, 8> kJobColours = {
      Tint(kYellow, 0.62), Colour{225, 225, 225}, Tint(kOrange, 0.68), Tint(kGreen, 0.74),
      Tint(kPurple, 0.74), Tint(kBlue, 0.72),     Tint(kInk, 0.72),    Tint(kOrange, 0.4)};
  static_assert(kJobTable.size() <= 8);
  if (const JobInfo* job = FindJob(&JobInfo::state, state))
    return kJobColours[static_cast<std::size_t>(job->id)];
  switch (state) {
    case SessionState::kIdle:
      return {240, 240, 240};
    case SessionState::kHolding:
      return Tint(kSkyBlue, 0.72);
    case SessionState::kDropped:
      return Tint(kVermillion, 0.45);
    case SessionState::kFaulted:
      return Tint(kInk, 0.35);
    default:
      return kWhite;
  }
}

}  // namespace regrasp
