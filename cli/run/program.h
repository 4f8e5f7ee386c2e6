#pragma once

/// What the programs that `regrasp` runs for run files have in common: `regrasp` has checked their
/// arguments.

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "cli/run/run_file.h"
#include "cli/run/run_window.h"
#include "core/protocol/errors.h"

namespace regrasp::run {

using Json = nlohmann::ordered_json;

struct Command {
  std::string verb, file;  ///< the first of `files`
  std::vector<std::string> files;
  std::map<std::string, std::string> options;  ///< "--speed" -> "1.0"; flags -> ""
  bool json() const { return options.contains("--json"); }
  bool Has(const char* name) const { return options.contains(name); }
  double Number(const char* name, double otherwise) const;
  /// --from and --to.
  Stretch stretch() const { return {Number("--from", 0), Number("--to", 1e9)}; }
};

void Print(const Command& command, const Json& result, const std::string& text);
/// A line for people, on standard error.
void Note(const std::string& text);
/// First of all: what the runs of a file were made with, where that is not what this program has.
/// Each once.
Json TellDifferences(const RunFile& file);
/// The same of one run that is only exported: a configuration that cannot be used is no reason to
/// stop. Adds to `told`.
void TellDifferences(std::string_view config, Json* told);
Json LossesJson(const std::vector<McapLoss>& lost);
/// What is said of a file without an end.
std::string EndText(bool complete);
std::string LossesText(const std::vector<McapLoss>& lost);

/// Parses, runs what belongs to the verb, and turns exceptions into an error: cli::CliError with
/// its exit code and hint, all others as faults of the file. Returns the exit code.
int RunVerb(int argc, char** argv,
            const std::map<std::string, ExitCode (*)(const Command&)>& verbs);

}  // namespace regrasp::run
