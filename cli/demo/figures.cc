#include "cli/demo/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cli/commands/jobs.h"
#include "cli/demo/gait_record.h"

namespace regrasp::cli {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr std::int64_t kExploreChunk = 100, kRotateChunk = 50;         // [ticks]
constexpr std::int64_t kExploreLimit = 60000, kRotateLimit = 2000000;  // [ticks]
constexpr int kHoldSamples = 50;
constexpr std::int64_t kHoldChunk = 20;  // a second in all: sensor noise averages out
constexpr double kGaitWindow = 40;       // of figure 3b: its bands stay legible [s]
constexpr int kTradeoffStarts = 4;
constexpr double kStabilityFalls = 0.02;     // more than the noise of one reading
constexpr std::int64_t kFirstRepeat = 1000;  // seeds of the start gradients, after the run's
const Json kAxis_W = {0, 0, -1};
constexpr double kAngleTolerance = 5;  // [deg]
constexpr double kOffsetLimit = 5;     // of the object while it turns [mm]
constexpr double kForceTolerance =
    0.02;  // of the weight: what the project promises for a hold at rest

/// A job that was refused at once has no record of what it did.
bool Known(const Json& record) {
  return At(record, "phi_true_initial").is_number() && At(record, "phi_true_final").is_number();
}

/// Of a hand that holds nothing: 0.
double Stability(const Json& quality) {
  const Json& stability = At(quality, "stability");
  return stability.is_number() ? stability.get<double>() : 0.0;
}

/// phi, noise-free, before and after.
std::string Rise(const Json& record) {
  if (!Known(record)) return Plain(At(record, "error"));
  const double from = record.at("phi_true_initial"), to = record.at("phi_true_final");
  return fmt::format("{:.3f} to {:.3f} ({:+.1f} %), {}", from, to,
                     from > 0 ? 100 * (to / from - 1) : 0.0, Plain(At(record, "reason")));
}

bool Rose(const Json& record) {
  return Known(record) &&
         record.at("phi_true_final").get<double>() > record.at("phi_true_initial").get<double>() &&
         Done(record);
}

}  // namespace

void Figures::Say(const std::string& text) {
  if (!context_.options().quiet && context_.out().human()) fmt::print(stderr, "  {}\n", text);
}

void Figures::GraspObject() {
  const Json record = daemon_.Grasp(start_seed_);
  if (!Done(record))
    throw CliError(kFailed, "the grasp failed: " + Plain(At(record, "error")),
                   "regrasp help grasp");
  measured_["hold"]["grasp"] = record;
}

void Figures::MustHold(const std::string& step) {
  if (daemon_.Call("status").at("state") == "holding") return;
  held_ = false;
  Add(step + " keeps the object", "it was dropped", false);
}

void Figures::Picture(const std::string& name, const std::string& file, double last_s) {
  Json params = {{"name", name}, {"file", file}, {"overwrite", true}};
  if (last_s > 0) params["last_s"] = last_s;
  const Json answer = daemon_.Call("plot", params);
  measured_["pictures"].push_back((output_ / Plain(At(answer, "file"))).string());
}

void Figures::Grasp() {
  Say("grasping");
  GraspObject();
  double force[3] = {0, 0, 0};
  double weight = 0;
  int foreign = 0;
  std::size_t touching = 0;
  for (int sample = 0; sample < kHoldSamples; ++sample) {
    daemon_.Step(kHoldChunk);
    const Json truth = daemon_.Call("truth");
    touching = 0;
    for (const auto& contact : At(truth, "contacts")) {
      for (int i = 0; i < 3; ++i)
        force[i] += contact.at("force_W_n")[static_cast<std::size_t>(i)].get<double>();
      if (At(contact, "finger").is_null()) ++foreign;
    }
    for (const auto& [name, finger] : Named(At(truth, "fingers"), "finger"))
      touching += At(finger, "in_contact") == true;
    const Json& g = truth.at("gravity_W_m_s2");
    weight = truth.at("object").at("mass_kg").get<double>() *
             std::hypot(g[0].get<double>(), g[1].get<double>(), g[2].get<double>());
  }
  const double sum = std::hypot(force[0], force[1], force[2]) / kHoldSamples;
  const Json quality = daemon_.Call("quality");
  const std::size_t fingers = At(quality, "fingers").size();
  measured_["hold"].update({{"force_n", sum},
                            {"weight_n", weight},
                            {"fingers", fingers},
                            {"touching", touching},
                            {"quality", quality}});
  Add("holds an unknown object (Sec. II)", fmt::format("{} of {} fingers touch", touching, fingers),
      touching == fingers && foreign == 0);
  Add("", fmt::format("forces sum to {:.3f} N, weight {:.3f} N", sum, weight),
      std::abs(sum - weight) < kForceTolerance * weight);
  Picture("scene", "figure1.png");
}

