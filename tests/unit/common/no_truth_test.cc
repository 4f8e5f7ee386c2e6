#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <string>

namespace {

namespace fs = std::filesystem;

/// Adds `file` (relative to the sources) and every file of ours that it includes, directly or not.
void AddIncludes(const fs::path& root, const std::string& file, std::set<std::string>* seen) {
  if (!seen->insert(file).second) return;
  std::ifstream in(root / file);
  ASSERT_TRUE(in) << file;
  static const std::regex kInclude(R"re(^\s*#\s*include\s*"([^"]+)")re");
  std::smatch match;
  for (std::string line; std::getline(in, line);)
    if (std::regex_search(line, match, kInclude)) AddIncludes(root, match[1], seen);
}

/// Sources of one folder, relative to the source tree.
std::set<std::string> Sources(const fs::path& root, const std::string& folder) {
  std::set<std::string> files;
  if (!fs::exists(root / folder)) return files;
  for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".h" || extension == ".cc")
      files.insert(fs::relative(entry.path(), root).string());
  }
  return files;
}

// The controller knows what the sensors give it and nothing else: neither the simulator, nor the
// simulator's object, nor the class that turns truth into readings is reachable from it through any
// chain of includes.
TEST(NoTruth, ControllerReachesNeitherWorldNorSensors) {
  const fs::path root = REGRASP_SOURCE_DIR;
  int files = 0;
  for (const char* folder : {"core/control", "core/shape", "core/exploration", "core/gait"}) {
    for (const std::string& file : Sources(root, folder)) {
      ++files;
      std::set<std::string> reached;
      AddIncludes(root, file, &reached);
      for (const std::string& header : reached) {
        EXPECT_FALSE(header.starts_with("core/world/")) << file << " reaches " << header;
        EXPECT_FALSE(header.starts_with("core/session/")) << file << " reaches " << header;
        EXPECT_NE(header, "core/sensing/sensors.h") << file;
        EXPECT_NE(header, "core/hand/object_model.h") << file;
        EXPECT_NE(header, "core/hand/scenario.h") << file;
      }
    }
  }
  EXPECT_GE(files, 15);  // a moved folder must not make this test empty
}

// The check itself sees a violation: the session does include the world.
TEST(NoTruth, CheckSeesTheSessionReachingTheWorld) {
  std::set<std::string> reached;
  AddIncludes(REGRASP_SOURCE_DIR, "core/session/session.cc", &reached);
  EXPECT_TRUE(reached.contains("core/world/world.h"));
  EXPECT_TRUE(reached.contains("core/sensing/sensors.h"));
}

}  // namespace
