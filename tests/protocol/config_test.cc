// The configuration file.

#include "daemon/config/config.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "core/protocol/start_words.h"
#include "core/world/world.h"
#include "daemon/config/reload.h"
#include "tests/protocol/daemon_fixture.h"

namespace regrasp::test {
namespace {

/// What reading this text complains about; "" when it is accepted.
std::string Complaint(const std::string& text, DaemonConfig* config) {
  const TemporaryDirectory directory;
  std::ofstream(directory / "c.toml") << text;
  try {
    ReadConfigFile(directory / "c.toml", config);
    return "";
  } catch (const ConfigError& e) {
    return e.what();
  }
}

TEST(StepperNames, OfTheProtocolAreThoseOfTheWorld) {
  EXPECT_EQ(kSteppers.size(), static_cast<std::size_t>(kLastStepper) + 1);
  EXPECT_EQ(kStepperWords.size(), kSteppers.size() + 1);
  for (const std::string_view name : kSteppers) {
    const auto stepper = StepperNamed(name);
    ASSERT_TRUE(stepper) << name;
    EXPECT_EQ(Name(*stepper), name);
    EXPECT_TRUE(std::ranges::find(kStepperWords, name) != kStepperWords.end()) << name;
  }
  EXPECT_FALSE(StepperNamed("auto"));
}

TEST(Config, ReadsEveryKey) {
  DaemonConfig config;
  const std::string text = R"(
socket = "/tmp/x.sock"
seed = 7
object = "egg"
speed = "max"
paused = true
noise = "fine"
max_clients = 3
log_level = "warn"
[parameters]
"object.friction" = 0.5
gravity = [0, -9.81, 0]
[parameters.exploration]
lambda = 0.8
)";
  EXPECT_EQ(Complaint(text, &config), "");
  EXPECT_EQ(config.seed, 7u);
  EXPECT_EQ(config.speed, "max");
  EXPECT_TRUE(config.paused);
  EXPECT_EQ(config.max_clients, 3);
  ASSERT_EQ(config.parameters.size(), 3u);
  bool found = false;
  for (const auto& [name, value] : config.parameters)
    if (name == "exploration.lambda") found = value.x() == 0.8;
  EXPECT_TRUE(found);
}

TEST(Config, NamesLineKeyAndNearestName) {
  struct Case {
    std::string text;
    std::vector<std::string> parts;
  };
  const std::vector<Case> cases = {
      {"seed = 1\nspede = 2\n", {":2:", "spede", "'speed'"}},
      {"\n\nseed = -1", {":3:", "seed"}},
      {"seed = 1.5", {":1:", "integer"}},
      {"paused = 1", {":1:", "true or false"}},
      {"noise = \"pape\"", {":1:", "'paper'"}},
      {"speed = 0", {":1:", "0.001"}},
      {"speed = nan", {":1:", "0.001"}},
      {"max_clients = 0", {":1:", "1 ... 1000"}},
      {"parameters = 3", {":1:", "table"}},
      {"[parameters]\n\"object.frction\" = 0.5", {":2:", "'object.friction'"}},
      {"[parameters]\nobject.friction = 7", {":2:", "0.001 ... 1"}},
      {"[parameters]\nobject.friction = nan", {":2:", "0.001 ... 1"}},
      {"[parameters]\nobject.friction = \"a\"", {":2:", "number"}},
      {"[parameters]\ngravity = 9.81", {":2:", "3 numbers"}},
      {"seed = 1\nseed = 2", {":2:", "seed"}},
      {"seed = ", {":1:"}},
  };
  for (const Case& c : cases) {
    DaemonConfig config;
    const std::string complaint = Complaint(c.text, &config);
    for (const std::string& part : c.parts)
      EXPECT_NE(complaint.find(part), std::string::npos) << c.text << " -> " << complaint;
  }
}

TEST(Config, TheDefaultFileIsTheDefault) {
  DaemonConfig config;
  EXPECT_EQ(Complaint(DefaultConfigText(), &config), "");
  const DaemonConfig built_in;
  EXPECT_EQ(ParseSpeed(config.speed), ParseSpeed(built_in.speed));
  EXPECT_EQ(config.noise, built_in.noise);
  EXPECT_EQ(config.hand, built_in.hand);
  EXPECT_TRUE(config.parameters.empty());
  // Uncommented, every parameter is accepted too.
  std::string text = DefaultConfigText();
  for (std::size_t at; (at = text.find("\n# \"")) != std::string::npos;) text.erase(at + 1, 2);
  EXPECT_EQ(Complaint(text, &config), "");
  EXPECT_EQ(config.parameters.size(), ParameterTable().size());
}

TEST(Config, EverythingThatIsWrongIsToldAtOnceInTheOrderOfTheFile) {
  DaemonConfig config;
  const std::string complaint = Complaint(
      "sed = 3\nspeed = \"fast\"\nstepper = \"exact\"\nmax_clients = 0\n"
      "[parameters]\nobject.friction = 5\ngait.mod = 1\n",
      &config);
  std::size_t at = 0;
  for (const char* part : {"5 errors:\n  ", ":1: unknown key 'sed'; did you mean 'seed'?\n  ",
                           ":2: speed = \"fast\": expected 0.001", ":4: max_clients = 0: expected",
                           ":6: object.friction = 5 is out of range",
                           ":7: unknown parameter 'gait.mod'; did you mean 'gait.mode'?"}) {
    const std::size_t found = complaint.find(part, at);
    ASSERT_NE(found, std::string::npos) << part << " not in: " << complaint;
    at = found;
  }
}

TEST(Config, AMissingFileIsAnError) {
  DaemonConfig config;
  EXPECT_THROW(ReadConfigFile("/dev/null/absent.toml", &config), ConfigError);
}

TEST_F(DaemonTest, ParametersOfTheFileAreInForce) {
  config.parameters.emplace_back("object.friction", Vector3d(0.6, 0, 0));
  Start();
  EXPECT_EQ(Connect()->Result("truth")["object"]["friction"], 0.6);
}

TEST(Reload, SetsAgainWhatANewPresetOverwrites) {
  DaemonConfig running;
  running.parameters = {{"gait.margin_min", Vector3d(0.05, 0, 0)},
                        {"object.friction", Vector3d(0.5, 0, 0)}};
  DaemonConfig wanted = running;
  EXPECT_TRUE(PlanReload(running, wanted).calls.empty());
  wanted.parameters.emplace_back("gait.preset", Vector3d(1, 0, 0));  // sorted after margin_min
  const ReloadPlan plan = PlanReload(running, wanted);
  ASSERT_EQ(plan.calls.size(), 2u);
  EXPECT_EQ(plan.calls[0].params, JsonIn({{"name", "gait.preset"}, {"value", "paper"}}));
  EXPECT_EQ(plan.calls[1].params, JsonIn({{"name", "gait.margin_min"}, {"value", 0.05}}));
}

}  // namespace
}  // namespace regrasp::test
