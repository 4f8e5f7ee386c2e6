#include "cli/experiment/trial.h"

#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "cli/client/errors.h"
#include "cli/experiment/gait_events.h"
#include "cli/experiment/phi_map.h"
#include "cli/experiment/prediction.h"
#include "cli/print/print.h"
#include "core/common/random.h"

namespace regrasp::cli {
namespace {

constexpr std::int64_t kExploreLimit = 60000, kPhiLook = 10;  // [ticks]
constexpr int kPhiLooks = 30;                                 // 0.3 s
constexpr std::int64_t kRotateChunk = 1000, kLookChunk = 100;
constexpr std::int64_t kLongestWatched = 300000;  // of a turn that is looked at
constexpr std::int64_t kRotateLimitPerTurn = 1000000, kRotateLimit = 30000;
constexpr std::int64_t kHoldTicks = 1000;
constexpr double kPush_s = 0.1;
constexpr std::uint64_t kPushStream = 3000;  // as in bench/trial.h

/// How a trial ended, in one word. `record`: of the job that was tried.
std::string Outcome(const Json& record, const std::string& state) {
  if (state == "faulted") return "fault";
  if (state == "dropped" || At(record, "dropped") == true) return "dropped";
  const std::string job = Plain(At(record, "state"));
  if (job == "done") return "done";
  if (job != "failed") return "unfinished";
  if (At(record, "reason") == "contact_lost") return "contact_lost";
  const bool began = At(record, "start_tick").is_number() &&
                     At(record, "end_tick").get<std::int64_t>() > At(record, "start_tick");
  return began ? "failed" : "refused";
}

double Distance(const Json& a, const Json& b) {
  return std::hypot(a.at(0).get<double>() - b.at(0).get<double>(),
                    a.at(1).get<double>() - b.at(1).get<double>(),
                    a.at(2).get<double>() - b.at(2).get<double>());
}

Json ObjectPlace(SteppedDaemon* daemon) { return daemon->Call("truth").at("object").at("p_WO_m"); }

/// When phi has first been enough on average over 0.3 s, about a turn of the dither that swings it.
class NearBest {
 public:
  void Look(double phi, double enough) {
    looks_.push_back(phi);
    sum_ += phi;
    if (looks_.size() > kPhiLooks) sum_ -= looks_[looks_.size() - kPhiLooks - 1];
    reached_ = looks_.size() >= kPhiLooks && sum_ >= kPhiLooks * enough;
  }
  bool reached() const { return reached_; }
  double time_s() const { return 1e-3 * kPhiLook * static_cast<double>(looks_.size()); }

