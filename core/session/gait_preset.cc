/// What gait.preset sets.
#include <algorithm>
#include <array>

#include "core/session/parameters.h"

namespace regrasp {
namespace {

/// What gait.preset sets besides itself for the paper's gait; for the planned one the defaults.
struct PaperValue {
  std::string_view name;
  double value;
};
constexpr auto kPaperGait = std::to_array<PaperValue>({
    {"gait.mode", static_cast<double>(GaitMode::kExploring)},
    {"gait.plan", 0},
    {"gait.forgive", 0},
    {"gait.margin_min", 0.10},
    {"gait.max_excursion", 0.016},
    {"gait.along_speed", 0},
    {"gait.explore", static_cast<double>(GaitExplore::kAlways)},
    {"gait.explore_s", 0.5},
});

}  // namespace

bool IsPreset(const ParameterInfo& info) { return info.name == "gait.preset"; }

bool IsSetByPreset(const ParameterInfo& info) {
  return std::any_of(kPaperGait.begin(), kPaperGait.end(),
                     [&](const PaperValue& row) { return row.name == info.name; });
}

void SetByUser(const ParameterInfo& info, const Vector3d& value, Parameters* parameters) {
  info.set(parameters, value);
  if (!IsPreset(info)) return;
  const bool paper = parameters->gait.preset == GaitPreset::kPaper;
  const Parameters planned;
  for (const PaperValue& row : kPaperGait) {
    const ParameterInfo& other =
        ParameterTable()[static_cast<std::size_t>(FindParameter(row.name))];
    other.set(parameters, paper ? Vector3d(row.value, 0, 0) : other.get(planned));
  }
}

}  // namespace regrasp
