#include "cli/demo.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <optional>

#include "cli/jobs.h"
#include "cli/private_daemon.h"

namespace regrasp::cli {
namespace {

namespace fs = std::filesystem;

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr int kGraspChunkTicks =
    500;  // the grasp is stepped in chunks, so that every run ends it at the same tick
constexpr int kMaxGraspChunks = 60;
constexpr double kTurns = 1;
constexpr double kExploring = 0, kReturning = 1;  // values of gait.mode
constexpr double kGaitWindow = 40;                // of figure 3b: its bands stay legible [s]
const Json kAxis_W = {0, 0, -1};
constexpr double kAngleTolerance = 5;  // [deg]
constexpr double kOffsetLimit = 5;     // of the object while it turns [mm]
constexpr double kForceTolerance =
    0.02;  // of the weight: what the project promises for a hold at rest

/// One line of the final table.
struct Claim {
  std::string claim, measured;
  bool shown = true;
};

struct Exploration {
  Json record;
  std::string start_hash;
  double least_stability = 1e300;
};

class Show {
 public:
  Show(Context& context, const std::string& socket, fs::path output, std::int64_t seed)
      : context_(context), client_(socket, 30), output_(std::move(output)), seed_(seed) {}

  void Grasp();
  void Explorations(int repeats);
  void Rotations();
  const std::vector<Claim>& claims() const { return claims_; }
  /// The hand held the object to the end of every step.
  bool held() const { return held_; }
  const Json& measured() const { return measured_; }

 private:
  void Say(const std::string& text) {
    if (!context_.options().quiet && context_.out().human()) fmt::print(stderr, "  {}\n", text);
  }
  Json Call(const char* method, const Json& params = Json::object()) {
    return client_.Call(method, params);
  }
  Json Wait(const Json& job) { return client_.Call("job.wait", {{"id", job.at("job")}}, 600); }
  /// A new run, paused, with the object in the hand at a tick that does not depend on pacing.
  Json GraspPaused();
  Exploration Explore(const std::string& finger, const std::string& criterion,
                      std::int64_t gradient_seed);
  void Rotation(double mode, const std::string& name);
  void Picture(const std::string& name, const std::string& file, double last_s = 0);
  void Add(const std::string& claim, const std::string& measured, bool shown) {
    claims_.push_back({claim, measured, shown});
  }
  /// The object must stay in the hand, whatever else a step shows.
  void MustHold(const std::string& step) {
    if (Call("status").at("state") == "holding") return;
    held_ = false;
    Add(step + " keeps the object", "it was dropped", false);
  }