Figures::Exploration Figures::Explore(const std::string& finger, const std::string& criterion,
                                      std::int64_t gradient_seed) {
  Exploration run;
  GraspObject();
  run.start_hash = Plain(At(daemon_.Call("status"), "state_hash"));
  run.first_stability = Stability(daemon_.Call("quality"));
  run.record = daemon_.Run(
      "explore", {{"finger", finger}, {"criterion", criterion}, {"seed", gradient_seed}},
      kExploreChunk, kExploreLimit, [&] {
        const Json quality = daemon_.Call("quality", {{"measures", "frame"}});
        run.least_stability = std::min(run.least_stability, Stability(quality));
      });
  run.last_stability = Stability(daemon_.Call("quality"));
  MustHold("exploring (" + finger + ")");
  return run;
}

void Figures::Explorations(int repeats) {
  const std::string phi(context_.out().Phi());
  const Json contacts = daemon_.Call("contacts");
  std::vector<std::string> fingers;
  for (const auto& [name, finger] : Named(At(contacts, "fingers"), "finger"))
    fingers.push_back(name);
  for (const auto& finger : fingers) {
    Say("exploring: " + finger);
    const Exploration run = Explore(finger, "manipulability", seed_);
    measured_["explore"][finger] = run.record;
    Add(finger == fingers.front() ? "exploring raises " + phi + " (Sec. III a)" : "",
        fmt::format("{:<6} {}", finger, Rise(run.record)), Rose(run.record));
  }
  const auto has = [&](const char* finger) {
    return std::find(fingers.begin(), fingers.end(), finger) != fingers.end();
  };
  if (has("ring")) Figure2();
  if (has("little")) Tradeoff();
  if (has("ring")) Repeats(repeats);
}

void Figures::Figure2() {
  Say("figure 2: two explorations of the ring finger from one state");
  const Exploration first = Explore("ring", "manipulability", seed_);
  Picture("quality", "quality.png");
  const double threshold = daemon_.Call("quality").value("threshold", 0.0);
  const Exploration second = Explore("ring", "combined", seed_);
  Picture("comparison", "figure2.png");
  measured_["figure2"] = {{"manipulability", first.record},
                          {"combined", second.record},
                          {"start_hash", {first.start_hash, second.start_hash}},
                          {"first_stability", {first.first_stability, second.first_stability}},
                          {"least_stability", {first.least_stability, second.least_stability}},
                          {"threshold", threshold}};
  Add("fig. 2: both runs start alike",
      "state " + first.start_hash.substr(0, 8) +
          (first.start_hash == second.start_hash ? ", the same bits"
                                                 : " and " + second.start_hash.substr(0, 8)),
      first.start_hash == second.start_hash);
  Add("fig. 2: linear sum", Rise(second.record), Rose(second.record));
  const double least = std::min(first.least_stability, second.least_stability);
  Add("fig. 2: stable throughout",
      fmt::format("stability at least {:.3f}, threshold {:.3f}", least, threshold),
      least >= threshold && daemon_.Call("status").at("state") != "dropped");
}

