#pragma once

/// Every activity, in the order of the table of jobs.

#include <cstddef>
#include <tuple>
#include <utility>

#include "core/session/activity/explore.h"
#include "core/session/activity/grasp.h"
#include "core/session/activity/move.h"
#include "core/session/activity/release.h"
#include "core/session/activity/rotate.h"
#include "core/session/job_table.h"

namespace regrasp {

using Activities =
    std::tuple<GraspActivity, ReleaseActivity, ExploreActivity, RotateActivity, MoveActivity>;
static_assert(std::tuple_size_v<Activities> == kJobTable.size());

/// Calls `use(row of the table, activity)` for each.
template <typename Use>
void ForEachActivity(Activities& activities, const Use& use) {
  [&]<std::size_t... i>(std::index_sequence<i...>) {
    (use(kJobTable[i], std::get<i>(activities)), ...);
  }
  (std::make_index_sequence<kJobTable.size()>());
}

}  // namespace regrasp