  Context& context_;
  Client client_;
  fs::path output_;
  std::int64_t seed_;
  std::vector<Claim> claims_;
  bool held_ = true;
  Json measured_ = Json::object();
};

Json Show::GraspPaused() {
  Call("pause");
  Call("reset", {{"seed", seed_}});
  const Json job = Call("grasp");
  for (int chunk = 0; chunk < kMaxGraspChunks; ++chunk) {
    Wait(Call("step", {{"ticks", kGraspChunkTicks}}));
    const Json record = Call("job.get", {{"id", job.at("job")}});
    const std::string state = Plain(At(record, "state"));
    if (state == "queued" || state == "running") continue;
    if (state != "done")
      throw CliError(kFailed, "the grasp failed: " + Plain(At(record, "error")),
                     "regrasp help grasp");
    return record;
  }
  throw CliError(kFailed, "the grasp does not end", "regrasp status");
}

void Show::Picture(const std::string& name, const std::string& file, double last_s) {
  Json params = {{"name", name}, {"file", file}};
  if (last_s > 0) params["last_s"] = last_s;
  const Json answer = Call("plot", params);
  measured_["pictures"].push_back((output_ / Plain(At(answer, "file"))).string());
}

void Show::Grasp() {
  Say("grasping");
  const Json record = GraspPaused();
  Call("resume");
  // A second of simulated time, many samples: sensor noise averages out.
  double force[3] = {0, 0, 0};
  double weight = 0;
  int samples = 0, foreign = 0;
  std::size_t touching = 0;
  const double begin = Call("status").at("time_s");
  for (double now = begin; now < begin + 1.0 || samples < 20; ++samples) {
    const Json truth = Call("truth");
    now = truth.at("time_s");
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
  const double sum = std::hypot(force[0], force[1], force[2]) / samples;
  const Json quality = Call("quality");
  const std::size_t fingers = At(quality, "fingers").size();
  measured_["hold"] = {
      {"grasp", record}, {"force_n", sum}, {"weight_n", weight}, {"quality", quality}};
  Add("holds an unknown object (Sec. II)", fmt::format("{} of {} fingers touch", touching, fingers),
      touching == fingers && foreign == 0);
  Add("", fmt::format("forces sum to {:.3f} N, weight {:.3f} N", sum, weight),
      std::abs(sum - weight) < kForceTolerance * weight);
  Picture("scene", "figure1.png");
}

Exploration Show::Explore(const std::string& finger, const std::string& criterion,
                          std::int64_t gradient_seed) {
  Exploration run;
  GraspPaused();
  run.start_hash = Plain(At(Call("status"), "state_hash"));
  const Json job =
      Call("explore", {{"finger", finger}, {"criterion", criterion}, {"seed", gradient_seed}});
  Call("resume");
  while (true) {
    const Json quality = Call("quality");
    if (At(quality, "stability").is_number())
      run.least_stability = std::min(run.least_stability, quality["stability"].get<double>());
    try {
      run.record = client_.Call("job.wait", {{"id", job.at("job")}, {"timeout_s", 0.02}}, 30);
      MustHold("exploring (" + finger + ")");
      return run;
    } catch (const CliError& error) {
      if (error.code != kTimeout || error.rpc_code == 0) throw;
    }
  }
}

/// phi, noise-free, before and after.
std::string Rise(const Json& record) {
  const double from = record.at("phi_true_initial"), to = record.at("phi_true_final");
  return fmt::format("{:.3f} to {:.3f} ({:+.1f} %), {}", from, to,
                     from > 0 ? 100 * (to / from - 1) : 0.0, Plain(At(record, "reason")));
}

bool Rose(const Json& record) {
  return record.at("phi_true_final").get<double>() > record.at("phi_true_initial").get<double>() &&
         At(record, "state") == "done";
}

void Show::Explorations(int repeats) {
  const std::string phi(context_.out().Phi());
  const Json contacts = Call("contacts");
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
  if (std::find(fingers.begin(), fingers.end(), "ring") == fingers.end()) return;

  Say("figure 2: two explorations of the ring finger from one state");
  const Exploration first = Explore("ring", "manipulability", seed_);
  Picture("quality", "quality.png");
  const double threshold = Call("quality").value("threshold", 0.0);
  const Exploration second = Explore("ring", "combined", seed_);
  Picture("comparison", "figure2.png");
  measured_["figure2"] = {{"manipulability", first.record},
                          {"combined", second.record},
                          {"start_hash", {first.start_hash, second.start_hash}},
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
      least >= threshold && Call("status").at("state") != "dropped");

  Say(fmt::format("{} repeats with other gradient directions", repeats));
  int rose = 0;
  for (int i = 0; i < repeats; ++i)
    rose += Rose(Explore("ring", "manipulability", seed_ + 1000 + i).record);
  measured_["repeats"] = {{"runs", repeats}, {"rose", rose}};
  Add("repeats always succeed (50 of 50)",
      fmt::format("{} of {}, other gradient directions", rose, repeats), rose == repeats);
}

void Show::Rotation(double mode, const std::string& name) {
  Say("rotating by finger gait, fingers " + name);
  GraspPaused();
  Call("param.set", {{"name", "gait.mode"}, {"value", mode}});
  const Json job = Call("rotate", {{"turns", kTurns}, {"axis", kAxis_W}});
  Call("resume");
  const Json record = Wait(job);
  Call("pause");
  measured_["rotate"][name] = record;
  const double degrees = record.at("angle_rad").get<double>() * kDegrees;
  const double seconds = record.at("sim_time_s");
  const std::string claim = "turns it, fingers " + name + " (Sec. III b)";
  if (const Json& reason = At(record, "error"); reason.is_string())
    Add(claim, Plain(reason), false);
  else
    Add(claim, fmt::format("no drop, {} regrasps", Plain(At(record, "regrasps"))),
        JobExit(record) == kOk);
  Add("",
      fmt::format("{:.0f} deg of {:.0f}, {:.0f} deg/min", degrees, 360 * kTurns,
                  seconds > 0 ? 60 * degrees / seconds : 0.0),
      std::abs(degrees - 360 * kTurns) < kAngleTolerance);
  const double offset_mm = record.at("max_position_error_m").get<double>() * 1e3;
  Add("",
      fmt::format("within {:.1f} mm, axis within {} deg", offset_mm,
                  Fixed(At(record, "max_tilt_rad"), 1, kDegrees)),
      offset_mm < kOffsetLimit);
  MustHold("the rotation");
}

void Show::Rotations() {
  Rotation(kReturning, "returning");
  Picture("gait", "gait-returning.png");
  Rotation(kExploring, "exploring");
  Picture("contacts", "figure3a.png");
  Picture("gait", "figure3b.png", kGaitWindow);
  Picture("gait", "gait-exploring.png");
}

}  // namespace

ExitCode Demo(Context& context, const Invocation& invocation) {
  const Interruptible interruptible;
  const auto seed = static_cast<std::int64_t>(ParseNumber(invocation.Text("seed", "1"), "--seed"));
  const int repeats = static_cast<int>(ParseNumber(invocation.Text("repeats", "10"), "--repeats"));
  const fs::path output = fs::absolute(invocation.Text("output", "regrasp-demo"));
  std::error_code error;
  fs::create_directories(output, error);
  if (error)
    throw CliError(kIo, fmt::format("cannot make {}: {}", output.string(), error.message()),
                   "regrasp demo -o OTHER_DIR");

  std::vector<std::string> arguments = {"--speed",      "max", "--seed", std::to_string(seed),
                                        "--output-dir", output};
  if (invocation.Has("models-dir")) {
    arguments.insert(arguments.end(),
                     {"--models-dir", fs::absolute(invocation.Text("models-dir")).string()});
  }
  const PrivateDaemon daemon(arguments);
  Show show(context, daemon.socket(), output, seed);
  show.Grasp();
  show.Explorations(repeats);
  show.Rotations();

  const bool good = show.held();
  Json answer = {{"ok", good},
                 {"output_dir", output.string()},
                 {"seed", seed},
                 {"claims", Json::array()},
                 {"measured", show.measured()}};
  for (const auto& claim : show.claims()) {
    answer["claims"].push_back({{"claim", claim.claim},
                                {"measured", claim.measured},
                                {"verdict", claim.shown ? "shown" : "missed"}});
  }
  std::ofstream(output / "summary.json") << answer.dump(1) << '\n';
  context.Print(answer, [&] {
    Output& out = context.out();
    Table table({"THE PAPER", "THIS RUN", ""});
    for (const auto& claim : show.claims()) {
      table.Row({claim.claim, claim.measured,
                 claim.shown ? out.Paint(std::string(out.Tick()), Style::kGood)
                             : out.Paint("MISSED", Style::kWarn)});
    }
    out.Add(table.Text(out));
    out.Line();
    for (const auto& picture : show.measured().at("pictures"))
      out.Line("picture  " + Plain(picture));
    out.Line("figures  " + (output / "summary.json").string());
  });
  return good ? kOk : kFailed;
}

}  // namespace regrasp::cli
