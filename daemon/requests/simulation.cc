// Commands that change the simulation.

#include <fmt/format.h>

#include <algorithm>

#include "core/sensing/noise.h"
#include "core/sensing/sensors.h"
#include "daemon/requests/handlers.h"
#include "daemon/wire/frame_json.h"

namespace regrasp::handlers {
namespace {

constexpr std::int64_t kMostStepTicks = 1'000'000'000;

Command Of(CommandType type) {
  Command command;
  command.type = type;
  return command;
}

Outcome ClockAnswer(Service& service, std::uint64_t barrier) {
  return {.barrier = barrier, .later = [&service] {
            return Json{{"paused", service.newest().paused},
                        {"tick", service.newest().frame.tick},
                        {"clock", ClockName(service.clock())}};
          }};
}

}  // namespace

Outcome Stop(Service& service, const Params&, Client&) {
  service.CheckAllowed(CommandType::kStop);
  const JobRecord* job = service.jobs().Unfinished();
  const JobRecord* step = service.jobs().UnfinishedStep();
  const std::int64_t id = job ? job->id : 0;
  Json result = {{"job", job ? Json(id) : Json()}, {"step", step ? Json(step->id) : Json()}};
  std::uint64_t barrier = 0;
  if (job || !step) barrier = service.PostCommand(Of(CommandType::kStop));
  if (step) barrier = service.Post({.kind = ControlRequest::Kind::kCancelStep, .job = step->id});
  return {.barrier = barrier, .later = [&service, id, result = std::move(result)]() mutable {
            const JobRecord* now = service.jobs().Find(id);
            result["begun"] = now ? Json(now->start_tick >= 0 || !Ended(now->state)) : Json();
            return result;
          }};
}

Outcome Pause(Service& service, const Params&, Client&) {
  const std::uint64_t barrier = service.Post({.kind = ControlRequest::Kind::kPause});
  service.Accept().paused = true;
  return ClockAnswer(service, barrier);
}

Outcome Resume(Service& service, const Params&, Client&) {
  service.CheckNotFaulted();
  const std::uint64_t barrier = service.Post({.kind = ControlRequest::Kind::kResume});
  service.Accept().paused = false;
  return ClockAnswer(service, barrier);
}

Outcome Step(Service& service, const Params& params, Client&) {
  service.CheckNotRestoring();
  service.CheckNotFaulted();
  const JobRecord* job = service.jobs().Unfinished();
  const bool until_job_ends = params.Bool("until_job_ends", false);
  if (!service.accepted().paused && service.clock() == ClockMode::kContinuous)
    throw RpcException(ErrorCode::kBadState, "the simulation is not paused", "regrasp pause");
  if (!service.accepted().paused && job)
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
  service.Accept().seed = seed;
  Parameters& parameters = service.Accept().parameters;
  parameters = ParametersAfterReset(parameters, object.get());
  service.AcceptObject(object ? object : service.accepted().object);
  return barrier;
}

Json ResetAnswer(const Service& service) {
  return {{"seed", service.accepted().seed},
          {"object", service.accepted().object->name},
          {"changed_parameters", service.ChangedParameters()},
          {"warnings", service.accepted().warnings}};
}

/// The file is read by the worker thread: a mesh may take seconds.
void LoadAndReset(Service& service, std::uint64_t seed, const std::string& name, const Done& done) {
  struct Loaded {
    std::shared_ptr<const ObjectModel> object;
    RpcError error;
  };
  const auto loaded = std::make_shared<Loaded>();
  const auto load = [loaded, name, config = service.config(), text = service.model_text()] {
    try {
      LoadedScenario model = config.control.session.model;
      model.object = LoadObject(name, config.search_path, config.load);
      text->Of(model);
      loaded->object = std::make_shared<const ObjectModel>(std::move(model.object));
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
          ControlRequest::Part::kNothing,
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
      params.Integer("seed", static_cast<std::int64_t>(service.accepted().seed)));
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
  return {.result = NoiseJson(service.accepted().noise)};
}

Outcome NoiseSet(Service& service, const Params& params, Client&) {
  service.CheckAllowed(CommandType::kNoise);
  NoiseLevels levels = service.accepted().noise;
  if (params.Has("preset")) levels = *NoisePreset(params.String("preset"));
  constexpr std::pair<const char*, double NoiseLevels::*> kLevels[] = {
      {"position_m", &NoiseLevels::position_m},
      {"normal_rad", &NoiseLevels::normal_rad},
      {"force_n", &NoiseLevels::force_n},
      {"joint_rad", &NoiseLevels::joint_rad},
      {"object_position_m", &NoiseLevels::object_position_m},
      {"object_rotation_rad", &NoiseLevels::object_rotation_rad},
      {"taxel_pitch_m", &NoiseLevels::taxel_pitch_m},
      {"object_rate_hz", &NoiseLevels::object_rate_hz},
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
  levels.object_delay_frames =
      static_cast<int>(params.Integer("object_delay_frames", levels.object_delay_frames));
  if (params.Integer("object_delay_frames", 0) > 0 && levels.object_rate_hz == 0)
    throw RpcException(RpcError{ErrorCode::kInvalidParams,
                                "object_delay_frames delays poses that come at a rate, and "
                                "object_rate_hz is 0",
                                "give object_rate_hz, too",
                                "object_delay_frames",
                                {}});
  if (levels.object_rate_hz == 0) levels.object_delay_frames = 0;  // it delays nothing
  const double sample_s = SampleTime(service.dt());
  if (const double gap = params.Number("dropout_gap_s", 0); gap > 0 && gap < sample_s)
    throw RpcException(
        RpcError{ErrorCode::kInvalidParams,
                 fmt::format("dropout_gap_s = {:g} is shorter than a sample", gap),
                 fmt::format("allowed are {:g} s to 1 s, and 0, which is a sample", sample_s),
                 "dropout_gap_s",
                 {}});
  Command command = Of(CommandType::kNoise);
  command.noise = levels;
  const std::uint64_t barrier = service.PostCommand(std::move(command));
  service.Accept().noise = levels;
  return {.result = NoiseJson(levels), .barrier = barrier};
}

}  // namespace regrasp::handlers
