#include "cli/run/resample.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/journal/journal_text.h"

namespace regrasp::run {
namespace {

constexpr std::int64_t kEventTicks = 20;

/// Gives every message its topic, schema and time.
class Sender {
 public:
  Sender(const SessionConfig& config, const OnMessage& on_message)
      : config_(config), on_message_(on_message) {
    for (std::size_t i = 0; i < kRunTopics.size(); ++i)
      schemas_.push_back(
          {RunSchemaName(static_cast<RunTopic>(i)), RunSchema(static_cast<RunTopic>(i), config)});
  }
  RunPlace At(std::int64_t tick) const {
    return {config_, 0,
            static_cast<std::uint64_t>(
                std::llround(static_cast<double>(tick) * config_.world.dt * 1e9))};
  }
  void operator()(RunTopic topic, std::int64_t tick, const std::string& text) const {
    const auto i = static_cast<std::size_t>(topic);
    on_message_({kRunTopics[i], schemas_[i].name, schemas_[i].text, text, At(tick).time_ns});
  }

 private:
  const SessionConfig& config_;
  const OnMessage& on_message_;
  struct Schema {
    std::string name, text;
  };
  std::vector<Schema> schemas_;
};

void SendCommands(const RunWindow& window, std::size_t* next, std::int64_t tick,
                  const Sender& send) {
  const auto& entries = window.segment().journal->entries;
  for (; *next < entries.size() && entries[*next].tick <= tick; ++*next)
    send(RunTopic::kCommands, entries[*next].tick,
         EntryText(entries[*next], window.segment().journal->config, 0, *next));
}

}  // namespace

void Resample(RunWindow* window, double rate_hz, const OnMessage& on_message) {
  const SessionConfig& config = window->segment().journal->config;
  const Sender send(config, on_message);
  Replay& replay = window->replay();
  const auto run_to = [&](std::int64_t tick) {
    while (replay.session().tick() < tick) {  // a session keeps few events
      if (!replay.RunTo(std::min(tick, replay.session().tick() + kEventTicks)))
        throw std::runtime_error(fmt::format("the replay differs from the recording at tick {}",
                                             replay.divergence().tick));
      for (const Event& event : replay.session().TakeEvents())
        if (event.tick >= window->from_tick())
          send(RunTopic::kEvents, event.tick, RunEvent(event, send.At(event.tick)));
    }
  };
  send(RunTopic::kRun, 0, ConfigText(config, 0));
  send(RunTopic::kScene, 0, RunScene(send.At(0)));
  std::size_t commands = 0;
  Frame frame;
  const auto sample = [&](std::int64_t tick) {
    run_to(tick);
    SendCommands(*window, &commands, tick - 1, send);  // those of the tick itself come after it
    replay.session().Snapshot(&frame, true);
    for (const RunTopic topic : {RunTopic::kState, RunTopic::kJoints, RunTopic::kContacts,
                                 RunTopic::kForces, RunTopic::kObject, RunTopic::kQuality,
                                 RunTopic::kGait, RunTopic::kTransforms, RunTopic::kContactScene})
      if (topic != RunTopic::kGait || frame.gait.active)
        send(topic, tick, RunSample(topic, frame, commands, send.At(tick)));
  };
  const double step = std::max(1.0, 1 / (rate_hz * config.world.dt));  // [ticks]
  for (int i = 0;; ++i) {
    const std::int64_t tick = window->from_tick() + std::llround(i * step);
    if (tick > window->end_tick()) break;
    sample(tick);
  }
  SendCommands(*window, &commands, window->end_tick() - 1, send);
}

}  // namespace regrasp::run
