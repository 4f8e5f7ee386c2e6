/// What a whole tick costs, by stage, and what the fast stepper gives up for its speed. Sessions at
/// noise `paper` grasp the sphere; then ticks are measured while they hold it and while each finger
/// in turn explores it. All rows run the same commands, in blocks of 100 ticks side by side, so
/// that a slow spell of the machine hits every row. The baseline is the bare exact step of the
/// plain hand: dWorldStep alone, every joint a hinge of its own.
///
/// Then the same ticks of the fast stepper five times over, each by its quickest: what the code
/// takes, without what the machine does in between (interrupts; the other rows' memory).
///
///   bench_tick [--seconds 10] [--seed 1] [--noise paper]      seconds of each state
///
/// Ends with 1 where a row lost the object.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "core/session/session.h"

namespace regrasp {
namespace {

constexpr int kBlock = 100;         // ticks a row runs before the next row's turn
constexpr int kPasses = 200;        // ticks in which the force's mean settles before noise counts
constexpr double kSlowGain = 0.02;  // 50 ms running mean
constexpr int kRepeats = 5;

struct Options {
  double seconds = 10;
  std::uint64_t seed = 1;
  std::string noise = "paper";
};

/// Times [us] of one stage.
class Samples {
 public:
  void Add(double seconds) { us_.push_back(1e6 * seconds); }
  /// Keeps the lesser of each two, of the same ticks run again.
  void Lower(const Samples& again) {
    if (us_.empty()) us_ = again.us_;
    for (std::size_t k = 0; k < us_.size(); ++k) us_[k] = std::min(us_[k], again.us_[k]);
  }
  double Quantile(double q) const {
    if (us_.empty()) return 0;
    std::vector<double> sorted = us_;
    const auto k = static_cast<std::size_t>(q * static_cast<double>(sorted.size() - 1));
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(k), sorted.end());
    return sorted[k];
  }
  double Mean() const {
    const double sum = std::accumulate(us_.begin(), us_.end(), 0.0);
    return us_.empty() ? 0 : sum / static_cast<double>(us_.size());
  }

 private:
  std::vector<double> us_;
};

/// What one session measured in one state.
struct Measured {
  Samples sense, control, collide, step, total;
  double drift_m = 0;
  double force_square = 0;
  long force_samples = 0;
  double ForceNoise() const {
    return force_samples ? std::sqrt(force_square / static_cast<double>(force_samples)) : 0;
  }
};

class Row {
 public:
  Row(std::string name, const Options& options, Stepper stepper, bool merge)
      : name_(std::move(name)) {
    SessionConfig config;
    config.model = LoadScenario("shadow", "sphere", ModelSearchPath());
    config.parameters = DefaultParameters(config.model);
    config.noise = NoisePreset(options.noise).value();
    config.seed = options.seed;
    config.world.stepper = stepper;
    config.world.merge_universal = merge;
    session_ = std::make_unique<Session>(std::move(config));
    session_->MeasureStages(true);
    Give(CommandType::kGrasp);
  }

  /// The grasp is not measured.
  void Grasp() {
    for (int tick = 0; tick < 20000 && session_->state() != SessionState::kHolding; ++tick)
      Step(nullptr);
  }
  void HoldTick() { Step(&holding_); }
  void ExploreTick() {
    if (!session_->job_running()) {
      Give(CommandType::kExplore);
      finger_ = (finger_ + 1) % session_->config().model.hand.num_fingers();
    }
    Step(&exploring_);
  }
  bool ok() const {
    return session_->state() == SessionState::kHolding ||
           session_->state() == SessionState::kExploring;
  }
  const std::string& name() const { return name_; }
  const Measured& holding() const { return holding_; }
  const Measured& exploring() const { return exploring_; }

 private:
  void Give(CommandType type) {
    Command command;
    command.type = type;
    command.job = ++job_;
    command.finger = finger_;
    command.seed = static_cast<std::uint64_t>(job_);
    session_->Apply(command);
    forces_ = {};
  }

  void Step(Measured* to) {
    const auto start = std::chrono::steady_clock::now();
    session_->Tick();
    const double total =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    session_->TakeEvents();
    session_->TakeFinishedJobs();
    if (!to) return;
    const Session::StageTimes t = session_->stage_times();
    to->sense.Add(t.sense_s);
    to->control.Add(t.control_s);
    to->collide.Add(t.collide_s);
    to->step.Add(t.step_s);
    to->total.Add(total);
    to->drift_m = std::max(to->drift_m, session_->world().JointDrift());
    for (const ObjectContact& c : session_->truth().contacts) {
      if (c.finger < 0) continue;
      Force& force = forces_[static_cast<std::size_t>(c.finger)];
      const double f = -c.force_W.dot(c.normal_W);
      if (force.ticks == 0) force.slow = f;
      force.slow += kSlowGain * (f - force.slow);
      if (++force.ticks < kPasses) continue;
      to->force_square += (f - force.slow) * (f - force.slow);
      ++to->force_samples;
    }
  }

