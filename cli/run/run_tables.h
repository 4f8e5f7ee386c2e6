#pragma once

/// A run file as tables, a topic each, and the formats that tables have.

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "cli/run/resample.h"
#include "core/mcap/mcap_reader.h"

namespace regrasp::run {

/// Where messages come from: the file, or the replay of a stretch. Tells what of the file was lost.
using Source = std::function<McapSummary(const OnMessage&)>;

/// JSON objects, a message each.
using TableRows = std::vector<nlohmann::ordered_json>;

struct RunTables {
  std::map<std::string, TableRows> topics;
  std::vector<std::string> joints, fingers;  ///< names
};

/// A topic or a field becomes the name of a file, or of an archive's member. Throws
/// std::runtime_error with `path` where it is none.
void CheckFileName(const std::string& path, const char* what, std::string_view name);

/// Throws std::runtime_error where a file has no message of topic "run", unless damage took it and
/// left others.
void CheckHoldsRun(const std::string& path, bool has_run, const McapSummary& summary);

/// All topics but those for viewers and the saved states. Throws std::runtime_error with `path` for
/// a message that is not as expected, or a file that holds no run.
RunTables ReadTables(const std::string& path, const Source& source, McapSummary* summary);

/// The unit of a field, or "": that of a parameter ("parameters.gravity.x") by its table, else what
/// the end of its name tells.
std::string_view UnitOf(std::string_view field);

/// One topic. Throws std::runtime_error where it cannot be written.
void WriteCsv(const RunTables& run, const TableRows& rows, const std::string& out);

/// Everything, in an array per topic and field. Throws std::runtime_error.
void WriteNpz(const RunTables& run, const std::string& out);

}  // namespace regrasp::run
