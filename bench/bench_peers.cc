/// The same hand, ball and torques in our two steps and in the engines this machine has, in turn in
/// one run: what a step costs, and how good the contacts are that it pays for. Five fingers hold
/// the ball: springs of 3 N m/rad about the posture in which they touch, 1 N per finger towards its
/// centre, gravity compensation; the joint angles that the springs see carry 0.3 degrees of noise
/// behind a 10 ms filter. One row is a whole tick of the product (sensing, estimation, control,
/// collision, step) while it holds. Engines are optional: libmujoco-dev, libbullet-dev.
///
///   bench_peers [--seconds 10]

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>

#include "bench/peers/engine.h"
#include "core/common/random.h"
#include "core/hand/kinematics.h"
#include "core/session/session.h"
#include "core/world/world.h"
#include "tests/physics/grasp_posture.h"

namespace regrasp::bench {
namespace {

constexpr int kBlock = 100;               // ticks a row runs before the next row's turn
constexpr int kRelease = 500;             // tick at which the object is let go
constexpr int kSettle = 1500;             // ticks before anything is measured
constexpr int kWindow = 500;              // ticks over which a contact point is averaged
constexpr double kSpring = 3.0;           // [N m/rad]
constexpr double kGrip = 1.0;             // [N]
constexpr double kFilter = 0.1;           // dt / 10 ms
constexpr double kNoise = 0.3 / 57.2958;  // [rad]

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

class Ours : public Engine {
 public:
  Ours(const LoadedScenario& model, const WorldConfig& config, const JointVector& q0,
       const Isometry3d& X_WO, const Vector3d& gravity_W)
      : world_(model.hand, model.object, config, q0, X_WO) {
    world_.SetGravity(gravity_W);
  }
  void Step(const JointVector& torque, bool held) override {
    world_.SetTorque(torque);
    world_.SetStandIn(held);
    world_.Step();
  }
  const JointVector& q() const override { return world_.state().q; }
  Vector3d p_WO() const override { return world_.state().p_WO; }
  Quaterniond q_WO() const override { return world_.state().q_WO; }
  std::vector<Touch> touches() const override {
    std::vector<Touch> found;
    for (const ObjectContact& c : world_.state().contacts)
      if (c.finger >= 0) found.push_back({c.finger, c.p_WC, -c.force_W.dot(c.normal_W)});
    return found;
  }
  double joint_drift() const override { return world_.JointDrift(); }

 private:
  World world_;
};

struct Times {
  std::vector<double> us;
  double Quantile(double q) const {
    std::vector<double> sorted = us;
    const auto k = static_cast<std::ptrdiff_t>(q * static_cast<double>(sorted.size() - 1));
    std::nth_element(sorted.begin(), sorted.begin() + k, sorted.end());
    return sorted[static_cast<std::size_t>(k)];
  }
  /// Without the slowest thousandth: the other programs of the machine.
  double Mean() const {
    const double cut = Quantile(.999);
    double sum = 0;
    long n = 0;
    for (const double t : us)
      if (t <= cut) sum += t, ++n;
    return sum / static_cast<double>(n);
  }
};

/// One engine, held by the springs, and what was measured of it.
class Row {
 public:
  Row(std::string name, std::unique_ptr<Engine> engine, const LoadedScenario& model)
      : name_(std::move(name)),
        engine_(std::move(engine)),
        model_(model),
        rest_(engine_->q()),
        noise_(JointVector::Zero(model.hand.num_joints())),
        random_(7, 0) {}

  void Tick() {
    const JointVector torque = Torque();
    const double start = Now();
    engine_->Step(torque, tick_ < kRelease);
    const double end = Now();
    if (++tick_ > kSettle) Measure(1e6 * (end - start));
  }

  void Print(const Row& reference, double exact_noise) const {
    double creep = 0;
    for (const Finger& f : fingers_)
      if (f.first_n > 0 && f.last_n > 0)
        creep = std::max(creep, 1e6 * (f.last / f.last_n - f.first / f.first_n).norm() /
                                    (1e-3 * static_cast<double>(times_.us.size() - kWindow)));
    std::printf("%-34s %7.1f %7.1f %7.1f  %6.2f %6.2f   %8.2f %8.4f %6.2f %9.2f %8.2f\n",
                name_.c_str(), times_.Quantile(.5), times_.Mean(), times_.Quantile(.99),
                times_.Quantile(.5) / reference.median(), times_.Mean() / reference.mean(), creep,
                ForceNoise(), ForceNoise() / exact_noise, 1e6 * drift_,
                static_cast<double>(touching_) / static_cast<double>(times_.us.size()));
  }
  double median() const { return times_.Quantile(.5); }
  double mean() const { return times_.Mean(); }
  double ForceNoise() const {
    return forces_ ? std::sqrt(square_ / static_cast<double>(forces_)) : 0;
  }
  void set_ticks(int ticks) { ticks_ = ticks; }

 private:
  struct Finger {
    Vector3d first = Vector3d::Zero(), last = Vector3d::Zero();
    double first_n = 0, last_n = 0, slow = 0;
    long n = 0;
  };

  JointVector Torque() {
    const JointVector& q = engine_->q();
    KinematicsData data;
    ForwardKinematics(model_.hand, q, &data);
    JointVector torque = GravityTorque(model_.hand, data, GraspGravity());
    for (int i = 0; i < noise_.size(); ++i)
      noise_[i] += kFilter * (kNoise * random_.Normal() - noise_[i]);
    if (tick_ < kRelease) rest_ += kFilter * (q - rest_);
    torque += kSpring * (rest_ - q - noise_);
    for (int f = 0; f < model_.hand.num_fingers(); ++f) {
      const Vector3d p = FingertipCentre(model_.hand, data, f);
      const FingerVector t = PointJacobian(model_.hand, data, f, p).transpose() *
                             (kGrip * (engine_->p_WO() - p).normalized());
      for (std::size_t k = 0; k < model_.hand.fingers[f].joints.size(); ++k)
        torque[model_.hand.fingers[f].joints[k]] += t[static_cast<Eigen::Index>(k)];
    }
    return torque;
  }

