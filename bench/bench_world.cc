/// Cost and quality of the steppers. A hand holds a sphere with all five fingers: posture spring 3
/// N m/rad about the posture in which the fingers touch, --grip N per finger towards the centre of
/// the sphere, gravity compensation; the joint angles that the springs see carry --noise degrees of
/// white noise behind a 10 ms filter. Everything but the stepper is the same in all rows, and the
/// rows are interleaved in time.
///
///   bench_world [--seconds 5] [--grip 1] [--noise 0.3] [--object sphere] [--sweep]

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/common/random.h"
#include "core/hand/kinematics.h"
#include "core/hand/scenario.h"
#include "core/world/world.h"
#include "tests/physics/grasp_posture.h"

namespace regrasp {
namespace {

constexpr double kSpring = 3.0;  // [N m/rad]
constexpr double kFilter = 0.1;  // dt / 10 ms
constexpr double kCreep = 0.1;   // dt / 10 ms
constexpr int kRelease = 500;    // tick at which the stand-in lets go
constexpr int kSettle = 1500;    // ticks before anything is measured

struct Options {
  double seconds = 5;
  double grip = 1.0;       // [N]
  double noise_deg = 0.3;  // of the joint angles
  std::string object = "sphere";
  bool sweep = false;
};

struct Candidate {
  std::string name;
  WorldConfig config;
};

class Run {
 public:
  Run(const LoadedScenario& s, const Candidate& candidate, const Options& options)
      : s_(s),
        options_(options),
        world_(s.hand, s.object, candidate.config, GraspPosture(s.hand), GraspObjectPose()),
        rest_(GraspPosture(s.hand)),
        noise_(JointVector::Zero(s.hand.num_joints())),
        random_(7, 0) {
    world_.SetGravity(GraspGravity());
    world_.MeasureStages(true);
  }

  bool Tick() {
    const WorldState& now = world_.state();
    ForwardKinematics(s_.hand, now.q, &kinematics_);
    JointVector torque = GravityTorque(s_.hand, kinematics_, GraspGravity());
    for (int i = 0; i < noise_.size(); ++i)
      noise_[i] += kFilter * (options_.noise_deg / 57.29577951 * random_.Normal() - noise_[i]);
    // The springs creep while the fingers close on an object of whatever size.
    if (tick_ < kRelease) rest_ += kCreep * (now.q - rest_);
    torque += kSpring * (rest_ - now.q - noise_);
    for (int f = 0; f < s_.hand.num_fingers(); ++f) {
      const Vector3d p = FingertipCentre(s_.hand, kinematics_, f);
      const FingerVector t = PointJacobian(s_.hand, kinematics_, f, p).transpose() *
                             (options_.grip * (now.p_WO - p).normalized());
      for (std::size_t k = 0; k < s_.hand.fingers[f].joints.size(); ++k)
        torque[s_.hand.fingers[f].joints[k]] += t[k];
    }
    world_.SetTorque(torque);
    if (tick_ == kRelease) world_.SetStandIn(false);
    if (world_.Step() != StepStatus::kOk) return false;
    if (++tick_ > kSettle) Measure();
    return true;
  }

  void Print(const std::string& name, const Run& reference) {
    const double exact_sd = reference.ForceSd();
    std::printf("%-34s %7.1f %7.1f %7.1f   %7.4f %6.2f %8.1f %8.3f %6.2f %6.1f  %s\n", name.c_str(),
                1e6 * Median(collide_), 1e6 * Median(step_), 1e6 * Median(total_), ForceSd(),
                ForceSd() / exact_sd, 1e6 * drift_, std::sqrt(rate_ / samples_),
                double(contacts_) / samples_,
                1e6 * (world_.state().p_WO - p_start_).norm() / (1e-3 * samples_),
                world_.fault_message());
  }

