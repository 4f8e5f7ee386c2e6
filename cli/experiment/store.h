#pragma once

/// An experiment's directory:
///   experiment.json  the plan
///   trials.jsonl     a line for each finished unit, in the order in which they finished, with the
///                    number of seeds that its place among the units belongs to
///   trials.csv, maps.csv, summary.json, summary.png    made from these when all have finished
/// A line is written at once when its unit has finished, and ends with a check of itself and of the
/// plan: one that a crash cut off, that is not as it was written, or that is of another experiment
/// is ignored and its unit runs again.

#include <filesystem>
#include <map>

#include "cli/experiment/plan.h"

namespace regrasp::cli {

using Trials = std::map<std::size_t, UnitResult>;  ///< by index of the unit

class Store {
 public:
  /// Makes the directory and writes the plan, or goes on with the one that is there, also with more
  /// seeds than before (but not in shards, whose parts those would change). Throws CliError:
  /// kRefused when it holds another experiment (the difference is named) or another program works
  /// in it, kIo.
  Store(std::filesystem::path directory, const Plan& plan);
  ~Store();
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  const std::filesystem::path& directory() const { return directory_; }
  const Trials& trials() const { return trials_; }
  /// Keeps a finished unit. Throws CliError(kIo).
  void Add(std::size_t unit, const UnitResult& result);

 private:
  std::filesystem::path directory_;
  std::string key_;  ///< of the plan
  std::int64_t seeds_ = 0;
  int lock_ = -1, file_ = -1;
  Trials trials_;
};

/// The plan of a directory. Throws CliError(kNotFound, kIo).
Plan ReadPlan(const std::filesystem::path& directory);
/// Its finished units by their place in `plan`, which is its own; none when it has no trials.
/// Throws CliError(kIo).
Trials ReadTrials(const std::filesystem::path& directory, const Plan& plan);
/// Replaces a file as a whole. Throws CliError(kIo).
void WriteFile(const std::filesystem::path& path, const std::string& text);

}  // namespace regrasp::cli
