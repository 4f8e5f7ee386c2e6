#include "core/session/session.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "core/common/random.h"
#include "core/control/grasp_sequence.h"
#include "core/control/hybrid_controller.h"
#include "core/exploration/finger_exploration.h"
#include "core/gait/finger_gait.h"
#include "core/quality/manipulability.h"
#include "core/sensing/sensors.h"
#include "core/session/quality_monitor.h"

namespace regrasp {
namespace {

constexpr std::uint64_t kStartStream = 1000;  // random stream of the start posture
constexpr std::size_t kMaxPending = 64;
constexpr int kJudgeInterval = 10;           // ticks between looks at the truth
constexpr double kDropContactTime_s = 0.25;  // fewer than two contacts for so long: dropped
constexpr double kReleaseTime_s = 0.5;
constexpr double kReleasePull_n = 12.0;  // lets go at once, so that no finger drags on the object
constexpr double kReleasePullTime_s = 0.01;

/// Filters off: turns noise-free readings into the truth in the controller's own terms.
ControlParameters Unfiltered(ControlParameters parameters) {
  parameters.joint_filter_s = parameters.force_filter_s = 0;
  parameters.contact_filter_s = parameters.pose_filter_s = 0;
  parameters.contact_from_normal = 0;
  return parameters;
}

template <typename... Args>
void Print(char (&text)[96], const char* format, Args... args) {
  std::snprintf(text, sizeof(text), format, args...);
}

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

Verdict Check(CommandType type, SessionState state, bool job_running) {
  using Kind = Verdict::Kind;
  const bool faulted = state == SessionState::kFaulted;
  switch (type) {
    case CommandType::kReset:
      return {};
    case CommandType::kStop:
    case CommandType::kCancelJob:
    case CommandType::kNoise:
    case CommandType::kParameter:
      if (faulted) return {Kind::kBadState, "the simulation is faulted", "regrasp reset"};
      return {};
    case CommandType::kPush:
      if (faulted) return {Kind::kBadState, "the simulation is faulted", "regrasp reset"};
      if (state == SessionState::kDropped || state == SessionState::kIdle)
        return {Kind::kBadState, "the hand does not hold the object", "regrasp grasp"};
      return {};
    case CommandType::kGrasp:
      if (job_running) return {Kind::kBusy, "another job is running", "regrasp stop"};
      if (state == SessionState::kHolding)
        return {Kind::kBadState, "the hand already holds the object", "regrasp release"};
      if (state != SessionState::kIdle)
        return {Kind::kBadState, "the object is not presented to the hand", "regrasp reset"};
      return {};
    case CommandType::kRelease:
      if (job_running) return {Kind::kBusy, "another job is running", "regrasp stop"};
      if (state != SessionState::kHolding)
        return {Kind::kBadState, "the hand does not hold the object", "regrasp grasp"};
      return {};
    case CommandType::kExplore:
    case CommandType::kRotate:
      if (job_running) return {Kind::kBusy, "another job is running", "regrasp stop"};
      if (state == SessionState::kDropped || faulted)
        return {Kind::kBadState, "the hand does not hold the object", "regrasp reset"};
      if (state != SessionState::kHolding)
        return {Kind::kBadState, "the hand does not hold the object", "regrasp grasp"};
      return {};
  }
  return {};
}

struct Session::Impl {
  explicit Impl(SessionConfig c)
      : config(std::move(c)),
        hand(config.model.hand),
        dt(config.world.dt),
        parameters(config.parameters),
        noise(config.noise),
        object(std::make_shared<const ObjectModel>(config.model.object)),
        estimator(hand, dt),
        judge(hand, dt),
        controller(hand, dt),
        grasp(hand, dt) {
    Build(config.seed);
  }