  struct Force {
    double slow = 0;
    long ticks = 0;
  };
  std::string name_;
  std::unique_ptr<Session> session_;
  std::array<Force, kMaxFingers> forces_{};
  std::int64_t job_ = 0;
  int finger_ = 0;
  Measured holding_, exploring_;
};

void Print(const char* state, const Row& row, const Measured& m, const Measured& exact,
           double bare_us) {
  const double total = m.total.Quantile(.5);
  std::printf("%-9s %-16s", state, row.name().c_str());
  for (const Samples* s : {&m.sense, &m.control, &m.collide, &m.step, &m.total})
    std::printf("  %6.1f %6.1f %6.1f", s->Quantile(.5), s->Mean(), s->Quantile(.99));
  std::printf("   %5.2f   %7.4f %5.2f  %7.1f\n", total / bare_us, m.ForceNoise(),
              m.ForceNoise() / exact.ForceNoise(), 1e6 * m.drift_m);
}

void PrintQuickest(const Options& options) {
  std::array<Samples, 2> quickest;
  const int ticks = static_cast<int>(options.seconds * 1000);
  for (int k = 0; k < kRepeats; ++k) {
    Row row("fast", options, Stepper::kFast, true);
    row.Grasp();
    for (int i = 0; i < ticks; ++i) row.HoldTick();
    for (int i = 0; i < ticks; ++i) row.ExploreTick();
    quickest[0].Lower(row.holding().total);
    quickest[1].Lower(row.exploring().total);
  }
  std::printf("the same ticks %d times, each by its quickest [us]:", kRepeats);
  for (int exploring = 0; exploring < 2; ++exploring)
    std::printf("  %s median %.1f mean %.1f p99 %.1f", exploring ? "exploring" : "holding",
                quickest[exploring].Quantile(.5), quickest[exploring].Mean(),
                quickest[exploring].Quantile(.99));
  std::printf("\n");
}

int Main(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    const char* value = i + 1 < argc ? argv[++i] : "";
    if (name == "--seconds") {
      options.seconds = std::atof(value);
    } else if (name == "--seed") {
      options.seed = std::strtoull(value, nullptr, 10);
    } else if (name == "--noise") {
      options.noise = value;
    } else {
      std::fprintf(stderr, "bench_tick: unknown option %s\n", name.c_str());
      return 2;
    }
  }
  std::vector<Row> rows;
  rows.emplace_back("fast", options, Stepper::kFast, true);
  rows.emplace_back("exact", options, Stepper::kExact, true);
  rows.emplace_back("exact, 22 hinges", options, Stepper::kExact, false);
  for (Row& row : rows) row.Grasp();
  const int blocks = static_cast<int>(options.seconds * 1000) / kBlock;
  for (int exploring = 0; exploring < 2; ++exploring)
    for (int b = 0; b < blocks; ++b)
      for (Row& row : rows)
        for (int k = 0; k < kBlock && row.ok(); ++k) exploring ? row.ExploreTick() : row.HoldTick();

  std::printf("%-9s %-16s  %20s  %20s  %20s  %20s  %20s   %5s   %7s %5s  %7s\n", "state", "stepper",
              "sense", "control", "collide", "step", "tick", "ratio", "F sd N", "rel", "drift um");
  std::printf("%-26s", "[us]");
  for (int i = 0; i < 5; ++i) std::printf("  %6s %6s %6s", "median", "mean", "p99");
  std::printf("\n");
  for (int exploring = 0; exploring < 2; ++exploring) {
    const auto Of = [&](const Row& row) -> const Measured& {
      return exploring ? row.exploring() : row.holding();
    };
    const double bare_us = Of(rows[2]).step.Quantile(.5);
    for (const Row& row : rows)
      Print(exploring ? "exploring" : "holding", row, Of(row), Of(rows[1]), bare_us);
  }
  std::printf("ratio: median tick / median bare exact step of the plain hand, same state\n");
  bool lost = false;
  for (const Row& row : rows) {
    if (row.ok()) continue;
    std::printf("%s lost the object\n", row.name().c_str());
    lost = true;
  }
  if (lost) return 1;
  PrintQuickest(options);
  return 0;
}

}  // namespace
}  // namespace regrasp

int main(int argc, char** argv) { return regrasp::Main(argc, argv); }
