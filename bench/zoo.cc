// Turns many objects, by several settings, on the same seeds, straight on the session (no daemon):
//   zoo [--hand NAME|FILE] [--objects A,B,... | zoo] [--seeds N] [--first S] [--turns T]
//       [--axis X,Y,Z] [--tilt DEG] [--noise PRESET] [--push N] [--limit SECONDS] [--jobs N]
//       [--rows] [--events]
//       [--setting 'NAME: PARAMETER=VALUE ... noise.LEVEL=VALUE ... stepper=fast|exact|round'] ...
// `zoo` (the default): every object of models/objects whose name begins with zoo_, and the cubes.
// A trial is completed when its job is done and the object has truly turned by the angle asked for,
// within 5 degrees. VALUE as `regrasp param set` takes it: exploring, true, 0.25. LEVEL: a field of
// NoiseLevels, on top of the preset: noise.position_bias_m=0.002.
// Per setting: full turns, drops, what else failed, deg/min of the completed; per pair of settings:
// trials that only one of them completed, and the exact two-sided McNemar p. Trials run in --jobs
// processes, two by default; each is reproducible alone from its object, seed and setting.

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/children.h"
#include "bench/noise_setting.h"
#include "bench/settings.h"
#include "bench/trial.h"
#include "core/hand/scenario.h"
#include "core/session/session.h"
#include "core/session/shape_judge.h"

using namespace regrasp;

