// What the programs of bench/ share: parameters as typed, trials in several processes, and when a
// rotation is completed.

#include "bench/settings.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

#include "bench/children.h"
#include "core/session/completed.h"

namespace regrasp {
namespace {

/// The value that `text` sets, or what is wrong with it.
std::string Read(const std::string& text) {
  try {
    const ParameterSetting setting = ReadSetting(text);
    return ParameterText(setting.info(), setting.value);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

TEST(Settings, AreWhatTheTableAllows) {
  EXPECT_EQ(Read("gait.lead=0.25"), "0.25");
  EXPECT_EQ(Read("gait.mode=exploring"), "exploring");
  EXPECT_EQ(Read("gait.mode=1"), "returning");
  EXPECT_EQ(Read("gait.hop=false"), "false");
  EXPECT_EQ(Read("gravity=0,-9.81,0"), "[0, -9.81, 0]");
  EXPECT_EQ(Read("gait.mode=7"), "gait.mode = 7: expected exploring or returning");
  EXPECT_EQ(Read("object.friction=2"), "object.friction = 2 is out of range; allowed: 0.001 ... 1");
  for (const char* bad : {"gait.mode=", "gait.mode=walk", "gait.lead=nan", "gait.lead=inf",
                          "gait.lead=1e9", "gait.lead=0.25x", "gait.lead=0.2,0.3", "gait.lead",
                          "gait.hop=2", "gravity=0,0", "gravity=0,0,", "gravity=9", "gate=1", "="})
    EXPECT_THROW(ReadSetting(bad), std::runtime_error) << bad;
}

TEST(Settings, PresetsGoFirst) {
  Parameters parameters;
  Apply({ReadSetting("gait.margin_min=0.05"), ReadSetting("gait.preset=paper")}, &parameters);
  EXPECT_EQ(parameters.gait.margin_min, 0.05);
  EXPECT_EQ(parameters.gait.mode, GaitMode::kExploring);
  EXPECT_FALSE(parameters.gait.plan);
}

/// In a process of its own, whose children are only these.
int StatusWithChild(void (*end)()) {
  const pid_t parent = fork();
  if (parent == 0) {
    for (int i = 0; i < 2; ++i)
      if (fork() == 0) {
        if (i == 0) end();
        _exit(0);
      }
    try {
      WaitForChildren();
    } catch (const std::runtime_error&) {
      _exit(1);
    }
    _exit(0);
  }
  int status = 0;
  waitpid(parent, &status, 0);
  return WEXITSTATUS(status);
}

TEST(Children, OneThatDiesIsNoticed) {
  EXPECT_EQ(StatusWithChild([] {}), 0);
  EXPECT_EQ(StatusWithChild([] { _exit(74); }), 1);
  EXPECT_EQ(StatusWithChild([] { raise(SIGKILL); }), 1);
}

TEST(Completed, MeansTheTrueAngle) {
  constexpr double kDegree = std::numbers::pi / 180, kTurn = 360 * kDegree;
  EXPECT_TRUE(TurnedAsAsked(kTurn, kTurn));
  EXPECT_TRUE(TurnedAsAsked(-356 * kDegree, -kTurn));
  EXPECT_FALSE(TurnedAsAsked(354 * kDegree, kTurn));
  EXPECT_FALSE(TurnedAsAsked(366 * kDegree, kTurn));
  EXPECT_FALSE(TurnedAsAsked(-kTurn, kTurn));
  EXPECT_FALSE(TurnedAsAsked(0, kTurn));
  EXPECT_FALSE(TurnedAsAsked(std::nan(""), kTurn));
}

}  // namespace
}  // namespace regrasp
