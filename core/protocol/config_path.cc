#include "core/protocol/config_path.h"

#include <unistd.h>

#include <cstdlib>

#include "core/protocol/user_directories.h"

namespace regrasp {
std::string UsualConfigFile() {
  const char* named = std::getenv("REGRASP_CONFIG");
  if (named != nullptr && *named != '\0') return named;
  for (const std::string& directory : {ConfigHome(), std::string("/etc")}) {
    const std::string file = directory + "/regrasp/regraspd.toml";
    if (!directory.empty() && ::access(file.c_str(), F_OK) == 0) return file;
  }
  return {};
}

}  // namespace regrasp
