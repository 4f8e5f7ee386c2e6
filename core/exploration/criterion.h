#pragma once

/// What a finger may maximise while it explores, as one table: the command line, the wire and the
/// documentation follow from it. A new criterion is an entry, a row, and what Objective() computes
/// (objective.cc).

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace regrasp {

/// In the order of the table.
enum class Criterion : std::uint8_t { kManipulability, kStability, kSwitched, kCombined, kReserve };
inline constexpr Criterion kLastCriterion = Criterion::kReserve;

struct CriterionInfo {
  Criterion id;
  std::string_view name;
  std::string_view meaning;
  bool takes_stability;  ///< of the grasp: needs a measure that is fit for a tick
};

inline constexpr auto kCriterionTable = std::to_array<CriterionInfo>({
    {Criterion::kManipulability, "manipulability", "of the exploring finger", false},
    {Criterion::kStability, "stability", "of the grasp", true},
    {Criterion::kSwitched, "switched", "stability while it is below its threshold (Sec. II)", true},
    {Criterion::kCombined, "combined", "weighted sum of both (Fig. 2)", true},
    {Criterion::kReserve, "reserve",
     "motion reserve of the exploring finger [rad]: how far it can follow the coming turn", false},
});
static_assert(kCriterionTable.size() == static_cast<std::size_t>(kLastCriterion) + 1);
static_assert([] {
  for (std::size_t i = 0; i < kCriterionTable.size(); ++i)
    if (kCriterionTable[i].id != static_cast<Criterion>(i)) return false;
  return true;
}());

constexpr const CriterionInfo& InfoOf(Criterion criterion) {
  return kCriterionTable[static_cast<std::size_t>(criterion)];
}
constexpr std::string_view Name(Criterion criterion) { return InfoOf(criterion).name; }

inline constexpr auto kCriterionNames = [] {
  std::array<std::string_view, kCriterionTable.size()> names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = kCriterionTable[i].name;
  return names;
}();

}  // namespace regrasp