 private:
  std::vector<double> looks_;
  double sum_ = 0;
  bool reached_ = false;
};

/// Columns at the end of every row: what names the state reached, and how to get there again.
void AddEnd(SteppedDaemon* daemon, const Plan& plan, const Unit& unit, const std::string& estimator,
            const Json& record, Json* row) {
  (*row)["start_tick"] = At(record, "start_tick");
  (*row)["end_tick"] = At(record, "end_tick");
  (*row)["state_hash"] = daemon->Call("status").at("state_hash");
  (*row)["command"] = plan.Command(unit, estimator);
}

/// The column that comes first where cases are compared.
Json Head(const Plan& plan, const Unit& unit) {
  if (plan.cases.empty()) return Json::object();
  return {{"case", plan.cases.at(unit.which).name}};
}

/// The columns that follow: on what, and how it ends where the object never was in the hand.
Json Begun(const Unit& unit, const Json& status, const Json& grasp) {
  return {{"noise", unit.noise},
          {"object", At(status, "object")},
          {"seed", unit.seed},
          {"outcome", Plain(At(status, "state")) == "faulted" ? "fault" : "not_grasped"},
          {"error", At(grasp, "error")}};
}

Json Explore(SteppedDaemon* daemon, const Plan& plan, const Unit& unit,
             const std::string& estimator, const std::optional<PhiMap>& map) {
  daemon->LeaveFault();
  daemon->Call("noise.set", {{"preset", unit.noise}});
  const Json grasp = daemon->Grasp(unit.seed);
  Json status = daemon->Call("status");
  Json row = Head(plan, unit);
  row.update({{"finger", unit.subject},
              {"criterion", plan.CriterionOf(unit.which)},
              {"estimator", estimator}});
  row.update(Begun(unit, status, grasp));
  Json record, moved, near_best_s;
  const std::string truth_name = TruthNameOf(plan.CriterionOf(unit.which));
  const bool timed = map && map->rays > 0 && !truth_name.empty();
  if (Done(grasp)) {
    const Json before = ObjectPlace(daemon);
    NearBest near;
    record = daemon->Run("explore",
                         {{"finger", unit.subject},
                          {"criterion", plan.CriterionOf(unit.which)},
                          {"estimator", estimator},
                          {"seed", unit.seed}},
                         timed ? kPhiLook : kExploreLimit, kExploreLimit, [&] {
                           if (!timed || near.reached()) return;
                           const Json truth = daemon->Call("truth").at("fingers").at(unit.subject);
                           const Json& phi = truth.at(truth_name);  // null: no contact
                           near.Look(phi.is_number() ? phi.get<double>() : 0.0,
                                     kSuccessShare * map->best);
                         });
    if (near.reached()) near_best_s = near.time_s();
    daemon->Step(kHoldTicks);
    status = daemon->Call("status");
    row["outcome"] = Outcome(record, Plain(At(status, "state")));
    row["error"] = At(record, "error");
    moved = Distance(ObjectPlace(daemon), before);
  }
  const bool slid = row["outcome"] != "refused" && At(record, "phi_true_initial").is_number() &&
                    At(record, "phi_true_final").is_number();
  for (const char* key : {"reason", "converged", "cycles", "phi_initial", "phi_final",
                          "phi_true_initial", "phi_true_final"})
    row[key] = slid ? At(record, key) : Json();
  const bool done = row["outcome"] == "done";
  const double from = slid ? record.at("phi_true_initial").get<double>() : 0;
  const double to = slid ? record.at("phi_true_final").get<double>() : 0;
  row["phi_true_gain"] = done && from > 0 ? Json(to / from - 1) : Json();
  row["rose"] = done && to > from;
  if (map) {
    const bool known = map->rays > 0;
    row["phi_best"] = known ? Json(map->best) : Json();
    row["phi_best_distance_m"] = known ? Json(map->distance_m) : Json();
    row["share_of_best"] = known && done ? Json(to / map->best) : Json();
    row["near_best"] = known && done && to >= kSuccessShare * map->best;
    row["near_best_s"] = near_best_s;
  }
  row["path_length_m"] = slid ? At(record, "path_length_m") : Json();
  row["object_moved_m"] = moved;
  AddEnd(daemon, plan, unit, estimator, record, &row);
  return row;
}

void Push(SteppedDaemon* daemon, const Eigen::Vector3d& force_W) {
  daemon->Call("push",
               {{"force_n", {force_W.x(), force_W.y(), force_W.z()}}, {"duration_s", kPush_s}});
}

void AddLook(SteppedDaemon* daemon, WatchedRun* run) {
  const Json quality = daemon->Call("quality");
  run->time_s.push_back(quality.at("time_s"));
  run->values.push_back(Look(quality, daemon->Call("contacts")));
}

/// `watched`: takes looks at the gait, 10 a second; may be null.
Json Rotate(SteppedDaemon* daemon, const Plan& plan, const Unit& unit, WatchedRun* watched) {
  daemon->LeaveFault();
  daemon->Call("noise.set", {{"preset", unit.noise}});
  const Json grasp = daemon->Grasp(unit.seed);
  Json status = daemon->Call("status");
  const double turns_wanted = plan.TurnsOf(unit.which);
  Json row = Head(plan, unit);
  row.update({{"axis_W", unit.subject}, {"turns", turns_wanted}});
  row.update(Begun(unit, status, grasp));
  Json record;
  GaitEvents events(daemon);
  const double push_n = plan.setting(unit.which).push_n.value_or(0);
  RandomStream pushes(static_cast<std::uint64_t>(unit.seed), kPushStream);
  if (Done(grasp)) {
    Json params = {{"turns", turns_wanted}, {"axis", ParseNumbers(unit.subject, 3, "--axis")}};
    if (plan.speed_deg_s > 0) params["speed_rad_s"] = plan.speed_deg_s * std::numbers::pi / 180;
    const std::int64_t chunk = watched != nullptr ? kLookChunk : kRotateChunk;
    const std::int64_t per_turn = watched != nullptr ? kLongestWatched : kRotateLimitPerTurn;
    std::int64_t ticks = 0;
    record = daemon->Run(
        "rotate", params, chunk,
        kRotateLimit + static_cast<std::int64_t>(std::abs(turns_wanted) * per_turn), [&] {
          ticks += chunk;
          const bool rotating = At(daemon->Call("status"), "state") == "rotating";
          if (watched != nullptr && rotating) AddLook(daemon, watched);
          if (ticks % kRotateChunk != 0) return;
          events.Read();
          if (push_n > 0 && rotating) Push(daemon, push_n * pushes.Normal3().normalized());
        });
    events.Read();
    if (watched != nullptr && !watched->time_s.empty()) {
      watched->failures_s = events.failures_s();
      watched->end_s = watched->time_s.back();
    }
    status = daemon->Call("status");
    row["outcome"] = Outcome(record, Plain(At(status, "state")));
    row["error"] = At(record, "error");
  }
  const bool turned = At(record, "angle_rad").is_number();
  for (const char* key : {"angle_rad", "sim_time_s", "gait_cycles", "regrasps", "dropped",
                          "max_position_error_m", "max_tilt_rad", "max_lag_m", "reference_resets"})
    row[key] = turned ? At(record, key) : Json();
  const double angle = turned ? record.at("angle_rad").get<double>() : 0;
  const double time = turned ? record.at("sim_time_s").get<double>() : 0;
  row["step_mean_rad"] =
      turned ? Json(std::abs(angle) / (record.at("gait_cycles").get<double>() + 1)) : Json();
  row["angle_error_rad"] =
      turned ? Json(std::abs(angle - 2 * std::numbers::pi * turns_wanted)) : Json();
  const bool completed = row["outcome"] == "done" && turned;  // by the true angle: TurnedAsAsked
  row["rate_deg_min"] =
      completed && time > 0 ? Json(std::abs(angle) * 180 / std::numbers::pi / time * 60) : Json();
  row["completed"] = completed;
  const GaitEvents::Counts counts = events.Count();
  row["slips"] = turned ? Json(counts.slips) : Json();
  row["refusals"] = turned ? Json(counts.refusals) : Json();
  const bool low = counts.low > 0;
  row["phi_regrasps"] = turned ? Json(counts.low) : Json();
  row["phi_rise_share"] = low ? Json(static_cast<double>(counts.low_rose) / counts.low) : Json();
  row["phi_gain_mean"] = counts.explored > 0 ? Json(counts.gain_sum / counts.explored) : Json();
  AddEnd(daemon, plan, unit, "", record, &row);
  return row;
}

}  // namespace

void Prepare(SteppedDaemon* daemon, const Plan& plan, std::size_t which) {
  Json parameters = Json::object();
  for (const auto& [name, value] : Parameters(plan.setting(which))) parameters[name] = value;
  daemon->Call("param.load", {{"parameters", std::move(parameters)}});
}

UnitResult RunUnit(SteppedDaemon* daemon, const Plan& plan, const Unit& unit) {
  UnitResult result;
  if (plan.experiment == "prediction") {
    WatchedRun run;
    result.rows = {Rotate(daemon, plan, unit, &run)};
    result.map = ToJson(run);
    return result;
  }
  if (plan.rotation()) return {{Rotate(daemon, plan, unit, nullptr)}, nullptr};
  std::optional<PhiMap> map;
  if (plan.rays > 0) {
    map = MapPhi(daemon, unit.noise, unit.seed, unit.subject, plan.CriterionOf(unit.which),
                 plan.rays);
    result.map = map->samples;
  }
  for (const auto& estimator : plan.estimators)
    result.rows.push_back(Explore(daemon, plan, unit, estimator, map));
  return result;
}

}  // namespace regrasp::cli
