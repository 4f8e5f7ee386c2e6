#include "core/journal/event_json.h"

#include <cmath>

namespace regrasp {

double TickSeconds(std::int64_t tick, double dt) {
  return std::round(static_cast<double>(tick) * dt * 1e9) / 1e9;
}

nlohmann::ordered_json EventJson(const Event& event, const HandModel& hand, double dt) {
  const bool of_finger = event.finger >= 0 && event.finger < hand.num_fingers();
  nlohmann::ordered_json json = {{"tick", event.tick},
                                 {"t_s", TickSeconds(event.tick, dt)},
                                 {"kind", Name(event.kind)},
                                 {"finger", nullptr},
                                 {"value", event.value}};
  if (of_finger) json["finger"] = hand.fingers[static_cast<std::size_t>(event.finger)].name;
  if (event.kind == EventKind::kState)
    json["state"] = Name(static_cast<SessionState>(static_cast<int>(event.value)));
  if (event.kind == EventKind::kJobStarted || event.kind == EventKind::kJobFinished)
    json["job"] = static_cast<std::int64_t>(event.value);
  if (event.kind == EventKind::kRegrasp && event.from > 0) json["from"] = event.from;
  json["text"] = event.text;
  return json;
}

}  // namespace regrasp