  // ---- construction
  // ---------------------------------------------------------------------------------
  void Build(std::uint64_t new_seed) {
    seed = new_seed;
    RandomStream start(seed, kStartStream);
    const Scenario& scenario = config.model.scenario;
    JointVector q0 = scenario.q_preshape;
    q_closed = scenario.q_closed;
    for (int j = 0; j < hand.num_joints(); ++j) {
      // The same offset for both, so that the fingers really touch elsewhere.
      const double offset = parameters.start.joint_sigma_rad * start.Normal();
      q0[j] = std::clamp(q0[j] + offset, hand.joints[j].lower, hand.joints[j].upper);
      q_closed[j] = std::clamp(q_closed[j] + offset, hand.joints[j].lower, hand.joints[j].upper);
    }
    Displace(scenario.X_WO.translation(), &start, {&q0, &q_closed});
    Isometry3d X_WO = scenario.X_WO;
    X_WO.translation() += parameters.start.object_sigma_m * start.Normal3();
    world = std::make_unique<World>(hand, *object, config.world, q0, X_WO, seed);
    world->SetStandIn(true);
    world->SetFriction(parameters.object.friction);
    world->SetMass(parameters.object.mass_kg);
    world->SetGravity(parameters.gravity_W);
    world->MeasureStages(measure);
    sensors = std::make_unique<Sensors>(hand, dt, seed);
    sensors->SetNoise(noise);
    judge_sensors = std::make_unique<Sensors>(hand, dt, 0);
    estimator.Reset();
    judge.Reset();
    controller = HybridController(hand, dt);
    grasp = GraspSequence(hand, dt);
    exploration = FingerExploration();
    gait = FingerGait();
    regrasp = RegraspRecord();
    monitor = QualityMonitor();
    q_open = q0;
    tick = 0;
    state = SessionState::kIdle;
    job = JobRecord();
    push_until = -1;
    drop_ticks = 0;
    release_tick = -1;
    tasks.resize(hand.fingers.size());
    was_in_contact.fill(false);
    ToPosture(q_open);
    torque = JointVector::Zero(hand.num_joints());
    Sense();
  }

  /// Moves each fingertip's way in by start.displacement_m, along the surface in a random
  /// direction.
  void Displace(const Vector3d& p_WO, RandomStream* random,
                std::initializer_list<JointVector*> postures) {
    for (int i = 0; i < hand.num_fingers(); ++i) {
      const Vector3d direction = random->Normal3();
      if (parameters.start.displacement_m == 0) continue;
      for (JointVector* q : postures) {
        KinematicsData data;
        ForwardKinematics(hand, *q, &data);
        const Vector3d tip = FingertipCentre(hand, data, i);
        const Vector3d target =
            tip + parameters.start.displacement_m *
                      TangentPart(direction, (tip - p_WO).normalized()).normalized();
        MoveTip(i, target, q);
      }
    }
  }

  /// Inverse kinematics by damped least squares; stops at joint limits.
  void MoveTip(int finger, const Vector3d& target, JointVector* q) const {
    KinematicsData data;
    for (int k = 0; k < 20; ++k) {
      ForwardKinematics(hand, *q, &data);
      const Vector3d tip = FingertipCentre(hand, data, finger);
      const FingerJacobian J = PointJacobian(hand, data, finger, tip);
      const Matrix3d JJt = J * J.transpose() + 1e-5 * Matrix3d::Identity();
      const FingerVector dq = J.transpose() * (JJt.inverse() * (target - tip));
      for (std::size_t n = 0; n < hand.fingers[finger].joints.size(); ++n) {
        const int j = hand.fingers[finger].joints[n];
        (*q)[j] = std::clamp((*q)[j] + dq[static_cast<Eigen::Index>(n)], hand.joints[j].lower,
                             hand.joints[j].upper);
      }
    }
  }

  void ToPosture(const JointVector& q) {
    for (int i = 0; i < hand.num_fingers(); ++i) {
      const auto& joints = hand.fingers[i].joints;
      tasks[i] = FingerTask();
      tasks[i].q_target.resize(static_cast<Eigen::Index>(joints.size()));
      for (std::size_t k = 0; k < joints.size(); ++k) tasks[i].q_target[k] = q[joints[k]];
    }
  }

  void HoldAll() {
    for (FingerTask& task : tasks) {
      if (task.mode == FingerMode::kPosture) continue;  // never took part in the grasp
      task.mode = FingerMode::kHold;
      task.cap = parameters.control.max_normal_force;
      task.grip = parameters.control.grip_force;
    }
  }

  // ---- events and jobs
  // ------------------------------------------------------------------------------
  template <typename... Args>
  void Emit(EventKind kind, int finger, double value, const char* format, Args... args) {
    Event event;
    event.tick = tick;
    event.kind = kind;
    event.finger = finger;
    event.value = value;
    Print(event.text, format, args...);
    events.push_back(event);
  }

  void Enter(SessionState next) {
    if (state == next) return;
    state = next;
    Emit(EventKind::kState, -1, static_cast<double>(next), "%s", Name(next).data());
  }

  bool job_running() const { return job.id != 0 && job.state == JobState::kRunning; }

