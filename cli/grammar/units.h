#pragma once

/// Numbers with a unit behind them: 90deg, 2mm, 0.5N, 1.5s.

#include <string>
#include <string_view>
#include <vector>

namespace regrasp::cli {

/// `text` as a number of `unit` ("deg", "mm", "N", "s", "Hz", "deg/s", "kg", ...; letters' case as
/// in SI; words too: degrees, turns, seconds): a bare number is one already, any other unit of the
/// same kind is converted. With an empty or unknown `unit` only bare numbers are taken. Throws
/// CliError(kUsage) that names `what` and the units that are allowed.
double ParseQuantity(const std::string& text, const std::string& what, std::string_view unit);

/// Whether `text` is a number with something behind it that may be a unit.
bool HasUnit(const std::string& text);

/// "X,Y,Z", each with or without a unit; `count` of them.
std::vector<double> ParseQuantities(const std::string& text, std::size_t count,
                                    const std::string& what, std::string_view unit);

/// The unit of a bare number on the command line for what is called `key` on the wire:
/// "angle_rad" -> "deg"; "" where it has none.
std::string_view UnitOfKey(std::string_view key);

}  // namespace regrasp::cli
