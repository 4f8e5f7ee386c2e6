#include "core/sensing/noise.h"

#include <array>
#include <cmath>

#include "core/common/info_table.h"

namespace regrasp {
namespace {

constexpr double kDegree = M_PI / 180;

struct Preset {
  std::string_view name;
  NoiseLevels levels;
};

//                position  normal       force  joint          object position, rotation  taxels
//                rate  delay
constexpr std::array<Preset, 5> kPresets{{
    {"off", {}},
    {"fine", {0.5e-3, 1 * kDegree, 0.02, 0.1 * kDegree, 0.5e-3, 0.5 * kDegree, 0, 0, 0}},
    {"paper", {1e-3, 2 * kDegree, 0.05, 0.3 * kDegree, 1e-3, 1 * kDegree, 0, 0, 0}},
    {"coarse", {2e-3, 4 * kDegree, 0.1, 0.6 * kDegree, 5e-3, 4.6 * kDegree, 0, 0, 0}},
    {"taxel", {0, 0, 0.1, 0.6 * kDegree, 5e-3, 5 * kDegree, 6.6e-3, 15, 1}},
}};

constexpr auto kNames = NamesOf<kPresets.size()>(kPresets);

}  // namespace

std::span<const std::string_view> NoisePresetNames() { return kNames; }

std::optional<NoiseLevels> NoisePreset(std::string_view name) {
  for (const Preset& preset : kPresets)
    if (preset.name == name) return preset.levels;
  return std::nullopt;
}

std::string_view NoiseName(const NoiseLevels& levels) {
  for (const Preset& preset : kPresets)
    if (preset.levels == levels) return preset.name;
  return "custom";
}

}  // namespace regrasp