  void StartJob(const Command& command, JobMethod method) {
    job = JobRecord();
    job.id = command.job;
    job.method = method;
    job.state = JobState::kRunning;
    job.start_tick = tick;
    Emit(EventKind::kJobStarted, command.finger, static_cast<double>(job.id), "job %lld: %s",
         static_cast<long long>(job.id), Name(method).data());
  }

  void FinishJob(JobState end, const char* error) {
    if (!job_running()) return;
    job.state = end;
    job.end_tick = tick;
    if (end == JobState::kDone) job.progress = 1;
    std::snprintf(job.error, sizeof(job.error), "%s", error);
    Emit(EventKind::kJobFinished, job.explore.finger, static_cast<double>(job.id),
         "job %lld: %s%s%s", static_cast<long long>(job.id), Name(end).data(), *error ? ": " : "",
         error);
    finished.push_back(job);
  }

  Verdict Refuse(const Command& command, const Verdict& verdict) {
    if (const auto method = JobMethodOf(command.type)) {
      JobRecord refused;
      refused.id = command.job;
      refused.method = *method;
      refused.state = JobState::kFailed;
      refused.start_tick = refused.end_tick = tick;
      refused.explore.finger = command.finger;
      std::snprintf(refused.error, sizeof(refused.error), "%s", verdict.reason);
      finished.push_back(refused);
    }
    Emit(EventKind::kRefused, command.finger, static_cast<double>(command.job), "refused: %s",
         verdict.reason);
    return verdict;
  }

  /// A finger may leave the grasp only when it touches and the others keep a load margin without
  /// it.
  Verdict MayExplore(int finger) {
    constexpr auto kRefused = Verdict::Kind::kBadState;
    if (finger < 0 || finger >= hand.num_fingers())
      return {kRefused, "no such finger", "regrasp contacts"};
    const char* name = hand.fingers[finger].name.c_str();
    const double margin = monitor.load_margin_without(finger);
    if (!estimator.estimate().fingers[finger].in_contact) {
      std::snprintf(refusal_text, sizeof(refusal_text), "%s does not touch the object", name);
    } else if (margin < parameters.gait.margin_min) {
      std::snprintf(refusal_text, sizeof(refusal_text),
                    "%s may not leave: the load margin without it is %.2f N, below %.2f N", name,
                    margin, parameters.gait.margin_min);
    } else {
      return {};
    }
    return {kRefused, refusal_text, "regrasp quality"};
  }

  // ---- commands
  // -------------------------------------------------------------------------------------
  Verdict Apply(const Command& command) {
    const Verdict verdict = Check(command.type, state, job_running());
    if (verdict.kind != Verdict::Kind::kAllowed) return Refuse(command, verdict);
    switch (command.type) {
      case CommandType::kGrasp:
        if (!world->stand_in())
          return Refuse(command, {Verdict::Kind::kBadState,
                                  "the object is not presented to the hand", "regrasp reset"});
        StartJob(command, JobMethod::kGrasp);
        grasp.Start(estimator.estimate());
        Enter(SessionState::kGrasping);
        break;
      case CommandType::kRelease:
        StartJob(command, JobMethod::kRelease);
        release_tick = tick;
        break;
      case CommandType::kExplore:
        if (const Verdict refusal = MayExplore(command.finger);
            refusal.kind != Verdict::Kind::kAllowed)
          return Refuse(command, refusal);
        StartJob(command, JobMethod::kExplore);
        job.explore.finger = command.finger;
        job.explore.criterion = command.criterion;
        job.explore.estimator = command.estimator;
        job.explore.seed = command.seed;
        exploration.Start({command.finger, command.criterion, command.estimator, command.seed,
                           command.max_cycles});
        Enter(SessionState::kExploring);
        break;
      case CommandType::kRotate:
        StartJob(command, JobMethod::kRotate);
        StartRotation(command);
        break;
      case CommandType::kStop:
        StopJob();
        break;
      case CommandType::kCancelJob:
        if (job_running() && job.id == command.job) StopJob();
        break;
      case CommandType::kNoise:
        noise = command.noise;
        sensors->SetNoise(noise);
        Emit(EventKind::kNoise, -1, 0, "noise %s", NoiseName(noise).data());
        break;
      case CommandType::kPush:
        push_until = tick + static_cast<std::int64_t>(std::lround(command.duration_s / dt));
        world->SetPush(command.force_W);
        Emit(EventKind::kPush, -1, command.force_W.norm(), "push %.3g N for %.3g s",
             command.force_W.norm(), command.duration_s);
        break;
      case CommandType::kParameter:
        SetParameter(command);
        break;
      case CommandType::kReset:
        if (command.object) {
          object = command.object;
          parameters.object.friction = object->friction;
          parameters.object.mass_kg = object->mass;
        }
        FinishJob(JobState::kCancelled, "reset");
        Build(command.seed);
        Emit(EventKind::kReset, -1, static_cast<double>(seed), "reset: seed %llu, object %s",
             static_cast<unsigned long long>(seed), object->name.c_str());
        break;
    }
    return verdict;
  }

