#include "cli/client/config_file.h"

#include <fmt/format.h>
#include <toml++/toml.h>
#include <unistd.h>

#include <algorithm>

#include "cli/client/errors.h"
#include "core/common/nearest_name.h"
#include "core/files/toml_text.h"
#include "core/protocol/config_path.h"
#include "core/protocol/user_directories.h"

namespace regrasp::cli {
namespace {

/// Keys that are none, a misspelt `socket` say, are refused here, too; other values are the
/// daemon's to judge.
std::string SocketOf(const toml::table& table, const std::string& file) {
  const auto fail = [&](const toml::node& node, const std::string& cause) {
    throw CliError(kUsage, fmt::format("{}:{}: {}", file, node.source().begin.line, cause),
                   "regrasp config check");
  };
  for (const auto& [key, node] : table) {
    if (key == "parameters" ||
        std::ranges::find(kConfigKeyNames, key.str()) != kConfigKeyNames.end())
      continue;
    fail(node, fmt::format("unknown key '{}'{}", key.str(), OrNearest(key.str(), kConfigKeyNames)));
  }
  const toml::node* node = table.get("socket");
  if (node == nullptr) return {};
  const std::string socket = HomeExpanded(node->value_or(std::string()));
  if (!node->is_string() || (!socket.empty() && !socket.starts_with('/')))
    fail(*node, fmt::format("socket = {}: expected an absolute path, or one that begins with ~/",
                            node->is_string() ? JsonQuote(socket) : "..."));
  return socket;
}

}  // namespace

std::string ConfiguredSocket() {
  const std::string file = UsualConfigFile();
  if (file.empty()) return {};
  if (::access(file.c_str(), R_OK) != 0)
    throw CliError(kPermission, fmt::format("cannot read {}", file), "ls -l " + file);
  try {
    return SocketOf(toml::parse(ReadTomlText(file)), file);
  } catch (const CliError&) {
    throw;
  } catch (const toml::parse_error& error) {
    throw CliError(kUsage,
                   fmt::format("{}:{}: {}", file, error.source().begin.line, error.description()),
                   "regrasp config check");
  } catch (const std::runtime_error& error) {
    throw CliError(kUsage, error.what(), "regrasp config check");
  }
}

}  // namespace regrasp::cli
