// Commands that change the simulation.

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <span>

#include "core/sensing/noise.h"
#include "daemon/requests/handlers.h"
#include "daemon/wire/frame_json.h"

namespace regrasp::handlers {
namespace {

constexpr double kLeastAxis = 1e-9;  // shorter than this, an axis has no direction
constexpr std::int64_t kMostStepTicks = 1'000'000'000;
constexpr double kLeastMove = 1e-9;  // shorter than this, an offset [m] or rotation [rad] is none

/// Checks, makes a job and queues the command that works on it.
Outcome StartJob(Service& service, JobMethod method, Command command) {
  service.CheckAllowed(command.type);
  service.CheckMeasure(service.accepted.parameters, method, command.criterion);
  JobRecord& job = service.jobs().Add(method);
  const std::int64_t id = job.id;
  job.explore.finger = command.finger;
  job.explore.criterion = command.criterion;
  job.explore.estimator = command.estimator;
  job.explore.seed = command.seed;
  job.move.offset_m = command.offset_W;
  job.move.rotation_rad = command.rotation_W;
  command.job = id;
  try {
    const std::uint64_t barrier = service.PostCommand(std::move(command));
    return {.result = {{"job", id}}, .barrier = barrier};
  } catch (...) {
    service.jobs().Withdraw(id);
    throw;
  }
}

Command Of(CommandType type) {
  Command command;
  command.type = type;
  return command;
}

/// The entry of an enumeration whose name is `word`, one of `names`.
template <typename E>
E EnumNamed(std::string_view word, std::span<const std::string_view> names) {
  return static_cast<E>(std::ranges::find(names, word) - names.begin());
}

Outcome ClockAnswer(Service& service, std::uint64_t barrier) {
  return {.barrier = barrier, .later = [&service] {
            return Json{{"paused", service.newest().paused}, {"tick", service.newest().frame.tick}};
          }};
}

}  // namespace

Outcome Grasp(Service& service, const Params&, Client&) {
  return StartJob(service, JobMethod::kGrasp, Of(CommandType::kGrasp));
}

Outcome Release(Service& service, const Params&, Client&) {
  return StartJob(service, JobMethod::kRelease, Of(CommandType::kRelease));
}

Outcome Explore(Service& service, const Params& params, Client&) {
  Command command = Of(CommandType::kExplore);
  command.finger = service.hand().FindFinger(params.String("finger"));
  command.criterion =
      EnumNamed<Criterion>(params.String("criterion", "manipulability"), kCriterionNames);
  command.estimator =
      EnumNamed<Estimator>(params.String("estimator", "least_squares"), kEstimatorNames);
  command.seed = static_cast<std::uint64_t>(
      params.Integer("seed", static_cast<std::int64_t>(service.accepted.seed)));
  command.max_cycles = static_cast<int>(params.Integer("max_cycles", 0));
  return StartJob(service, JobMethod::kExplore, std::move(command));
}

Outcome Rotate(Service& service, const Params& params, Client&) {
  const bool continuous = params.Bool("continuous", false);
  const int given = params.Has("angle_rad") + params.Has("turns") + continuous;
  if (given != 1)
    throw RpcException(
        RpcError{ErrorCode::kInvalidParams,
                 fmt::format("rotate takes one of angle_rad, turns and continuous, not {}", given),
                 "regrasp rotate --angle 90 --wait",
                 "angle_rad",
                 {}});
  Command command = Of(CommandType::kRotate);
  command.continuous = continuous;
  command.angle_rad = params.Number("angle_rad", 2 * std::numbers::pi * params.Number("turns", 0));
  if (!continuous && command.angle_rad == 0)
    throw RpcException(RpcError{ErrorCode::kInvalidParams,
                                "an angle of 0 leaves nothing to turn",
                                "regrasp rotate --angle 90 --wait",
                                params.Has("turns") ? "turns" : "angle_rad",
                                {}});
  command.axis_W = params.Vector("axis", command.axis_W);
  const double length = command.axis_W.norm();
  if (length < kLeastAxis)
    throw RpcException(RpcError{ErrorCode::kInvalidParams,
                                "the axis has no direction: its length is 0",
                                "regrasp rotate --angle 90 --axis 0,0,1",
                                "axis",
                                {}});
  command.axis_W /= length;
  command.speed_rad_s = params.Number("speed_rad_s", 0);
  return StartJob(service, JobMethod::kRotate, std::move(command));
}

Outcome Move(Service& service, const Params& params, Client&) {
  Command command = Of(CommandType::kMove);
  command.offset_W = params.Vector("offset_m");
  command.rotation_W = params.Vector("rotation_rad");
  for (Vector3d* vector : {&command.offset_W, &command.rotation_W})
    if (vector->norm() < kLeastMove) vector->setZero();
  if (command.offset_W.isZero(0) && command.rotation_W.isZero(0))
    throw RpcException(RpcError{ErrorCode::kInvalidParams,
                                "an offset and a rotation of 0 leave nothing to move",
                                "regrasp move --by 0,0,5 --wait",
                                "offset_m",
                                {}});
  const auto check = [](const char* name, double length, double most, const char* unit) {
    // What is written in decimals may be longer by its rounding.
    if (length <= most * (1 + 1e-9)) return;
    throw RpcException(
        RpcError{ErrorCode::kInvalidParams,
                 fmt::format("{} of length {:.6g} {} is too long", name, length, unit),
                 fmt::format("allowed: at most {:.6g} {}", most, unit),
                 name,
                 {}});
  };
  check("offset_m", command.offset_W.norm(), kMaxMoveOffset, "m");
  check("rotation_rad", command.rotation_W.norm(), std::numbers::pi, "rad");
  return StartJob(service, JobMethod::kMove, std::move(command));
}

Outcome Stop(Service& service, const Params&, Client&) {
  service.CheckAllowed(CommandType::kStop);
  const JobRecord* job = service.jobs().Unfinished();
  const Json id = job ? Json(job->id) : Json();
  return {.result = {{"job", id}}, .barrier = service.PostCommand(Of(CommandType::kStop))};
}

Outcome Pause(Service& service, const Params&, Client&) {
  const std::uint64_t barrier = service.Post({.kind = ControlRequest::Kind::kPause});
  service.accepted.paused = true;
  return ClockAnswer(service, barrier);
}

Outcome Resume(Service& service, const Params&, Client&) {
  service.CheckNotFaulted();
  const std::uint64_t barrier = service.Post({.kind = ControlRequest::Kind::kResume});
  service.accepted.paused = false;
  return ClockAnswer(service, barrier);
}

Outcome Step(Service& service, const Params& params, Client&) {
  service.CheckNotRestoring();
  service.CheckNotFaulted();
  const JobRecord* job = service.jobs().Unfinished();
  const bool until_job_ends = params.Bool("until_job_ends", false);
  if (!service.accepted.paused && service.clock() == ClockMode::kContinuous)
    throw RpcException(ErrorCode::kBadState, "the simulation is not paused", "regrasp pause");
  if (!service.accepted.paused && job)
    throw RpcException(ErrorCode::kBusy,
                       fmt::format("time advances by itself: job {} is running", job->id),
                       fmt::format("regrasp job wait {}", job->id));
  if (until_job_ends && !job)
    throw RpcException(ErrorCode::kBadState, "no job is running that could end",
                       "regrasp grasp, then regrasp step --until-job-ends --wait");
  if (const JobRecord* step = service.jobs().UnfinishedStep())
    throw RpcException(ErrorCode::kBusy, fmt::format("another step is running (job {})", step->id),
                       fmt::format("regrasp job wait {}", step->id));
  const std::int64_t id = service.jobs().Add(JobMethod::kStep).id;
  try {
    const std::uint64_t barrier =
        service.Post({.kind = ControlRequest::Kind::kStep,
                      .job = id,
                      .ticks = params.Integer("ticks", until_job_ends ? kMostStepTicks : 1),
                      .until_job_ends = until_job_ends});
    return {.result = {{"job", id}}, .barrier = barrier};
  } catch (...) {
    service.jobs().Withdraw(id);
    throw;
  }
}

namespace {

/// Posts a reset, with another object unless that is null; what is accepted from now on is of the
/// new run.
std::uint64_t PostReset(Service& service, std::uint64_t seed,
                        const std::shared_ptr<const ObjectModel>& object) {
  ControlRequest request;
  request.kind = ControlRequest::Kind::kReset;
  request.seed = seed;
  request.object = object;
  const std::uint64_t barrier = service.Post(std::move(request));
  Service::Accepted& accepted = service.accepted;
  accepted.seed = seed;
  accepted.parameters = ParametersAfterReset(accepted.parameters, object.get());
  if (object) service.AcceptObject(object);
  return barrier;
}

Json ResetAnswer(const Service& service) {
  return {{"seed", service.accepted.seed},
          {"object", service.accepted.object->name},
          {"changed_parameters", service.ChangedParameters()},
          {"warnings", service.accepted.warnings}};
}

/// The file is read by the worker thread: a mesh may take seconds.
void LoadAndReset(Service& service, std::uint64_t seed, const std::string& name, const Done& done) {
  struct Loaded {
    std::shared_ptr<const ObjectModel> object;
    RpcError error;
  };
  const auto loaded = std::make_shared<Loaded>();
  const auto load = [loaded, name, config = service.config()] {
    try {
      loaded->object =
          std::make_shared<const ObjectModel>(LoadObject(name, config.search_path, config.load));
    } catch (const std::exception& e) {
      loaded->error = {ErrorCode::kIo, e.what(), "correct the model", "object", {}};
    }
  };
  const auto reset = [&service, loaded, seed, done] {
    if (!loaded->object) return done({}, &loaded->error);
    try {
      service.CheckNotRestoring();
      PostReset(service, seed, loaded->object);
      // Answered when the reset has been taken and what follows it is known.
      service.Mark(
          [done, answer = ResetAnswer(service)](const JournalNews&) { done(answer, nullptr); });
    } catch (const RpcException& e) {
      done({}, &e.error());
    }
  };
  if (service.host().Background(load, reset)) return;
  const RpcError error{
      ErrorCode::kBusy, "too many files are being read", "try again later", {}, {}};
  done({}, &error);
}

}  // namespace

Outcome Reset(Service& service, const Params& params, Client&) {
  service.CheckNotRestoring();
  const auto seed = static_cast<std::uint64_t>(
      params.Integer("seed", static_cast<std::int64_t>(service.accepted.seed)));
  Outcome outcome;
  if (params.Has("object")) {
    outcome.begin = [&service, seed, name = params.String("object")](Done done) {
      LoadAndReset(service, seed, name, done);
    };
    return outcome;
  }
  outcome.barrier = PostReset(service, seed, nullptr);
  outcome.result = ResetAnswer(service);
  return outcome;
}

Outcome Push(Service& service, const Params& params, Client&) {
  service.CheckAllowed(CommandType::kPush);
  Command command = Of(CommandType::kPush);
  command.force_W = params.Vector("force_n");
  command.duration_s = params.Number("duration_s", 0.1);
  const Vector3d& f = command.force_W;
  Json result = {{"force_n", {f.x(), f.y(), f.z()}}, {"duration_s", command.duration_s}};
  return {.result = std::move(result), .barrier = service.PostCommand(std::move(command))};
}

Outcome NoiseGet(Service& service, const Params&, Client&) {
  return {.result = NoiseJson(service.accepted.noise)};
}

Outcome NoiseSet(Service& service, const Params& params, Client&) {
  service.CheckAllowed(CommandType::kNoise);
  NoiseLevels levels = service.accepted.noise;
  if (params.Has("preset")) levels = *NoisePreset(params.String("preset"));
  constexpr std::pair<const char*, double NoiseLevels::*> kLevels[] = {
      {"position_m", &NoiseLevels::position_m},
      {"normal_rad", &NoiseLevels::normal_rad},
      {"force_n", &NoiseLevels::force_n},
      {"joint_rad", &NoiseLevels::joint_rad},
      {"object_position_m", &NoiseLevels::object_position_m},
      {"object_rotation_rad", &NoiseLevels::object_rotation_rad},
      {"position_bias_m", &NoiseLevels::position_bias_m},
      {"force_bias_n", &NoiseLevels::force_bias_n},
      {"joint_bias_rad", &NoiseLevels::joint_bias_rad},
      {"object_bias_m", &NoiseLevels::object_bias_m},
      {"position_drift_m", &NoiseLevels::position_drift_m},
      {"force_drift_n", &NoiseLevels::force_drift_n},
      {"object_drift_m", &NoiseLevels::object_drift_m},
      {"dropout_fraction", &NoiseLevels::dropout},
      {"dropout_gap_s", &NoiseLevels::dropout_gap_s},
      {"latency_s", &NoiseLevels::latency_s}};
  for (const auto& [name, level] : kLevels) levels.*level = params.Number(name, levels.*level);
  Command command = Of(CommandType::kNoise);
  command.noise = levels;
  const std::uint64_t barrier = service.PostCommand(std::move(command));
  service.accepted.noise = levels;
  return {.result = NoiseJson(levels), .barrier = barrier};
}

}  // namespace regrasp::handlers
