#include "core/session/session.h"

#include <chrono>

#include "core/session/session_impl.h"

namespace regrasp {
namespace {

class StageClock {
 public:
  explicit StageClock(bool on) : on_(on) {
    if (on_) last_ = std::chrono::steady_clock::now();
  }
  double Lap() {
    if (!on_) return 0;
    const auto now = std::chrono::steady_clock::now();
    const double s = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return s;
  }

 private:
  bool on_;
  std::chrono::steady_clock::time_point last_;
};

}  // namespace

Session::Impl::Impl(SessionConfig c)
    : config(std::move(c)),
      hand(config.model.hand),
      dt(config.world.dt),
      start(MakeStart(config.model.hand, config.model.scenario, config.parameters.start,
                      config.seed)),
      seed(config.seed),
      parameters(config.parameters),
      world(hand, config.model.object, config.world, start.q_open, start.X_WO),
      sensors(hand, dt, seed),
      estimator(hand, dt),
      judge(hand, dt),
      controller(hand, dt),
      torque(JointVector::Zero(hand.num_joints())) {
  world.SetStandIn(true);
  ApplyParameters();
  sensors.SetNoise(config.noise);
  tasks.resize(hand.fingers.size());
  Context().ToPosture(start.q_open);
  Sense();
}

FingerSet Session::Impl::GraspFingers() const {
  FingerSet fingers;
  for (int i = 0; i < hand.num_fingers(); ++i)
    if (tasks[i].mode != FingerMode::kPosture) fingers.add(i);
  return fingers;
}

ActivityContext Session::Impl::Context() {
  const ControlTick now{hand,
                        estimator.estimate(),
                        GraspFingers(),
                        monitor.margins(),
                        felt,
                        parameters.gravity_W,
                        control,
                        parameters.exploration,
                        parameters.gait,
                        dt};
  return {now, tick, seed, parameters, start, controller, tasks, world, judge, log, job};
}

Activity* Session::Impl::Running(SessionState in) {
  Activity* running = nullptr;
  ForEachActivity(activities, [&](const JobInfo& row, auto& activity) {
    if (row.state == in) running = &activity;
  });
  return running;
}

const SensorReading& Session::Impl::Sense() {
  FingerSet holding;
  for (int i = 0; i < hand.num_fingers(); ++i)
    if (tasks[i].mode == FingerMode::kHold) holding.add(i);
  const SensorReading& reading = sensors.Read(tick, world.state());
  estimator.Update(reading, parameters.control, holding);
  return reading;
}

void Session::Impl::HoldAll() {
  for (FingerTask& task : tasks) {
    if (task.mode == FingerMode::kPosture) continue;  // never took part in the grasp
    task.mode = FingerMode::kHold;
    task.cap = parameters.control.max_normal_force;
    task.grip = parameters.control.grip_force;
  }
}

ObjectMotion Session::Impl::Act() {
  if (state == SessionState::kHolding) HoldAll();
  Activity* running = Running(state);
  if (!running) return {};
  const ActivityStep step = running->Update(Context());
  if (step.ended()) Finish(step);
  return step.motion;
}

void Session::Impl::Tick() {
  if (state == SessionState::kFaulted) {
    ++tick;
    return;
  }
  StageClock clock(measure);
  const SensorReading& reading = Sense();
  if (tick % kJudgeInterval == 0) judge.Look(tick, world.state(), parameters.control);
  times.sense_s = clock.Lap();

  Feel(reading);
  CountOn();
  monitor.Update(Context().now);
  WatchContacts();
  WatchDrop();
  if (push_until >= 0 && tick >= push_until) {
    world.SetPush(Vector3d::Zero());
    push_until = -1;
  }
  motion = Act();
  torque = controller.Update(estimator.estimate(), tasks, motion, parameters.gravity_W, control);
  FeelFriction();
  if (const Activity* running = Running(state)) running->AddTorque(Context(), &torque);
  times.control_s = clock.Lap();

  world.SetTorque(torque);
  const StepStatus status = world.Step();
  ++tick;
  times.collide_s = world.stage_times().collide_s;
  times.step_s = world.stage_times().step_s;
  if (status == StepStatus::kFault) {
    log.Emit(tick, EventKind::kFault, -1, 0, "simulation fault: %s", world.fault_message());
    FinishJob(JobState::kFailed, "simulation fault");
    Enter(SessionState::kFaulted);
  }
}

Session::Session(SessionConfig config) : impl_(std::make_unique<Impl>(std::move(config))) {}
Session::~Session() = default;

Verdict Session::Apply(const Command& command) { return impl_->Apply(command); }
void Session::Tick() { impl_->Tick(); }
std::int64_t Session::tick() const { return impl_->tick; }
SessionState Session::state() const { return impl_->state; }
bool Session::job_running() const { return impl_->job_running(); }
const SessionConfig& Session::config() const { return impl_->config; }
const Parameters& Session::parameters() const { return impl_->parameters; }
const NoiseLevels& Session::noise() const { return impl_->sensors.noise(); }
std::uint64_t Session::seed() const { return impl_->seed; }

void Session::Snapshot(Frame* frame, bool with_hash) const {
  impl_->Snapshot(frame);
  if (with_hash) frame->state_hash = impl_->Hash();
}

std::uint64_t Session::StateHash() const { return impl_->Hash(); }
void Session::Load(std::string_view state) { impl_->Load(state); }

void Session::Save(std::string* state) const {
  FieldSaver saver(state);
  impl_->Fields(saver);
}

std::span<const Event> Session::TakeEvents() { return impl_->log.Take(); }

std::span<const JobRecord> Session::TakeFinishedJobs() {
  impl_->finished_out.clear();
  for (const JobRecord& job : impl_->finished) impl_->finished_out.push_back(job);
  impl_->finished.clear();
  return {impl_->finished_out.data(), impl_->finished_out.size()};
}

void Session::MeasureStages(bool on) {
  impl_->measure = on;
  impl_->world.MeasureStages(on);
}
Session::StageTimes Session::stage_times() const { return impl_->times; }
const WorldState& Session::truth() const { return impl_->world.state(); }
const FeltSurface& Session::felt_surface() const { return impl_->felt; }
const World& Session::world() const { return impl_->world; }

}  // namespace regrasp
