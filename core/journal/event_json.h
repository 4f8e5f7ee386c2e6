#pragma once

/// Events as clients and run files get them.

#include <nlohmann/json.hpp>

#include "core/hand/hand_model.h"
#include "core/session/frame.h"

namespace regrasp {

/// {tick, t_s, kind, finger (its name or null), value, ..., text}; `dt` [s] turns the tick into a
/// time.
nlohmann::ordered_json EventJson(const Event& event, const HandModel& hand, double dt);

/// A tick's time [s], without the dirt of binary fractions.
double TickSeconds(std::int64_t tick, double dt);

}  // namespace regrasp