  void SetParameter(const Command& command) {
    const ParameterInfo& info = ParameterTable()[command.parameter];
    double* p = info.access(parameters);
    for (int k = 0; k < info.size; ++k) p[k] = command.value[k];
    world->SetFriction(parameters.object.friction);
    world->SetMass(parameters.object.mass_kg);
    world->SetGravity(parameters.gravity_W);
    Emit(EventKind::kParameter, -1, command.value[0], "%s = %.6g", info.name.data(),
         command.value[0]);
  }

  void StopJob() {
    if (!job_running()) return;
    switch (job.method) {
      case JobMethod::kGrasp:
        FinishJob(JobState::kCancelled, "");
        if (grasp.phase() < GraspSequence::Phase::kAlone) {
          ToPosture(q_open);
          Enter(SessionState::kIdle);
        } else {
          Enter(SessionState::kHolding);
        }
        break;
      case JobMethod::kExplore:
        job.explore.reason = ExploreReason::kCancelled;
        exploration.Stop();
        break;
      case JobMethod::kRotate:
        gait.Stop();
        break;
      default:
        break;  // letting go takes half a second and is not interrupted
    }
  }

  // ---- one tick
  // -------------------------------------------------------------------------------------
  void Sense() {
    reading = &sensors->Read(tick, world->state());
    estimator.Update(*reading, parameters.control);
  }

  void LookAtTruth() {
    judge.Update(judge_sensors->Read(tick, world->state()), Unfiltered(parameters.control));
  }

  unsigned GraspFingers() const {
    unsigned bits = 0;
    for (int i = 0; i < hand.num_fingers(); ++i)
      if (tasks[i].mode != FingerMode::kPosture) bits |= 1u << i;
    return bits;
  }

  void WatchContacts() {
    for (int i = 0; i < hand.num_fingers(); ++i) {
      const FingerEstimate& f = estimator.estimate().fingers[i];
      const bool now = was_in_contact[i] ? f.ticks_without_contact < 20 : f.in_contact;
      if (now == was_in_contact[i]) continue;
      was_in_contact[i] = now;
      Emit(now ? EventKind::kContactMade : EventKind::kContactLost, i, 0, "%s: contact %s",
           hand.fingers[i].name.c_str(), now ? "made" : "lost");
    }
  }

  void WatchDrop() {
    const bool alone =
        state == SessionState::kHolding || state == SessionState::kExploring ||
        state == SessionState::kRotating ||
        (state == SessionState::kGrasping && grasp.phase() == GraspSequence::Phase::kAlone);
    if (!alone || release_tick >= 0) {
      drop_ticks = 0;
      return;
    }
    const Estimate& e = estimator.estimate();
    int touching = 0;
    for (const FingerEstimate& f : e.fingers) touching += f.in_contact;
    drop_ticks = touching < 2 ? drop_ticks + 1 : 0;
    const double distance = (e.p_WO - controller.wrench().p_ref()).norm();
    if (drop_ticks * dt < kDropContactTime_s && distance < parameters.control.drop_distance) return;
    if (state == SessionState::kExploring) {
      job.explore.reason = ExploreReason::kDropped;
      JudgeExplorationEnd();
    }
    if (state == SessionState::kRotating) job.rotate.dropped = true;
    exploration = FingerExploration();
    gait = FingerGait();
    Emit(EventKind::kDropped, -1, distance,
         "dropped: object %.0f mm from its place, %d fingers touch", distance * 1e3, touching);
    FinishJob(JobState::kFailed, "the object was dropped");
    ToPosture(e.q);  // the hand stops where it is
    Enter(SessionState::kDropped);
  }

  double TruePhi() {
    LookAtTruth();
    const auto& r = exploration.request();
    return Objective(r.criterion, r.finger, GraspFingers(), judge.estimate(), parameters.control,
                     parameters.exploration.stability_weight, exploration.on_stability())
        .phi;
  }

