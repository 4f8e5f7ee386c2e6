#include "core/session/session.h"

#include <chrono>

#include "core/session/session_impl.h"

namespace regrasp {
namespace {

class StageClock {
 public:
  explicit StageClock(bool on) : on_(on) { Restart(); }
  double Lap() {
    if (!on_) return 0;
    const auto now = std::chrono::steady_clock::now();
    const double s = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return s;
  }

 private:
  void Restart() {
    if (on_) last_ = std::chrono::steady_clock::now();
  }
  bool on_;
  std::chrono::steady_clock::time_point last_;
};

}  // namespace

Session::Impl::Impl(SessionConfig c)
    : config(std::move(c)),
      hand(config.model.hand),
      dt(config.world.dt),
      parameters(config.parameters),
      noise(config.noise),
      object(std::make_shared<const ObjectModel>(config.model.object)),
      estimator(hand, dt),
      judge(hand, dt),
      controller(hand, dt) {
  Build(config.seed);
}

void Session::Impl::Sense() {
  reading = &sensors->Read(tick, world->state());
  estimator.Update(*reading, parameters.control);
}

void Session::Impl::Tick() {
  if (state == SessionState::kFaulted) {
    ++tick;
    return;
  }
  StageClock clock(measure);
  Sense();
  if (tick % kJudgeInterval == 0) LookAtTruth();
  times.sense_s = clock.Lap();

  Feel();
  monitor.Update(estimator.estimate(), GraspFingers(), parameters.gravity_W, parameters.control,
                 dt);
  WatchContacts();
  WatchDrop();
  if (push_until >= 0 && tick >= push_until) {
    world->SetPush(Vector3d::Zero());
    push_until = -1;
  }
  motion = ObjectMotion();
  if (release_tick >= 0) {
    UpdateRelease();
  } else if (state == SessionState::kGrasping) {
    UpdateGrasp();
  } else if (state == SessionState::kExploring) {
    UpdateExploration();
  } else if (state == SessionState::kRotating) {
    UpdateRotation();
  } else if (state == SessionState::kMoving) {
    UpdateMove();
  } else if (state == SessionState::kHolding) {
    HoldAll();
  }
  torque = controller.Update(estimator.estimate(), tasks, motion, parameters.gravity_W,
                             parameters.control);
  AddReleasePull();
  times.control_s = clock.Lap();

  world->SetTorque(torque);
  const StepStatus status = world->Step();
  ++tick;
  times.collide_s = world->stage_times().collide_s;
  times.step_s = world->stage_times().step_s;
  if (status == StepStatus::kFault) {
    Emit(EventKind::kFault, -1, 0, "simulation fault: %.60s", world->fault_message());
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
const NoiseLevels& Session::noise() const { return impl_->noise; }
std::uint64_t Session::seed() const { return impl_->seed; }
const std::string& Session::object_name() const { return impl_->object->name; }

void Session::Snapshot(Frame* frame, bool with_hash) const {
  impl_->Snapshot(frame);
  if (with_hash) frame->state_hash = impl_->Hash();
}

std::uint64_t Session::StateHash() const { return impl_->Hash(); }

std::span<const Event> Session::TakeEvents() {
  impl_->events_out = impl_->events;
  impl_->events.clear();
  return {impl_->events_out.data(), impl_->events_out.size()};
}

std::span<const JobRecord> Session::TakeFinishedJobs() {
  impl_->finished_out = impl_->finished;
  impl_->finished.clear();
  return {impl_->finished_out.data(), impl_->finished_out.size()};
}

void Session::MeasureStages(bool on) {
  impl_->measure = on;
  impl_->world->MeasureStages(on);
}
Session::StageTimes Session::stage_times() const { return impl_->times; }
const RegraspRecord& Session::last_regrasp() const { return impl_->regrasp; }
const WorldState& Session::truth() const { return impl_->world->state(); }
const FeltSurface& Session::felt_surface() const { return impl_->felt; }
const World& Session::world() const { return *impl_->world; }

}  // namespace regrasp