 private:
  void Measure() {
    const WorldState& now = world_.state();
    if (samples_ == 0) p_start_ = now.p_WO;
    const World::StageTimes t = world_.stage_times();
    collide_.push_back(t.collide_s);
    step_.push_back(t.step_s);
    total_.push_back(t.collide_s + t.step_s);
    drift_ = std::max(drift_, world_.JointDrift());
    rate_ += now.qdot.squaredNorm() / now.qdot.size();
    ++samples_;
    contacts_ += static_cast<long>(now.contacts.size());
    for (const ObjectContact& c : now.contacts) {
      if (c.finger < 0) continue;
      Sum& sum = forces_[c.finger];
      const double f = -c.force_W.dot(c.normal_W);
      // Noise: what is left after a 50 ms running mean.
      sum.slow += 0.02 * (f - sum.slow);
      if (tick_ < kSettle + 200) continue;
      ++sum.n;
      sum.square += (f - sum.slow) * (f - sum.slow);
    }
  }
  double ForceSd() const {
    double sd = 0;
    for (const auto& [finger, sum] : forces_) sd += std::sqrt(sum.square / std::max(1L, sum.n));
    return sd / std::max<std::size_t>(1, forces_.size());
  }
  static double Median(std::vector<double> values) {
    if (values.empty()) return 0;
    std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
    return values[values.size() / 2];
  }

  struct Sum {
    long n = 0;
    double slow = 0, square = 0;
  };
  const LoadedScenario& s_;
  const Options& options_;
  World world_;
  JointVector rest_, noise_;
  RandomStream random_;
  KinematicsData kinematics_;
  int tick_ = 0;
  std::vector<double> collide_, step_, total_;
  std::map<int, Sum> forces_;
  Vector3d p_start_ = Vector3d::Zero();
  double drift_ = 0, rate_ = 0;
  long samples_ = 0, contacts_ = 0;
};

Candidate Make(const std::string& name, Stepper stepper, bool merge) {
  Candidate c{name, {}};
  c.config.stepper = stepper;
  c.config.merge_universal = merge;
  return c;
}

std::vector<Candidate> Standard() {
  return {Make("exact, 22 hinges (baseline)", Stepper::kExact, false),
          Make("exact, universal", Stepper::kExact, true), Make("fast", Stepper::kFast, true),
          Make("fast, 22 hinges", Stepper::kFast, false)};
}

std::vector<Candidate> Sweep() {
  std::vector<Candidate> list = Standard();
  for (const int sweeps : {1, 5, 1000}) {
    char name[80];
    std::snprintf(name, sizeof(name), "fast, at most %d sweeps alone", sweeps);
    list.push_back(Make(name, Stepper::kFast, true));
    list.back().config.contact_solver.max_sweeps = sweeps;
    list.back().config.contact_solver.direct_solutions = 0;
  }
  return list;
}

int Main(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    if (name == "--sweep") {
      options.sweep = true;
      continue;
    }
    const char* value = i + 1 < argc ? argv[++i] : "";
    if (name == "--seconds") {
      options.seconds = std::atof(value);
    } else if (name == "--grip") {
      options.grip = std::atof(value);
    } else if (name == "--noise") {
      options.noise_deg = std::atof(value);
    } else if (name == "--object") {
      options.object = value;
    } else {
      std::fprintf(stderr, "bench_world: unknown option %s\n", name.c_str());
      return 2;
    }
  }
  const LoadedScenario scenario = LoadScenario("shadow", options.object, ModelSearchPath());
  const std::vector<Candidate> candidates = options.sweep ? Sweep() : Standard();
  std::vector<std::unique_ptr<Run>> runs;
  for (const Candidate& c : candidates) runs.push_back(std::make_unique<Run>(scenario, c, options));
  std::vector<bool> alive(runs.size(), true);
  const int ticks = kSettle + static_cast<int>(options.seconds * 1000);
  // In blocks, so that a slow spell of the machine hits every row.
  for (int done = 0; done < ticks; done += 100)
    for (std::size_t i = 0; i < runs.size(); ++i)
      for (int k = 0; k < 100 && alive[i]; ++k) alive[i] = runs[i]->Tick();
  std::printf("%-34s %7s %7s %7s   %7s %6s %8s %8s %6s %5s\n", "stepper", "collide", "step",
              "sum us", "F sd N", "rel", "drift um", "rate rms", "conts", "creep");
  for (std::size_t i = 0; i < runs.size(); ++i) runs[i]->Print(candidates[i].name, *runs[1]);
  return 0;
}

}  // namespace
}  // namespace regrasp

int main(int argc, char** argv) { return regrasp::Main(argc, argv); }