  void JudgeExplorationEnd() {
    job.explore.cycles = exploration.cycles();
    job.explore.phi_final = exploration.phi();
    job.explore.phi_true_final = TruePhi();
  }

  void UpdateExploration() {
    const bool was_on_stability = exploration.on_stability();
    exploration.Update(
        hand, estimator.estimate(), GraspFingers(), parameters.control, parameters.exploration,
        monitor.load_margin_without(exploration.request().finger), dt, &controller, &tasks);
    const int finger = exploration.request().finger;
    if (exploration.on_stability() != was_on_stability)
      Emit(EventKind::kCriterion, finger, exploration.on_stability(), "objective: %s",
           exploration.on_stability() ? "stability" : "manipulability");
    const FingerEstimate& truth = judge.estimate().fingers[finger];
    if (exploration.slide_began()) {
      job.explore.phi_initial = exploration.phi_initial();
      job.explore.phi_true_initial = TruePhi();
      p_path = truth.p_WC;
    }
    if (exploration.phase() == FingerExploration::Phase::kSlide && tick % kJudgeInterval == 0) {
      job.explore.path_length_m += (truth.p_WC - p_path).norm();
      p_path = truth.p_WC;
      const double limit =
          job.explore.cycles > 0 ? job.explore.cycles : parameters.exploration.max_cycles;
      job.progress = std::min(0.99, exploration.cycles() / limit);
    }
    if (exploration.slide_ended()) {
      JudgeExplorationEnd();
      job.explore.phi_final = exploration.phi_final();
      switch (exploration.end()) {
        case FingerExploration::End::kGradient:
          job.explore.reason = ExploreReason::kGradient;
          break;
        case FingerExploration::End::kMaxCycles:
          job.explore.reason = ExploreReason::kMaxCycles;
          break;
        case FingerExploration::End::kContactLost:
          job.explore.reason = ExploreReason::kContactLost;
          break;
        case FingerExploration::End::kNone:
          break;  // stopped: cancelled
      }
      job.explore.converged = job.explore.reason == ExploreReason::kGradient;
    }
    if (exploration.phase() != FingerExploration::Phase::kDone) return;
    exploration = FingerExploration();
    const ExploreReason reason = job.explore.reason;
    if (reason == ExploreReason::kCancelled) {
      FinishJob(JobState::kCancelled, "");
    } else if (reason == ExploreReason::kContactLost) {
      FinishJob(JobState::kFailed, "the exploring finger lost contact");
    } else {
      FinishJob(JobState::kDone, "");
    }
    Enter(SessionState::kHolding);
  }

  // ---- rotation
  // -------------------------------------------------------------------------------------
  void StartRotation(const Command& command) {
    FingerGait::Request request;
    request.angle_rad = command.angle_rad;
    request.continuous = command.continuous;
    request.axis_W = command.axis_W.normalized();
    request.speed_rad_s = command.speed_rad_s;
    request.seed = seed;
    gait.Start(request, hand, estimator.estimate(), controller.wrench(), GraspFingers());
    q_WO_start = world->state().q_WO;
    motion = ObjectMotion();
    Enter(SessionState::kRotating);
  }

  /// The truth about the rotation so far, every tick so that no turn is missed.
  void JudgeRotation() {
    RotateResult& r = job.rotate;
    const WorldState& truth = world->state();
    const Vector3d& axis = gait.request().axis_W;
    const Quaterniond q = truth.q_WO * q_WO_start.conjugate();
    const double twist = 2.0 * std::atan2(q.vec().dot(axis), q.w());
    r.angle_rad += std::remainder(twist - r.angle_rad, 2.0 * std::numbers::pi);
    r.turns = r.angle_rad / (2.0 * std::numbers::pi);
    r.max_tilt_rad = std::max(r.max_tilt_rad, std::acos(std::clamp(axis.dot(q * axis), -1.0, 1.0)));
    r.max_position_error_m =
        std::max(r.max_position_error_m, (truth.p_WO - controller.wrench().p_ref()).norm());
    r.gait_cycles = gait.cycles();
    r.regrasps = gait.regrasps();
    r.sim_time_s = static_cast<double>(tick - job.start_tick) * dt;
    if (!gait.request().continuous)
      job.progress = std::clamp(gait.turned() / gait.target(), 0.0, 0.99);
  }

