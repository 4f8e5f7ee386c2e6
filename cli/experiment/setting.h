#pragma once

/// What a trial has otherwise than the scenario.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/client/client.h"

namespace regrasp::cli {

/// The least and the most of a number that a method of the wire takes, in units of `unit` SI.
std::pair<double, double> RangeOnWire(const char* method, const char* parameter, double unit = 1);

struct Setting {
  std::string object;              ///< name or absolute path; empty: the scenario's
  std::optional<double> tilt_deg;  ///< 0 palm up, 90 fingers down; none: the scenario's
  std::optional<double> push_n;    ///< rotations: a push in a random direction, every second
  std::optional<double> turns;     ///< rotations, in a case: instead of the plan's
  std::string criterion;           ///< explorations, in a case: instead of the plan's
  std::vector<std::pair<std::string, std::string>> set;  ///< parameters, values as typed
};

/// One of several settings that an experiment compares.
struct Case {
  std::string name;
  Setting setting;
  std::vector<std::string> against = {};  ///< the cases it is compared with; none: the first
};

/// "NAME: KEY=VALUE ..." or "KEY=VALUE ..." (which is then the name, too). KEY is object, tilt,
/// push, turns, criterion or a parameter, each at most once and within the limits of the option of
/// that name; "NAME:" alone changes nothing. Throws CliError(kUsage).
Case ParseCase(const std::string& text);
/// The inverse: ParseCase(Text(c)) is c.
std::string Text(const Case& c);

/// `common` with what `special` says differently. Tilt and gravity are one.
Setting Join(Setting common, const Setting& special);

/// The cases of a sweep: for each of `cases` (or for none) one per value, in their order. Each is
/// compared with the one that has the first value and is otherwise the same, and with what the case
/// was compared with before, at the same value.
std::vector<Case> Sweep(const std::vector<Case>& cases, const std::string& parameter,
                        const std::vector<std::string>& values);

/// Parameters as `param set` takes them, the tilt among them as gravity: of the scenario's
/// strength, in the plane of W's y and z. Throws CliError(kUsage) where a value is no number.
std::vector<std::pair<std::string, Json>> Parameters(const Setting& setting);

/// A name stays a name, a file becomes an absolute path.
std::string ModelName(const std::string& text);
/// "NAME=VALUE" in its two parts. Throws CliError(kUsage) that names `flag`.
std::pair<std::string, std::string> NameAndValue(const std::string& word, const char* flag);

}  // namespace regrasp::cli
