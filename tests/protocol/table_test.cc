// The method table against everything that is made from it or must agree with it.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>

#include "core/common/nearest_name.h"
#include "core/protocol/errors.h"
#include "core/protocol/methods.h"
#include "core/protocol/socket_path.h"
#include "core/sensing/noise.h"
#include "core/sensing/sensors.h"
#include "core/session/command.h"
#include "daemon/pages/protocol_page.h"
#include "daemon/requests/service.h"

namespace regrasp {
namespace {

TEST(MethodTable, EveryMethodHasAHandler) {
  for (const MethodSpec& method : MethodTable())
    EXPECT_NE(FindHandler(method.name), nullptr) << method.name;
}

TEST(MethodTable, HasARowForEveryJob) {
  EXPECT_EQ(JobMethods().size(), kJobTable.size());
  for (const JobInfo& job : kJobTable) {
    const auto row = std::ranges::find(JobMethods(), job.name, &MethodSpec::name);
    ASSERT_NE(row, JobMethods().end()) << job.name;
    EXPECT_TRUE(row->job) << job.name;
    ASSERT_NE(FindMethod(job.name), nullptr);
  }
}

TEST(MethodTable, IsComplete) {
  for (const MethodSpec& method : MethodTable()) {
    EXPECT_EQ(FindMethod(method.name), &method);
    EXPECT_FALSE(method.sentence.empty()) << method.name;
    EXPECT_FALSE(method.words.empty()) << method.name;
    EXPECT_FALSE(method.result.empty()) << method.name;
    std::set<std::string_view> names;
    for (const ParamSpec& spec : method.params) {
      EXPECT_TRUE(names.insert(spec.name).second) << method.name << " " << spec.name;
      EXPECT_FALSE(spec.sentence.empty()) << method.name << " " << spec.name;
      EXPECT_EQ(spec.required, spec.default_text.empty()) << method.name << " " << spec.name;
      EXPECT_LE(spec.min, spec.max) << method.name << " " << spec.name;
      const bool words = !spec.values.empty() || spec.names != NameSource::kNone;
      EXPECT_EQ(spec.type == ParamType::kEnum, words) << method.name << " " << spec.name;
    }
  }
  EXPECT_EQ(FindMethod("statu"), nullptr);
}

TEST(MethodTable, KnowsTheLongestPoseDelay) {
  EXPECT_EQ(FindParam(*FindMethod("noise.set"), "object_delay_frames")->max, kMaxPoseDelay);
}

TEST(MethodTable, KnowsTheNoisePresets) {
  const auto table = FindParam(*FindMethod("noise.set"), "preset")->values;
  const auto presets = NoisePresetNames();
  EXPECT_TRUE(std::equal(table.begin(), table.end(), presets.begin(), presets.end()));
}

TEST(ErrorTable, GivesEveryCodeAnExitCode) {
  EXPECT_EQ(ExitCodeFor(-32001), ExitCode::kRefused);
  EXPECT_EQ(ExitCodeFor(-32602), ExitCode::kUsage);
  EXPECT_EQ(ExitCodeFor(-32006), ExitCode::kSimulationFault);
  EXPECT_EQ(ExitCodeFor(-1), ExitCode::kProtocol);
  for (const ErrorInfo& info : ErrorTable())
    EXPECT_EQ(FindError(static_cast<int>(info.code)), &info);
}

TEST(ProtocolPage, IsTheCommittedOne) {
  std::ifstream file(std::string(REGRASP_SOURCE_DIR) + "/docs/protocol.md");
  std::stringstream committed;
  committed << file.rdbuf();
  EXPECT_EQ(committed.str(), ProtocolPage()) << "regraspd --print-protocol > docs/protocol.md";
}

TEST(NearestName, FindsTypingErrorsAndNothingElse) {
  const std::vector<std::string> names = {"thumb", "first", "middle", "ring", "little"};
  EXPECT_EQ(NearestName("rign", names), "ring");
  EXPECT_EQ(NearestName("litle", names), "little");
  EXPECT_EQ(NearestName("elbow", names), "");
  EXPECT_EQ(NearestName("", names), "");
  // One slip from both: the beginning decides, not the order.
  EXPECT_EQ(NearestName("sped", std::vector<std::string_view>{"seed", "speed"}), "speed");
  // A name that is only begun, and one without its last words.
  EXPECT_EQ(NearestName("manip", std::vector<std::string_view>{"stability", "manipulability"}),
            "manipulability");
  EXPECT_EQ(
      NearestName("gait.spped", std::vector<std::string_view>{"gait.slip_s", "gait.speed_rad_s"}),
      "gait.speed_rad_s");
  EXPECT_EQ(NearestName("zoo_bxo", std::vector<std::string_view>{"zoo_egg", "zoo_box_flat"}),
            "zoo_box_flat");
  EXPECT_EQ(NearestName("ma", std::vector<std::string_view>{"manipulability"}), "");
  // Short words are not near to whatever is as short, nor to the first word of a longer name.
  const std::vector<std::string_view> objects = {"cube_40mm", "zoo_box_flat", "zoo_egg",
                                                 "zoo_pear"};
  for (const char* other : {"foo", "moo", "boo", "foobar", "tub"})
    EXPECT_EQ(NearestName(other, objects), "") << other;
  // The beginning of many is none of them.
  EXPECT_EQ(NearestName("zoo", objects), "");
  EXPECT_EQ(NearestName("gait", std::vector<std::string_view>{"gait.hop", "gait.mode"}), "");
  EXPECT_EQ(NearestName("exp", std::vector<std::string_view>{"explore", "explore"}), "explore");
  EXPECT_EQ(NearestName("cube", objects), "cube_40mm");
  EXPECT_EQ(OrNearest("rign", names), "; did you mean 'ring'?");
  EXPECT_EQ(OrNearest("elbow", names), "");
  EXPECT_EQ(EditDistance("abcd", "acbd"), 1u);  // a swap is one slip
}

class SocketPathTest : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : {"REGRASP_SOCKET", "XDG_RUNTIME_DIR"}) {
      if (const char* value = std::getenv(name)) saved_[name] = value;
      ::unsetenv(name);
    }
  }
  void TearDown() override {
    for (const char* name : {"REGRASP_SOCKET", "XDG_RUNTIME_DIR"}) ::unsetenv(name);
    for (const auto& [name, value] : saved_) ::setenv(name.c_str(), value.c_str(), 1);
  }
  std::map<std::string, std::string> saved_;
};

TEST_F(SocketPathTest, FlagBeatsEnvironmentBeatsFile) {
  ::setenv("REGRASP_SOCKET", "/e", 1);
  EXPECT_EQ(ResolveSocketPath("/f", "/c", SocketUse::kConnect).path, "/f");
  EXPECT_EQ(ResolveSocketPath("", "/c", SocketUse::kConnect).path, "/e");
  ::unsetenv("REGRASP_SOCKET");
  EXPECT_EQ(ResolveSocketPath("", "/c", SocketUse::kConnect).path, "/c");
}

TEST_F(SocketPathTest, TheRuntimeDirectoryComesBeforeTheRest) {
  ::setenv("XDG_RUNTIME_DIR", "/tmp", 1);
  EXPECT_EQ(ResolveSocketPath("", "", SocketUse::kListen).path, "/tmp/regrasp/regrasp.sock");
  ::setenv("XDG_RUNTIME_DIR", "/dev/null/absent", 1);  // nobody can make this one
  EXPECT_NE(ResolveSocketPath("", "", SocketUse::kListen).source, "$XDG_RUNTIME_DIR");
}

}  // namespace
}  // namespace regrasp
