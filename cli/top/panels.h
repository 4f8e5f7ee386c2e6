#pragma once

/// The panels of `top`: each draws what the model knows into a box of the screen.

#include "cli/top/model.h"
#include "cli/top/screen.h"

namespace regrasp::cli {

/// Rows 1 and 2: version, state, time, real-time factor, tick p99; seed, noise, recording, clients,
/// job.
void DrawHeader(Screen* screen, const Box& box, const DashboardModel& model);
/// One row: angle the controller aims at and the true one, position error, slip.
void DrawObject(Screen* screen, const Box& box, const DashboardModel& model);
/// A row of titles, then one row per finger.
void DrawFingers(Screen* screen, const Box& box, const DashboardModel& model);
/// One row: cycle, gradient norm against its threshold, gain in phi.
void DrawExploration(Screen* screen, const Box& box, const DashboardModel& model);
/// A title, then the newest events, the last one lowest.
void DrawEvents(Screen* screen, const Box& box, const DashboardModel& model);
/// Manipulability and stability over the last 30 s, side by side where there is room for both,
/// else the one that is the active criterion.
/// `finger`: whose manipulability; empty: of the exploring finger, or of all when none explores.
void DrawGraphs(Screen* screen, const Box& box, const DashboardModel& model,
                const std::string& finger);

}  // namespace regrasp::cli
