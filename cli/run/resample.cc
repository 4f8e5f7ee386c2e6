#include "cli/run/resample.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/client/errors.h"
#include "core/journal/journal_text.h"

namespace regrasp::run {
namespace {

constexpr std::int64_t kEventTicks = 20;

/// Gives every message its topic, schema and time.
class Sender {
 public:
  Sender(const SessionConfig& config, const ResampledPlace& place, const OnMessage& on_message)
      : config_(config), place_(place), on_message_(on_message) {
    for (std::size_t i = 0; i < kRunTopics.size(); ++i)
      schemas_.push_back(
          {RunSchemaName(static_cast<RunTopic>(i)), RunSchema(static_cast<RunTopic>(i), config)});
  }
  RunPlace At(std::int64_t tick) const {
    const double time_ns = std::round(static_cast<double>(tick) * config_.world.dt * 1e9);
    return {config_, place_.segment, place_.offset_ns + static_cast<std::uint64_t>(time_ns)};
  }
  void operator()(RunTopic topic, std::int64_t tick, const std::string& text) const {
    const auto i = static_cast<std::size_t>(topic);
    on_message_({kRunTopics[i], schemas_[i].name, schemas_[i].text, text, At(tick).time_ns});
  }

 private:
  const SessionConfig& config_;
  const ResampledPlace place_;
  const OnMessage& on_message_;
  struct Schema {
    std::string name, text;
  };
  std::vector<Schema> schemas_;
};

/// Those of the saved state, and those up to `tick`.
void SendCommands(const RunWindow& window, std::size_t* next, std::int64_t tick,
                  const Sender& send) {
  const auto& entries = window.segment().journal->entries;
  const auto due = [&] { return *next < window.commands_before() || entries[*next].tick <= tick; };
  for (; *next < entries.size() && due(); ++*next)
    send(RunTopic::kCommands, entries[*next].tick,
         EntryText(entries[*next], window.segment().journal->config, send.At(0).segment, *next));
}

/// Ticks from one sample to the next.
double StepOf(double rate_hz, double dt) {
  const double step = 1 / (rate_hz * dt);
  if (step < 1 - 1e-9)
    throw cli::CliError(ExitCode::kUsage,
                        fmt::format("--rate {:g} Hz: expected at most {:g} Hz, a sample each tick",
                                    rate_hz, 1 / dt));
  return std::min(step, 1e15);
}

}  // namespace

void Resample(RunWindow* window, double rate_hz, const ResampledPlace& place,
              const OnMessage& on_message) {
  const SessionConfig& config = window->segment().journal->config;
  const double step = StepOf(rate_hz, config.world.dt);
  const Sender send(config, place, on_message);
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
  send(RunTopic::kRun, 0, ConfigText(config, place.segment));
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
  const auto ticks = static_cast<double>(window->end_tick() - window->from_tick());
  for (int i = 0; i * step < ticks + 0.5; ++i) {
    const std::int64_t tick = window->from_tick() + std::llround(i * step);
    if (tick <= window->end_tick()) sample(tick);
  }
  SendCommands(*window, &commands, window->end_tick() - (window->to_the_end() ? 0 : 1), send);
}

}  // namespace regrasp::run
