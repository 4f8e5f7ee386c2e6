#include "core/protocol/user_directories.h"

#include <unistd.h>

#include <cstdlib>

namespace regrasp {
namespace {

std::string OrInHome(const char* variable, const char* below) {
  if (std::string named = DirectoryVariable(variable); !named.empty()) return named;
  const std::string home = DirectoryVariable("HOME");
  return home.empty() ? "" : home + below;
}

}  // namespace

std::string DirectoryVariable(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr && *value == '/' ? value : "";
}

std::string ConfigHome() { return OrInHome("XDG_CONFIG_HOME", "/.config"); }
std::string StateHome() { return OrInHome("XDG_STATE_HOME", "/.local/state"); }

std::string DefaultOutputDir() {
  if (const std::string state = StateHome(); !state.empty()) return state + "/regrasp";
  return "/tmp/regrasp-" + std::to_string(::geteuid()) + "/output";
}

std::string HomeExpanded(const std::string& path) {
  const std::string home = DirectoryVariable("HOME");
  if (home.empty() || (path != "~" && !path.starts_with("~/"))) return path;
  return home + path.substr(1);
}

}  // namespace regrasp