  double TruePhiOf(int finger) {
    LookAtTruth();
    const Regrasp& r = gait.regrasp();
    if (r.request().criterion != Criterion::kStability && !r.on_stability())
      return judge.estimate().fingers[finger].manipulability;
    const unsigned all = GraspFingers();
    const unsigned fingers = r.request().without >= 0 ? all & ~(1u << r.request().without) : all;
    return GraspStability(judge.estimate(), fingers, parameters.control);
  }

  void ReportGait() {
    const FingerGait::Happened& happened = gait.happened();
    if (happened.refused_finger >= 0)
      Emit(EventKind::kRefused, happened.refused_finger, happened.refused_margin,
           "%s may not leave: load margin %.3f N without it",
           hand.fingers[happened.refused_finger].name.c_str(), happened.refused_margin);
    if (happened.aborted)
      Emit(EventKind::kSlip, gait.regrasp().request().finger, happened.error_position,
           "regrasp broken off: object %.1f mm, %.0f deg off", happened.error_position * 1e3,
           happened.error_rotation * 180.0 / std::numbers::pi);
    const int finger = gait.regrasp().request().finger;
    if (happened.explore_began) regrasp.phi_start = TruePhiOf(finger);
    if (happened.regrasp_ended) {
      regrasp.finger = finger;
      regrasp.criterion = gait.regrasp().request().criterion;
      regrasp.on_stability = gait.regrasp().on_stability();
      regrasp.aborted = gait.regrasp().aborted();
      regrasp.phi_after = TruePhiOf(finger);
      if (!gait.regrasp().request().explore) regrasp.phi_start = regrasp.phi_before;
      Emit(EventKind::kRegrasp, finger, regrasp.phi_after, "%s regrasped: %s %.4f -> %.4f",
           hand.fingers[finger].name.c_str(),
           regrasp.on_stability || regrasp.criterion == Criterion::kStability ? "stability"
                                                                              : "manipulability",
           regrasp.phi_before, regrasp.phi_after);
    }
    if (happened.regrasp_began) {
      regrasp = RegraspRecord();
      regrasp.phi_before = TruePhiOf(finger);
    }
    if (!happened.changed || gait.phase() == GaitPhase::kChoose) return;
    if (gait.phase() == GaitPhase::kRegrasp)
      Emit(EventKind::kGaitPhase, finger, static_cast<double>(gait.phase()), "%s: %s",
           hand.fingers[finger].name.c_str(), Name(gait.regrasp().phase()).data());
    else
      Emit(EventKind::kGaitPhase, -1, static_cast<double>(gait.phase()), "%s",
           Name(gait.phase()).data());
  }

  void UpdateRotation() {
    FingerGait::Margins margins;
    margins.all = monitor.stability().load_margin;
    for (int i = 0; i < hand.num_fingers(); ++i)
      margins.without[i] = monitor.load_margin_without(i);
    motion =
        gait.Update(hand, estimator.estimate(), margins, parameters.gravity_W, parameters.control,
                    parameters.exploration, parameters.gait, dt, &controller, &tasks);
    JudgeRotation();
    ReportGait();
    if (gait.active()) return;
    if (gait.phase() == GaitPhase::kFailed) {
      FinishJob(JobState::kFailed, gait.error());
    } else {
      FinishJob(gait.stopped() ? JobState::kCancelled : JobState::kDone, "");
    }
    Enter(SessionState::kHolding);
  }

  void UpdateGrasp() {
    grasp.Update(estimator.estimate(), q_closed, parameters.gravity_W, parameters.control,
                 &controller, &tasks);
    job.progress = std::min(0.99, grasp.progress());
    if (world->stand_in() != grasp.needs_stand_in()) {
      world->SetStandIn(grasp.needs_stand_in());
      Emit(EventKind::kStandIn, -1, world->stand_in(), "stand-in %s",
           world->stand_in() ? "holds the object" : "let go");
    }
    if (grasp.phase() == GraspSequence::Phase::kDone) {
      FinishJob(JobState::kDone, "");
      Enter(SessionState::kHolding);
    } else if (grasp.phase() == GraspSequence::Phase::kFailed) {
      FinishJob(JobState::kFailed, "fewer than three fingers touched the object");
      ToPosture(q_open);
      Enter(SessionState::kIdle);
    }
  }

  /// Opens the hand: a short pull away from the surface, then the open posture.
  void UpdateRelease() {
    const double time = (tick - release_tick) * dt;
    if (time == 0) ToPosture(q_open);
    job.progress = std::min(0.99, time / kReleaseTime_s);
    if (time < kReleaseTime_s) return;
    release_tick = -1;
    FinishJob(JobState::kDone, "");
    Enter(SessionState::kIdle);
  }

