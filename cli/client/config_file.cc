#include "cli/client/config_file.h"

#include <fmt/format.h>
#include <toml++/toml.h>
#include <unistd.h>

#include "cli/client/errors.h"
#include "core/files/toml_text.h"
#include "core/protocol/config_path.h"
#include "core/protocol/user_directories.h"

namespace regrasp::cli {

std::string ConfiguredSocket() {
  const std::string file = UsualConfigFile();
  if (file.empty()) return {};
  if (::access(file.c_str(), R_OK) != 0)
    throw CliError(kPermission, fmt::format("cannot read {}", file), "ls -l " + file);
  try {
    const toml::table table = toml::parse(ReadTomlText(file));
    const toml::node* node = table.get("socket");
    if (node == nullptr) return {};
    const std::string socket = HomeExpanded(node->value_or(std::string()));
    if (node->is_string() && (socket.empty() || socket.starts_with('/'))) return socket;
    throw CliError(
        kUsage,
        fmt::format("{}:{}: socket: expected an absolute path, or one that begins with ~/", file,
                    node->source().begin.line),
        "regrasp config check");
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
