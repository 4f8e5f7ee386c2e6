#include "core/protocol/config_path.h"

#include <unistd.h>

#include <cstdlib>

namespace regrasp {
namespace {

std::string Environment(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

}  // namespace

std::string UsualConfigFile() {
  if (std::string named = Environment("REGRASP_CONFIG"); !named.empty()) return named;
  std::string home = Environment("XDG_CONFIG_HOME");
  if (home.empty() && !Environment("HOME").empty()) home = Environment("HOME") + "/.config";
  for (const std::string& directory : {home, std::string("/etc")}) {
    const std::string file = directory + "/regrasp/regraspd.toml";
    if (!directory.empty() && ::access(file.c_str(), F_OK) == 0) return file;
  }
  return {};
}

}  // namespace regrasp
