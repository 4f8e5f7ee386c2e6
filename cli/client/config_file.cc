#include "cli/client/config_file.h"

#include <fmt/format.h>
#include <toml++/toml.h>
#include <unistd.h>

#include "cli/client/errors.h"
#include "core/files/toml_text.h"
#include "core/protocol/config_path.h"

namespace regrasp::cli {

std::string ConfiguredSocket() {
  const std::string file = UsualConfigFile();
  if (file.empty()) return {};
  if (::access(file.c_str(), R_OK) != 0)
    throw CliError(kPermission, fmt::format("cannot read {}", file), "ls -l " + file);
  try {
    return toml::parse(ReadTomlText(file))["socket"].value_or(std::string());
  } catch (const toml::parse_error& error) {
    throw CliError(kUsage,
                   fmt::format("{}:{}: {}", file, error.source().begin.line, error.description()),
                   "regrasp config check");
  } catch (const std::runtime_error& error) {
    throw CliError(kUsage, error.what(), "regrasp config check");
  }
}

}  // namespace regrasp::cli
