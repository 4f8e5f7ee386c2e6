// A scenario beside a hand that is in order: refused with a ModelError, or loaded with postures
// within the limits.
//   cmake --preset fuzz && ninja -C build/fuzz fuzz_scenario && build/fuzz/tests/fuzz_scenario
//   -max_len=8192 tests/fuzz/corpus/scenario

#include <fstream>

#include "core/hand/scenario.h"
#include "tests/fuzz/model_file.h"
#include "tests/unit/hand/model_files.h"

namespace {

using namespace regrasp;

/// A models directory whose scenario is replaced by each input.
const fs::path& Directory() {
  static const fs::path directory = [] {
    std::string name = (fs::temp_directory_path() / "regrasp_fuzz_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) std::abort();
    fs::create_directories(fs::path(name) / "hands");
    fs::create_directories(fs::path(name) / "objects");
    std::ofstream(fs::path(name) / "hands/mini.urdf") << kHandUrdf;
    std::ofstream(fs::path(name) / "objects/ball.urdf") << kBallUrdf;
    return fs::path(name);
  }();
  return directory;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::ofstream(Directory() / "hands/mini.toml", std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    const LoadedScenario loaded = LoadScenario("mini", "", {Directory()});
    for (int j = 0; j < loaded.hand.num_joints(); ++j) {
      const Joint& joint = loaded.hand.joints[static_cast<std::size_t>(j)];
      for (const double q : {loaded.scenario.q_preshape[j], loaded.scenario.q_closed[j]})
        if (!(q >= joint.lower && q <= joint.upper)) std::abort();
    }
  } catch (const ModelError&) {
  }
  return 0;
}
