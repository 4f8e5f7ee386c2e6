// A configuration file of the daemon: refused with a ConfigError, or values that are allowed.

#include "daemon/config/config.h"
#include "tests/fuzz/model_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static regrasp::ModelFile file;
  file.Write(data, size);
  try {
    regrasp::DaemonConfig config;
    regrasp::ReadConfigFile(file.path(), &config);
    regrasp::CheckConfig(config, "");
    if (config.max_clients < 1) std::abort();
  } catch (const regrasp::ConfigError&) {
  }
  return 0;
}