  void AddReleasePull() {
    if (release_tick < 0 || (tick - release_tick) * dt >= kReleasePullTime_s) return;
    for (int i = 0; i < hand.num_fingers(); ++i) {
      const FingerEstimate& f = estimator.estimate().fingers[i];
      if (!f.ever_in_contact) continue;
      const FingerVector tau = f.J.transpose() * (kReleasePull_n * f.normal_W);
      const auto& joints = hand.fingers[i].joints;
      for (std::size_t k = 0; k < joints.size(); ++k) torque[joints[k]] += tau[k];
    }
  }

  void Tick() {
    if (state == SessionState::kFaulted) {
      ++tick;
      return;
    }
    StageClock clock(measure);
    Sense();
    if (tick % kJudgeInterval == 0) LookAtTruth();
    times.sense_s = clock.Lap();

    monitor.Update(estimator.estimate(), GraspFingers(), parameters.gravity_W, parameters.control);
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

  // ---- outside
  // --------------------------------------------------------------------------------------
  FingerRole RoleOf(int finger) const {
    switch (tasks[finger].mode) {
      case FingerMode::kHold:
      case FingerMode::kTouch:
        return FingerRole::kHold;
      case FingerMode::kSlide:
        return state == SessionState::kExploring ||
                       gait.regrasp().phase() == Regrasp::Phase::kExplore
                   ? FingerRole::kExplore
                   : FingerRole::kMove;
      case FingerMode::kReach:
        return FingerRole::kMove;
      case FingerMode::kPosture:
        return FingerRole::kFree;
    }
    return FingerRole::kFree;
  }

  void Snapshot(Frame* frame) const {
    Frame& f = *frame;
    f.tick = tick;
    f.time_s = static_cast<double>(tick) * dt;
    f.state_hash = 0;
    f.state = state;
    f.seed = seed;
    f.noise = noise;
    f.stand_in = world->stand_in();
    f.num_fingers = hand.num_fingers();
    const WorldState& truth = world->state();
    const Estimate& e = estimator.estimate();
    f.q_sensed = e.q;
    f.q = truth.q;
    f.qdot = truth.qdot;
    f.torque = truth.torque;
    f.p_WO_sensed = e.p_WO;
    f.q_WO_sensed = e.q_WO;
    f.p_WO = truth.p_WO;
    f.q_WO = truth.q_WO;
    f.v_WO = truth.v_WO;
    f.w_WO = truth.w_WO;
    f.p_WO_reference = controller.wrench().p_ref();
    f.mass_kg = world->mass_kg();
    f.friction = world->friction();
    f.gravity_W = world->gravity_W();
    f.stability = monitor.stability();
    f.contacts.clear();
    for (const ObjectContact& c : truth.contacts)
      f.contacts.push_back({c.link, c.finger, c.p_WC, c.normal_W, c.force_W, c.depth});
    KinematicsData true_kinematics;
    ForwardKinematics(hand, truth.q, &true_kinematics);
    f.fingers.resize(hand.fingers.size());
    for (int i = 0; i < hand.num_fingers(); ++i) {
      FingerFrame& ff = f.fingers[i];
      const FingerEstimate& fe = e.fingers[i];
      ff = FingerFrame();
      ff.role = RoleOf(i);
      ff.in_contact = fe.in_contact;
      ff.p_WC = fe.p_WC;
      ff.normal_W = fe.normal_W;
      ff.force = fe.force;
      ff.f_command_W = controller.commanded_forces()[i];
      ff.manipulability = fe.manipulability;
      ff.load_margin_without = monitor.load_margin_without(i);
      ff.joint_limit_margin = 1e9;
      for (int j : hand.fingers[i].joints)
        ff.joint_limit_margin = std::min({ff.joint_limit_margin, truth.q[j] - hand.joints[j].lower,
                                          hand.joints[j].upper - truth.q[j]});
      ff.true_tip_W = FingertipCentre(hand, true_kinematics, i);
      double weight = 0;
      Vector3d p = Vector3d::Zero(), n = Vector3d::Zero();
      for (const ObjectContact& c : truth.contacts) {
        if (c.finger != i) continue;
        const double w = c.force_W.norm() + 1e-9;
        p += w * c.p_WC;
        n += w * c.normal_W;
        weight += w;
        ff.true_force_W += c.force_W;
      }
      ff.true_contact = weight > 0;
      if (!ff.true_contact) continue;
      ff.true_p_WC = p / weight;
      ff.true_normal_W = n.normalized();
      ff.true_manipulability =
          Manipulability(PointJacobian(hand, true_kinematics, i, ff.true_p_WC)) /
          kManipulabilityUnit;
    }
    f.exploration = ExplorationFrame();
    const auto phase = exploration.phase();
    if (phase != FingerExploration::Phase::kIdle && phase != FingerExploration::Phase::kDone) {
      ExplorationFrame& x = f.exploration;
      x.active = true;
      x.finger = exploration.request().finger;
      x.criterion = exploration.request().criterion;
      x.on_stability = exploration.on_stability();
      x.cycle = exploration.cycles();
      x.phi = exploration.phi();
      x.gradient_norm = exploration.algorithm().gradient_norm();
      x.epsilon = parameters.exploration.epsilon;
      x.gradient_W = exploration.algorithm().gradient_W();
      x.velocity_W = exploration.algorithm().velocity_W();
    }
    if (state == SessionState::kRotating && gait.regrasp().phase() == Regrasp::Phase::kExplore) {
      ExplorationFrame& x = f.exploration;
      x.active = true;
      x.finger = gait.regrasp().request().finger;
      x.criterion = gait.regrasp().request().criterion;
      x.on_stability = gait.regrasp().on_stability();
      x.cycle = gait.regrasp().algorithm().cycle();
      x.phi = gait.regrasp().phi();
      x.gradient_norm = gait.regrasp().algorithm().gradient_norm();
      x.epsilon = parameters.exploration.epsilon;
      x.gradient_W = gait.regrasp().algorithm().gradient_W();
    }
    f.gait = GaitFrame();
    if (state == SessionState::kRotating) {
      f.gait.active = true;
      f.gait.phase = static_cast<int>(gait.phase());
      f.gait.finger = gait.finger();
      f.gait.target_angle_rad = gait.turned();
      f.gait.achieved_angle_rad = job.rotate.angle_rad;
      f.gait.cycles = gait.cycles();
      f.gait.regrasps = gait.regrasps();
    }
    f.job = job;
  }

  std::uint64_t Hash() const {
    StateHasher hasher;
    hasher.Add(tick);
    hasher.Add(seed);
    hasher.Add(state);
    world->AddTo(&hasher);
    sensors->AddTo(&hasher);
    estimator.AddTo(&hasher);
    controller.AddTo(&hasher);
    grasp.AddTo(&hasher);
    exploration.AddTo(&hasher);
    gait.AddTo(&hasher);
    monitor.AddTo(&hasher);
    hasher.Add(push_until);
    hasher.Add(release_tick);
    hasher.Add(drop_ticks);
    // Numbers that act later than the tick in which they were given.
    hasher.Add(exploration.request().estimator);
    hasher.Add(exploration.request().seed);
    hasher.Add(exploration.request().max_cycles);
    Parameters given = parameters;
    for (const ParameterInfo& info : ParameterTable())
      for (int k = 0; k < info.size; ++k) hasher.Add(info.access(given)[k]);
    return hasher.Digest();
  }

  SessionConfig config;
  const HandModel& hand;
  double dt;
  Parameters parameters;
  NoiseLevels noise;
  std::uint64_t seed = 0;
  std::shared_ptr<const ObjectModel> object;
  std::unique_ptr<World> world;
  std::unique_ptr<Sensors> sensors, judge_sensors;
  const SensorReading* reading = nullptr;
  StateEstimator estimator;  // what the controller believes
  StateEstimator judge;      // the same from noise-free readings, never seen by the controller
  HybridController controller;
  GraspSequence grasp;
  FingerExploration exploration;
  FingerGait gait;
  ObjectMotion motion;
  RegraspRecord regrasp;  // the last one
  Quaterniond q_WO_start = Quaterniond::Identity();
  QualityMonitor monitor;
  FingerTasks tasks;
  JointVector q_open, q_closed, torque;
  std::int64_t tick = 0, push_until = -1, release_tick = -1;
  int drop_ticks = 0;
  SessionState state = SessionState::kIdle;
  char refusal_text[128] = {};
  JobRecord job;
  Vector3d p_path = Vector3d::Zero();
  std::array<bool, kMaxFingers> was_in_contact{};
  FixedVector<Event, kMaxPending> events, events_out;
  FixedVector<JobRecord, kMaxPending> finished, finished_out;
  bool measure = false;
  StageTimes times;
};

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
const World& Session::world() const { return *impl_->world; }

}  // namespace regrasp