void Figures::Tradeoff() {
  Say("figure 2 of the little finger, whose better manipulability costs stability");
  // "May" is a claim about some starts: the first of a few that shows it, and which one is said.
  Exploration first;
  bool shown = false;
  for (int k = 0; k < kTradeoffStarts && !shown && held_; ++k) {
    start_seed_ = seed_ + k;
    first = Explore("little", "manipulability", seed_);
    shown = Rose(first.record) && first.first_stability - first.last_stability > kStabilityFalls;
  }
  const Exploration second = Explore("little", "combined", seed_);
  Picture("comparison", "figure2-little.png");
  measured_["tradeoff"] = {{"shown", shown},
                           {"manipulability", first.record},
                           {"combined", second.record},
                           {"first_stability", first.first_stability},
                           {"last_stability", {first.last_stability, second.last_stability}}};
  Add("fig. 2: stability may decrease",
      fmt::format("little, start {}: {:.2f} to {:.2f}, by the sum {:.2f}", start_seed_,
                  first.first_stability, first.last_stability, second.last_stability),
      shown);
  measured_["tradeoff"]["start_seed"] = start_seed_;
  start_seed_ = seed_;
}

void Figures::Repeats(int repeats) {
  if (repeats > 0) Say(fmt::format("{} repeats with other gradient directions", repeats));
  int rose = 0, dropped = 0;
  Json records = Json::array();
  for (int i = 0; i < repeats; ++i) {
    records.push_back(Explore("ring", "manipulability", seed_ + kFirstRepeat + i).record);
    rose += Rose(records.back());
    dropped += daemon_.Call("status").at("state") == "dropped";
  }
  measured_["repeats"] = {
      {"runs", repeats}, {"rose", rose}, {"dropped", dropped}, {"records", records}};
  if (repeats == 0) return;
  Add("repeats always succeed (50 of 50)",
      fmt::format("{} of {}, other gradient directions", rose, repeats), rose == repeats);
}

void Figures::Rotation(const std::string& preset, const std::string& name) {
  Say("rotating by finger gait, " + name);
  GraspObject();
  daemon_.Call("param.set", {{"name", "gait.preset"}, {"value", preset}});
  GaitRecord gait;
  const Json record = daemon_.Run("rotate", {{"turns", turns_}, {"axis", kAxis_W}}, kRotateChunk,
                                  kRotateLimit, [&] { gait.Look(&daemon_); });
  measured_["rotate"][name] = record;
  measured_["rotate"][name]["gait"] = gait.ToJson();
  const std::string claim = "turns it, " + name + " (Sec. III b)";
  if (!At(record, "angle_rad").is_number()) return Add(claim, Plain(At(record, "error")), false);
  const double degrees = record.at("angle_rad").get<double>() * kDegrees;
  const double seconds = record.at("sim_time_s");
  if (const Json& reason = At(record, "error"); reason.is_string())
    Add(claim, Plain(reason), false);
  else
    Add(claim, fmt::format("no drop, {} regrasps", Plain(At(record, "regrasps"))),
        JobExit(record) == kOk);
  Add("",
      fmt::format("{:.0f} deg of {:.0f}, {:.0f} deg/min", degrees, 360 * turns_,
                  seconds > 0 ? 60 * degrees / seconds : 0.0),
      std::abs(degrees - 360 * turns_) < kAngleTolerance);
  const double offset_mm = record.at("max_position_error_m").get<double>() * 1e3;
  Add("",
      fmt::format("within {:.1f} mm, axis within {} deg", offset_mm,
                  Fixed(At(record, "max_tilt_rad"), 1, kDegrees)),
      offset_mm < kOffsetLimit);
  MustHold("the rotation");
}

void Figures::Rotations() {
  Rotation("planned", "planned");
  Picture("gait", "gait-planned.png");
  Rotation("paper", "exploring");
  Picture("contacts", "figure3a.png");
  Picture("gait", "figure3b.png", kGaitWindow);
  Picture("gait", "gait-exploring.png");
}

}  // namespace regrasp::cli
