#pragma once

/// What a finger may maximise while it explores, as one table: the command line, the wire, the
/// pictures and the documentation follow from it. A new criterion is an entry, a row, and what
/// Objective() computes (objective.cc).

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/common/info_table.h"

namespace regrasp {

/// In the order of the table.
enum class Criterion : std::uint8_t { kManipulability, kStability, kSwitched, kCombined, kReserve };

/// What phi is, for those who show it beside the two measures of the paper.
enum class PhiOf : std::uint8_t {
  kManipulability,  ///< of the exploring finger
  kStability,       ///< of the grasp
  kEither,          ///< one of these two, as ObjectiveValue::on_stability says
  kBoth,            ///< their sum
  kOther,           ///< a number of its own
};

struct CriterionInfo {
  Criterion id;
  std::string_view name;
  std::string_view meaning;
  PhiOf phi_of;
  /// Stability of the grasp, which must be a measure that is fit for a tick.
  bool takes_stability = false;
  bool takes_turn_axis = false;    ///< of the coming turn
  bool takes_load_margin = false;  ///< rho of the grasp
  std::string_view truth = {};  ///< its name in what `truth` tells of a finger; "": it is not told
};

inline constexpr auto kCriterionTable = std::to_array<CriterionInfo>({
    {.id = Criterion::kManipulability,
     .name = "manipulability",
     .meaning = "of the exploring finger",
     .phi_of = PhiOf::kManipulability,
     .truth = "manipulability"},
    {.id = Criterion::kStability,
     .name = "stability",
     .meaning = "of the grasp",
     .phi_of = PhiOf::kStability,
     .takes_stability = true},
    {.id = Criterion::kSwitched,
     .name = "switched",
     .meaning = "stability while it is below its threshold (Sec. II)",
     .phi_of = PhiOf::kEither,
     .takes_stability = true},
    {.id = Criterion::kCombined,
     .name = "combined",
     .meaning = "weighted sum of both (Fig. 2)",
     .phi_of = PhiOf::kBoth,
     .takes_stability = true},
    {.id = Criterion::kReserve,
     .name = "reserve",
     .meaning =
         "motion reserve of the exploring finger [rad]: how far it can follow the coming turn",
     .phi_of = PhiOf::kOther,
     .takes_turn_axis = true,
     .takes_load_margin = true},
});
inline constexpr auto kLastCriterion = static_cast<Criterion>(kCriterionTable.size() - 1);
static_assert(InOrder(kCriterionTable));

constexpr const CriterionInfo& InfoOf(Criterion criterion) {
  return kCriterionTable[static_cast<std::size_t>(criterion)];
}
constexpr std::string_view Name(Criterion criterion) { return InfoOf(criterion).name; }

/// What counts of it: one of the two measures that it switches between, else itself.
constexpr Criterion ActiveOf(Criterion criterion, bool on_stability) {
  if (InfoOf(criterion).phi_of != PhiOf::kEither) return criterion;
  return on_stability ? Criterion::kStability : Criterion::kManipulability;
}

/// The row of this name, or null.
constexpr const CriterionInfo* FindCriterion(std::string_view name) {
  const auto* const row = std::ranges::find(kCriterionTable, name, &CriterionInfo::name);
  return row == kCriterionTable.end() ? nullptr : row;
}

inline constexpr auto kCriterionNames = NamesOf<kCriterionTable.size()>(kCriterionTable);

}  // namespace regrasp
