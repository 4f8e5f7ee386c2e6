// The commands that start a job, one per row of the table of jobs.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <span>
#include <utility>

#include "core/session/few_fingers.h"
#include "daemon/requests/handlers.h"

namespace regrasp {
namespace {

constexpr double kLeastAxis = 1e-9;  // shorter than this, an axis has no direction
constexpr double kLeastMove = 1e-9;  // shorter than this, an offset [m] or rotation [rad] is none

RpcException Refusal(std::string message, std::string hint, std::string param) {
  return RpcException(RpcError{
      ErrorCode::kInvalidParams, std::move(message), std::move(hint), std::move(param), {}});
}

/// The entry of an enumeration whose name is `word`, one of `names`.
template <typename E>
E EnumNamed(std::string_view word, std::span<const std::string_view> names) {
  return static_cast<E>(std::ranges::find(names, word) - names.begin());
}

void ReadExplore(const Service& service, const Params& params, Command* command) {
  command->finger = service.hand().FindFinger(params.String("finger"));
  command->criterion =
      EnumNamed<Criterion>(params.String("criterion", "manipulability"), kCriterionNames);
  command->estimator = EnumNamed<Estimator>(
      params.String("estimator", std::string(Name(kDefaultEstimator))), kEstimatorNames);
  command->seed = static_cast<std::uint64_t>(
      params.Integer("seed", static_cast<std::int64_t>(service.accepted().seed)));
  command->max_cycles = static_cast<int>(params.Integer("max_cycles", 0));
}

void ReadRotate(const Params& params, Command* command) {
  constexpr const char* kHint = "regrasp rotate --angle 90 --wait";
  const bool continuous = params.Bool("continuous", false);
  const int given = params.Has("angle_rad") + params.Has("turns") + continuous;
  if (given != 1)
    throw Refusal(fmt::format("rotate takes one of angle_rad, turns and continuous, not {}", given),
                  kHint, "angle_rad");
  command->continuous = continuous;
  command->angle_rad = params.Number("angle_rad", 2 * std::numbers::pi * params.Number("turns", 0));
  if (!continuous && command->angle_rad == 0)
    throw Refusal("an angle of 0 leaves nothing to turn", kHint,
                  params.Has("turns") ? "turns" : "angle_rad");
  command->axis_W = params.Vector("axis", command->axis_W);
  const double length = command->axis_W.norm();
  if (length < kLeastAxis)
    throw Refusal("the axis has no direction: its length is 0",
                  "regrasp rotate --angle 90 --axis 0,0,1", "axis");
  command->axis_W /= length;
  command->speed_rad_s = params.Number("speed_rad_s", 0);
}

void ReadMove(const Params& params, Command* command) {
  command->offset_W = params.Vector("offset_m");
  command->rotation_W = params.Vector("rotation_rad");
  for (Vector3d* vector : {&command->offset_W, &command->rotation_W})
    if (vector->norm() < kLeastMove) vector->setZero();
  if (command->offset_W.isZero(0) && command->rotation_W.isZero(0))
    throw Refusal("an offset and a rotation of 0 leave nothing to move",
                  "regrasp move --by 0,0,5 --wait", "offset_m");
  const auto check = [](const char* name, double length, double most, const char* unit) {
    // What is written in decimals may be longer by its rounding.
    if (length <= most * (1 + 1e-9)) return;
    throw Refusal(fmt::format("{} of length {:.6g} {} is too long", name, length, unit),
                  fmt::format("allowed: at most {:.6g} {}", most, unit), name);
  };
  check("offset_m", command->offset_W.norm(), kMaxMoveOffset, "m");
  check("rotation_rad", command->rotation_W.norm(), std::numbers::pi, "rad");
}

/// What the request asks of a job; nothing of one that takes no parameters.
Command ReadRequest(const Service& service, const JobInfo& row, const Params& params) {
  Command command;
  command.type = row.command;
  if (row.id == JobMethod::kExplore) ReadExplore(service, params, &command);
  if (row.id == JobMethod::kRotate) ReadRotate(params, &command);
  if (row.id == JobMethod::kMove) ReadMove(params, &command);
  return command;
}

/// Checks, makes a job and queues the command that works on it.
template <std::size_t row>
Outcome Start(Service& service, const Params& params, Client&) {
  Command command = ReadRequest(service, kJobTable[row], params);
  service.CheckAllowed(command.type);
  service.CheckMeasure(service.accepted().parameters, kJobTable[row].id, command.criterion);
  const Verdict enough = CheckFingers(service.hand(), service.accepted().parameters, command);
  if (enough.kind != Verdict::Kind::kAllowed)
    throw RpcException(ErrorCode::kBadState, enough.reason, enough.hint);
  JobRecord& job = service.jobs().Add(kJobTable[row].id);
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

template <std::size_t... row>
constexpr std::array<Handler, sizeof...(row)> Starters(std::index_sequence<row...>) {
  return {Start<row>...};
}
constexpr auto kStarters = Starters(std::make_index_sequence<kJobTable.size()>());

}  // namespace

Handler FindJobHandler(std::string_view method) {
  const JobInfo* row = FindJob(&JobInfo::name, method);
  return row ? kStarters[static_cast<std::size_t>(row->id)] : nullptr;
}

}  // namespace regrasp
