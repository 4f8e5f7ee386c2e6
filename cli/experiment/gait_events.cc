#include "cli/experiment/gait_events.h"

#include <algorithm>

#include "cli/print/print.h"

namespace regrasp::cli {
namespace {

constexpr int kMostEvents = 1000;   // the daemon keeps no more
constexpr double kNearBest = 0.98;  // of the best: little left to gain

}  // namespace

void GaitEvents::Read() {
  const Json answer = daemon_.Call("events", {{"count", kMostEvents}});
  // Those of the run before are still in the list.
  std::vector<Json> events;
  for (const Json& event : answer.at("events")) {
    if (event.at("kind") == "reset") events.clear();
    events.push_back(event);
  }
  std::int64_t newest = last_tick_;
  for (const Json& event : events) {
    const std::int64_t tick = event.at("tick");
    newest = std::max(newest, tick);
    if (tick <= last_tick_) continue;
    const std::string kind = event.at("kind");
    slips_ += kind == "slip";
    refusals_ += kind == "refused";
    if (kind == "slip" || kind == "dropped") failures_s_.push_back(event.at("t_s"));
    if (kind == "regrasp" && At(event, "from").is_number())
      explorations_[Plain(event.at("finger"))].push_back({event["from"], event.at("value")});
  }
  last_tick_ = newest;
}

GaitEvents::Counts GaitEvents::Count() const {
  Counts counts = {.slips = slips_, .refusals = refusals_};
  for (const auto& [finger, explorations] : explorations_) {
    double best = 0;
    for (const auto& [from, to] : explorations) best = std::max(best, to);
    for (const auto& [from, to] : explorations) {
      ++counts.explored;
      counts.gain_sum += to / from - 1;
      if (from >= kNearBest * best) continue;
      ++counts.low;
      counts.low_rose += to > from;
    }
  }
  return counts;
}

}  // namespace regrasp::cli
