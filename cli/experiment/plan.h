#pragma once

/// What an experiment does, and nothing of how: no worker, no clock, no path but those of models.

#include <algorithm>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "cli/experiment/setting.h"
#include "cli/grammar/grammar.h"

namespace regrasp::cli {

/// One part of an experiment that is run and kept as a whole: what starts from the same state. An
/// exploration gives a row for each estimator, a rotation one row.
struct Unit {
  std::size_t which = 0;  ///< of Plan::cases
  std::string noise;
  std::string subject;  ///< the finger, or the axis as "X,Y,Z"
  std::int64_t seed = 0;
};

/// What running a unit gave.
struct UnitResult {
  std::vector<Json> rows;  ///< members are the columns of trials.csv
  Json map;                ///< explorations: PhiMap::samples; prediction: a WatchedRun; else null
  bool operator==(const UnitResult&) const = default;
};

struct Plan {
  std::string experiment;        ///< "exploration", "noise-sweep", "rotation", "zoo", "prediction"
  std::string hand, models_dir;  ///< empty: the daemon's own
  Setting common;                ///< of every trial
  std::vector<Case> cases;       ///< settings to compare; empty: `common` alone
  std::vector<std::string> noise, subjects;
  std::int64_t first_seed = 1, seeds = 0;
  std::vector<std::string> estimators;  ///< explorations
  std::string criterion;                ///< explorations
  int rays = 0;                         ///< explorations: of the map of phi; 0: no map
  double turns = 0, speed_deg_s = 0;    ///< rotations; speed 0: the parameter's
  /// Zoo and prediction, until they are cases; objects "zoo": all of it.
  std::vector<std::string> objects, gaits;
  std::string stepper = "fast";  ///< fast or exact
  // Of the daemon, filled in by CompletePlan():
  std::string version, build;  ///< build: over the bytes of the program
  std::string built_from;      ///< commit, compiler, flags
  Json models;      ///< {"hand": "NAME HASH", "scenario", "object"}; with cases {CASE: {...}}
  Json parameters;  ///< {NAME: value} where they differ from the defaults; likewise
  int shard = 1, shards = 1;  ///< this part, 1 ... shards, takes every shards-th unit

  bool rotation() const {
    return experiment == "rotation" || experiment == "zoo" || experiment == "prediction";
  }
  std::size_t num_units() const;
  Unit unit(std::size_t index) const;
  /// The place among the units of this plan of one that has place `index` in the same plan with
  /// `of_seeds` seeds, at most this plan's.
  std::size_t Grown(std::size_t index, std::int64_t of_seeds) const;
  /// Indices of the units of this shard, ascending.
  std::vector<std::size_t> Mine() const;
  /// At least 1.
  std::size_t num_cases() const { return std::max<std::size_t>(1, cases.size()); }
  Setting setting(std::size_t which) const;
  /// Rotations: turns of a case.
  double TurnsOf(std::size_t which) const { return setting(which).turns.value_or(turns); }
  /// Explorations: criterion of a case.
  std::string CriterionOf(std::size_t which) const {
    const std::string own = setting(which).criterion;
    return own.empty() ? criterion : own;
  }
  /// The command that makes the one row of this unit (and estimator) again.
  std::string Command(const Unit& unit, const std::string& estimator) const;
  /// Arguments for the daemon of a case.
  std::vector<std::string> DaemonArguments(std::size_t which = 0) const;
};

/// What decides the results, as it is written in experiment.json; the inverse of PlanFromJson().
Json ToJson(const Plan& plan);
/// Throws CliError(kIo) naming `path` when `json` is no plan.
Plan PlanFromJson(const Json& json, const std::string& path);
/// A key of what decides the results of a unit: hex, of the plan less seeds and shard, which say
/// only how many units there are and which of them are run.
std::string KeyOf(const Plan& plan);
/// "noise was [\"paper\"], is [\"off\"]; models.object was ..., is ..." for every difference but
/// the shard; empty when there is none.
std::string Difference(const Plan& before, const Plan& now);

/// Makes cases of the values of every `--set NAME=A,B,...` but those of vectors: those are for
/// which `is_vector` returns true. Throws CliError(kUsage), also where a case gives the same
/// parameter.
void ExpandSweeps(Plan* plan, const std::function<bool(const std::string& parameter)>& is_vector);

/// Makes the cases of a zoo: every object with every gait, each gait compared with the first.
void ExpandZoo(Plan* plan);

inline constexpr const char* kWholeZoo = "zoo";     ///< of --objects
inline constexpr const char* kEveryFinger = "all";  ///< of --finger

/// What a prediction looks at unless told: bodies of all kinds.
inline constexpr const char* kPredictionObjects =
    "sphere,egg,cube_40mm,zoo_box_flat,zoo_cylinder_lying,zoo_ellipsoid_lying,zoo_peanut_upright,"
    "zoo_pear,zoo_pillow,zoo_square,zoo_superquadric_02,zoo_triangle";

/// Makes the cases of a prediction: every object as it is, pushed, and slippery.
void ExpandHazards(Plan* plan);

/// The plan that the arguments of `experiment exploration|noise-sweep|rotation|zoo|prediction` ask
/// for; fingers ("all") and the zoo's objects are still to be named, sweeps to be expanded, version
/// and build to be filled in. Throws CliError(kUsage).
Plan PlanFromArguments(const std::string& experiment, const Invocation& invocation);

}  // namespace regrasp::cli