namespace {

struct Setting {
  std::string name;
  std::vector<ParameterSetting> values;
  std::vector<NoiseSetting> noise;  // on top of the preset
  Stepper stepper = Stepper::kFast;
};

struct Options {
  std::vector<std::string> objects;
  std::vector<Setting> settings;
  int seeds = 1, jobs = 2;
  std::uint64_t first = 1;
  double turns = 1, tilt = -1, push = 0, limit_s = 600;
  Vector3d axis = -Vector3d::UnitZ();
  std::string hand = "shadow", noise = "paper";
  bool rows = false, events = false;
};

/// What a trial leaves behind; sent through a pipe as it is.
struct Trial {
  int index = -1;
  bool done = false, dropped = false;
  double angle_deg = 0, time_s = 0, offset_mm = 0, tilt_deg = 0;
  ShapeErrors shape;
  int slips = 0, refused = 0, regrasps = 0;
  char error[160] = {};
};

Setting ParseSetting(const std::string& text) {
  const auto colon = text.find(':');
  Setting setting{text.substr(0, colon), {}, {}};
  std::istringstream words(colon == std::string::npos ? "" : text.substr(colon + 1));
  for (std::string word; words >> word;) {
    if (word.starts_with("noise.")) {
      setting.noise.push_back(ReadNoiseSetting(word));
      continue;
    }
    if (!word.starts_with("stepper=")) {
      setting.values.push_back(ReadSetting(word));
      continue;
    }
    const auto stepper = StepperNamed(word.substr(word.find('=') + 1));
    if (!stepper) throw std::invalid_argument("zoo: " + word + ": fast, exact or round");
    setting.stepper = *stepper;
  }
  return setting;
}

SessionConfig MakeConfig(const Options& o, const std::string& object, const Setting& setting,
                         std::uint64_t seed) {
  SessionConfig config;
  config.model = LoadScenario(o.hand, object, ModelSearchPath());
  config.parameters = DefaultParameters(config.model);
  config.noise = NoisePreset(o.noise).value();
  for (const NoiseSetting& level : setting.noise) Apply(level, &config.noise);
  config.seed = seed;
  config.world.stepper = setting.stepper;
  if (o.tilt >= 0) {
    const double t = o.tilt * M_PI / 180;
    config.parameters.gravity_W = 9.81 * Vector3d(0, std::cos(t), std::sin(t));
  }
  Apply(setting.values, &config.parameters);
  return config;
}

Trial Run(const Options& o, SessionConfig config) {
  Trial trial;
  Session session(std::move(config));
  JobOptions options;
  options.limit_s = 20;
  options.on_event = [&](const Event& e) {
    if (o.events) std::fprintf(stderr, "%8.3f %s\n", 1e-3 * static_cast<double>(e.tick), e.text);
    trial.slips += e.kind == EventKind::kSlip;
    trial.refused += e.kind == EventKind::kRefused;
  };
  if (!GraspObject(session, options)) {
    std::snprintf(trial.error, sizeof(trial.error), "not grasped");
    return trial;
  }
  Command command;
  command.type = CommandType::kRotate;
  command.angle_rad = 2 * M_PI * o.turns;
  command.axis_W = o.axis;
  options.limit_s = o.limit_s * o.turns;
  options.push_n = o.push;
  const JobRecord job = RunJob(session, command, options);
  Frame now;  // what it has come to where it was too slow
  session.Snapshot(&now, false);
  const RotateResult& r = job.id != 0 ? job.rotate : now.job.rotate;
  trial.shape = JudgeShape(session.felt_surface(), TrueSurface(session.config().model.object));
  trial.done = job.id != 0 && job.state == JobState::kDone;  // by the true angle: TurnedAsAsked
  trial.dropped = r.dropped;
  trial.angle_deg = r.angle_rad * 180 / M_PI;
  trial.time_s = r.sim_time_s;
  trial.offset_mm = 1e3 * r.max_position_error_m;
  trial.tilt_deg = r.max_tilt_rad * 180 / M_PI;
  trial.regrasps = r.regrasps;
  if (job.id == 0) std::snprintf(trial.error, sizeof(trial.error), "too slow");
  if (job.id != 0) std::memcpy(trial.error, job.error, sizeof(trial.error));
  return trial;
}

/// The failure without its numbers and fingers, so that equal reasons count together.
std::string Reason(const Trial& t) {
  std::string text(t.error);
  if (text.find("may not leave") != std::string::npos) return "may not leave";
  if (text.find("found no surface") != std::string::npos) return "found no surface";
  return text;
}

/// Exact two-sided McNemar test: only one of the two completed in b and in c trials.
double McNemar(int b, int c) {
  double p = 0, term = std::pow(0.5, b + c);
  for (int k = 0; k <= std::min(b, c); ++k) {
    p += term;
    term *= static_cast<double>(b + c - k) / (k + 1);
  }
  return b == c ? 1.0 : std::min(1.0, 2 * p);
}

std::vector<Trial> RunAll(const Options& o) {
  const int per_setting = static_cast<int>(o.objects.size()) * o.seeds;
  const int n = per_setting * static_cast<int>(o.settings.size());
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("zoo: no pipe");
  for (int w = 0; w < o.jobs; ++w) {
    if (fork() != 0) continue;
    close(ends[0]);
    for (int k = w; k < n; k += o.jobs) {
      // Settings of one object and seed follow each other, so that an interrupted run is paired.
      const int setting = k % static_cast<int>(o.settings.size());
      const int pair = k / static_cast<int>(o.settings.size());
      const std::string& object = o.objects[pair / o.seeds];
      Trial trial = Run(o, MakeConfig(o, object, o.settings[setting], o.first + pair % o.seeds));
      trial.index = setting * per_setting + pair;
      if (write(ends[1], &trial, sizeof(trial)) != static_cast<ssize_t>(sizeof(trial))) _exit(74);
    }
    _exit(0);
  }
  close(ends[1]);
  std::vector<Trial> trials(n);
  Trial trial;
  while (read(ends[0], &trial, sizeof(trial)) == static_cast<ssize_t>(sizeof(trial))) {
    trials[trial.index] = trial;
    if (!o.rows) continue;
    const int pair = trial.index % per_setting;
    std::printf(
        "%-10s %-26s seed %llu %s %6.1f deg %6.1f s offset %5.2f mm tilt %4.1f deg "
        "regrasps %d slips %d refused %d  felt %.2f rms %.2f bias %+.2f mm normals %.1f deg  %s\n",
        o.settings[trial.index / per_setting].name.c_str(), o.objects[pair / o.seeds].c_str(),
        static_cast<unsigned long long>(o.first + pair % o.seeds),
        trial.done      ? "done"
        : trial.dropped ? "DROP"
                        : "FAIL",
        trial.angle_deg, trial.time_s, trial.offset_mm, trial.tilt_deg, trial.regrasps, trial.slips,
        trial.refused, trial.shape.touched, 1e3 * trial.shape.rms_m, 1e3 * trial.shape.mean_m,
        trial.shape.normal_rad * 180 / M_PI, trial.error);
    std::fflush(stdout);
  }
  close(ends[0]);
  WaitForChildren();
  return trials;
}

void Print(const Options& o, const std::vector<Trial>& trials) {
  const int per_setting = static_cast<int>(o.objects.size()) * o.seeds;
  std::printf("\n%-28s", "completed (dropped) of seeds");
  for (const Setting& s : o.settings) std::printf(" %14s", s.name.c_str());
  for (std::size_t i = 0; i < o.objects.size(); ++i) {
    std::printf("\n%-28s", o.objects[i].c_str());
    for (std::size_t s = 0; s < o.settings.size(); ++s) {
      int done = 0, dropped = 0;
      for (int k = 0; k < o.seeds; ++k) {
        const Trial& t = trials[s * per_setting + i * o.seeds + k];
        done += t.done;
        dropped += t.dropped;
      }
      std::printf(" %7d (%d)/%-2d", done, dropped, o.seeds);
    }
  }
  std::printf("\n\n");
  for (std::size_t s = 0; s < o.settings.size(); ++s) {
    int done = 0, dropped = 0;
    double rate = 0, offset = 0, tilt = 0, slips = 0;
    std::vector<double> rms;
    std::map<std::string, int> reasons;
    for (int k = 0; k < per_setting; ++k) {
      const Trial& t = trials[s * per_setting + k];
      done += t.done;
      dropped += t.dropped;
      slips += t.slips;
      if (!t.done) {
        ++reasons[Reason(t)];
        continue;
      }
      rms.push_back(1e3 * t.shape.rms_m);
      rate += 60 * std::abs(t.angle_deg) / t.time_s;
      offset = std::max(offset, t.offset_mm);
      tilt = std::max(tilt, t.tilt_deg);
    }
    std::printf(
        "%-10s completed %d of %d, dropped %d, %.0f deg/min, offset at most %.1f mm, tilt "
        "at most %.0f deg, %.1f slips a run\n",
        o.settings[s].name.c_str(), done, per_setting, dropped, rate / std::max(1, done), offset,
        tilt, slips / per_setting);
    std::sort(rms.begin(), rms.end());
    if (!rms.empty())
      std::printf("  felt surface off by rms %.2f mm (median), %.2f mm (90 %% of the completed)\n",
                  rms[rms.size() / 2], rms[rms.size() * 9 / 10]);
    for (const auto& [reason, count] : reasons) std::printf("  %3d %s\n", count, reason.c_str());
  }
  for (std::size_t a = 0; a < o.settings.size(); ++a)
    for (std::size_t b = a + 1; b < o.settings.size(); ++b) {
      int only_a = 0, only_b = 0;
      for (int k = 0; k < per_setting; ++k) {
        const bool in_a = trials[a * per_setting + k].done, in_b = trials[b * per_setting + k].done;
        only_a += in_a && !in_b;
        only_b += in_b && !in_a;
      }
      std::printf("only %s %d, only %s %d: McNemar p = %.2g\n", o.settings[a].name.c_str(), only_a,
                  o.settings[b].name.c_str(), only_b, McNemar(only_a, only_b));
    }
}

constexpr const char* kHelp =
    "zoo [OPTION]...    turns objects with seeds and settings side by side\n"
    "  --objects NAMES       separated by commas; zoo: every zoo_* and cube_* (default)\n"
    "  --seeds N             of each object (1), from --first N (1) on\n"
    "  --setting 'NAME: P=V ...'  parameters, noise.LEVEL=V, stepper=NAME; repeatable: compared\n"
    "  --hand NAME|FILE      (shadow)\n"
    "  --noise PRESET        (paper)\n"
    "  --axis X,Y,Z          of the turn, in W (0,0,-1)\n"
    "  --turns N             (1)\n"
    "  --tilt DEG            of the hand (the scenario's)\n"
    "  --push N              force each second [N] (0)\n"
    "  --limit S             simulated time of a turn, then it is too slow (600)\n"
    "  --jobs N              processes (2)\n"
    "  --rows                a line for each trial\n"
    "  --events              what happens, on standard error\n";

Options Parse(int argc, char** argv) {
  Options o;
  std::string objects = "zoo";
  for (int i = 1; i < argc; ++i) {
    const std::string a = argv[i];
    if (a == "--rows" || a == "--events") {
      (a == "--rows" ? o.rows : o.events) = true;
      continue;
    }
    if (++i >= argc) throw std::invalid_argument("zoo: " + a + " is no option or needs a value");
    const std::string value = argv[i];
    if (a == "--hand")
      o.hand = value;
    else if (a == "--objects")
      objects = value;
    else if (a == "--seeds")
      o.seeds = std::stoi(value);
    else if (a == "--first")
      o.first = std::stoull(value);
    else if (a == "--turns")
      o.turns = std::stod(value);
    else if (a == "--tilt")
      o.tilt = std::stod(value);
    else if (a == "--noise")
      o.noise = value;
    else if (a == "--push")
      o.push = std::stod(value);
    else if (a == "--limit")
      o.limit_s = std::stod(value);
    else if (a == "--jobs")
      o.jobs = std::stoi(value);
    else if (a == "--setting")
      o.settings.push_back(ParseSetting(value));
    else if (a == "--axis" &&
             std::sscanf(value.c_str(), "%lf,%lf,%lf", &o.axis[0], &o.axis[1], &o.axis[2]) == 3)
      o.axis.normalize();
    else
      throw std::invalid_argument("zoo: " + a + " " + value + " is not an option");
  }
  if (o.settings.empty()) o.settings.push_back({"default", {}, {}});
  if (objects == "zoo") {
    for (const std::string& name : ListObjects(ModelSearchPath()))
      if (name.starts_with("zoo_") || name.starts_with("cube_")) o.objects.push_back(name);
  } else {
    std::istringstream list(objects);
    for (std::string name; std::getline(list, name, ',');) o.objects.push_back(name);
  }
  for (const std::string& object : o.objects) MakeConfig(o, object, o.settings[0], 1);
  return o;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    for (int i = 1; i < argc; ++i)
      if (argv[i] == std::string("--help")) return std::fputs(kHelp, stdout) < 0 ? 74 : 0;
    const Options o = Parse(argc, argv);
    Print(o, RunAll(o));
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