  void Measure(double us) {
    times_.us.push_back(us);
    drift_ = std::max(drift_, engine_->joint_drift());
    const int k = tick_ - kSettle;
    for (const Touch& touch : engine_->touches()) {
      Finger& f = fingers_[static_cast<std::size_t>(touch.finger)];
      ++touching_;
      const Vector3d p_O = engine_->q_WO().conjugate() * (touch.p_W - engine_->p_WO());
      if (k <= kWindow) f.first += p_O, ++f.first_n;
      if (k > ticks_ - kWindow) f.last += p_O, ++f.last_n;
      // Noise: what is left after a 50 ms running mean.
      f.slow += 0.02 * (touch.normal_force - f.slow);
      if (++f.n < 200) continue;
      ++forces_;
      square_ += (touch.normal_force - f.slow) * (touch.normal_force - f.slow);
    }
  }

  std::string name_;
  std::unique_ptr<Engine> engine_;
  const LoadedScenario& model_;
  JointVector rest_, noise_;
  RandomStream random_;
  int tick_ = 0, ticks_ = 0;
  Times times_;
  std::array<Finger, kMaxFingers> fingers_;
  double drift_ = 0, square_ = 0;
  long forces_ = 0, touching_ = 0;
};

/// The product's whole tick while it holds.
class Product {
 public:
  explicit Product(const LoadedScenario& model) {
    SessionConfig config;
    config.model = model;
    config.parameters = DefaultParameters(model);
    config.noise = NoisePreset("paper").value();
    session_ = std::make_unique<Session>(std::move(config));
    Command grasp;
    grasp.type = CommandType::kGrasp;
    session_->Apply(grasp);
    for (int k = 0; k < 20000 && session_->state() != SessionState::kHolding; ++k) Tick();
    times_.us.clear();
  }
  void Tick() {
    const double start = Now();
    session_->Tick();
    times_.us.push_back(1e6 * (Now() - start));
    session_->TakeEvents();
    session_->TakeFinishedJobs();
  }
  void Print(const Row& reference) const {
    std::printf("%-34s %7.1f %7.1f %7.1f  %6.2f %6.2f\n", "regrasp, the whole tick",
                times_.Quantile(.5), times_.Mean(), times_.Quantile(.99),
                times_.Quantile(.5) / reference.median(), times_.Mean() / reference.mean());
  }

 private:
  std::unique_ptr<Session> session_;
  Times times_;
};

int Main(int argc, char** argv) {
  double seconds = 10;
  if (argc == 3 && std::string(argv[1]) == "--seconds") {
    seconds = std::atof(argv[2]);
  } else if (argc != 1) {
    std::fprintf(stderr, "usage: bench_peers [--seconds N]\n");
    return 2;
  }
  const LoadedScenario model = LoadScenario("shadow", "sphere", ModelSearchPath());
  const JointVector q0 = GraspPosture(model.hand);
  const auto ours = [&](Stepper stepper, bool merge) {
    WorldConfig config;
    config.stepper = stepper;
    config.merge_universal = merge;
    return std::make_unique<Ours>(model, config, q0, GraspObjectPose(), GraspGravity());
  };
  std::vector<Row> rows;
  rows.emplace_back("regrasp, fast step", ours(Stepper::kFast, true), model);
  rows.emplace_back("ODE dWorldStep, universal joints", ours(Stepper::kExact, true), model);
  rows.emplace_back("ODE dWorldStep, 22 hinges", ours(Stepper::kExact, false), model);
#ifdef REGRASP_HAVE_MUJOCO
  rows.emplace_back("MuJoCo mj_step", MakeMujoco(model, q0, GraspObjectPose(), GraspGravity()),
                    model);
#endif
#ifdef REGRASP_HAVE_BULLET
  rows.emplace_back("Bullet stepSimulation",
                    MakeBullet(model, q0, GraspObjectPose(), GraspGravity()), model);
#endif
  Product product(model);
  const int ticks = static_cast<int>(seconds * 1000);
  for (Row& row : rows) row.set_ticks(ticks);
  for (int done = 0; done < ticks + kSettle; done += kBlock) {
    for (Row& row : rows)
      for (int k = 0; k < kBlock; ++k) row.Tick();
    for (int k = 0; k < kBlock; ++k) product.Tick();
  }
#ifdef REGRASP_HAVE_MUJOCO
  const Row& reference = rows[3];
  std::printf("ratios: to MuJoCo's median and mean\n");
#else
  const Row& reference = rows[2];
  std::printf("ratios: to dWorldStep with 22 hinges (no MuJoCo when this was built)\n");
#endif
  std::printf("%-34s %7s %7s %7s  %6s %6s   %8s %8s %6s %9s %8s\n", "collision and step [us]",
              "median", "mean", "p99", "ratio", "mean", "creep", "force sd", "rel", "drift um",
              "contacts");
  for (const Row& row : rows) row.Print(reference, rows[1].ForceNoise());
  product.Print(reference);
  std::printf(
      "creep: the fastest contact point on the object [um/s]; force sd [N] and relative to "
      "dWorldStep with universal joints\n");
  return 0;
}

}  // namespace
}  // namespace regrasp::bench

int main(int argc, char** argv) { return regrasp::bench::Main(argc, argv); }
