// Hands with a finger that holds but cannot be put elsewhere.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "core/hand/model_path.h"
#include "tests/physics/session_run.h"

namespace regrasp {
namespace {

constexpr int kRing = 2;

/// The Shadow hand whose ring finger keeps two of its four joints.
SessionConfig RingOfTwoJoints(std::uint64_t seed) {
  const std::string path = ::testing::TempDir() + "ring_of_two_joints.toml";
  const std::filesystem::path hands = FindModel("shadow", "hands", ModelSearchPath()).parent_path();
  std::ifstream scenario(hands / "shadow.toml");
  std::ofstream changed(path);
  changed << "urdf = " << (hands / "shadow.urdf") << '\n';
  for (std::string line; std::getline(scenario, line);)
    if (!line.starts_with("RFJ4") && !line.starts_with("RFJ1")) changed << line << '\n';
  changed << "[locked_deg]\nRFJ4 = 0\nRFJ1 = 30\n";
  changed.close();
  SessionConfig config;
  config.model = LoadScenario(path, "sphere", ModelSearchPath());
  config.parameters = DefaultParameters(config.model);
  config.noise = NoisePreset("paper").value();
  config.seed = seed;
  return config;
}

TEST(FewJoints, AFingerThatCannotBePutElsewhereStaysWhileOthersMay) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    SessionRun run(RingOfTwoJoints(seed));
    ASSERT_EQ(run.session.config().model.hand.fingers[kRing].joints.size(), 2u);
    ASSERT_TRUE(run.Grasp());
    run.Give(CommandType::kRotate, [](Command* command) {
      command->angle_rad = 20 * M_PI / 180;
      command->axis_W = -Vector3d::UnitZ();
    });
    std::set<int> left;  // or were about to: a landing was planned
    while (run.session.job_running() && run.session.tick() < 60'000) {
      run.Tick();
      const GaitFrame gait = run.Snapshot().gait;
      if (gait.active && gait.finger >= 0) left.insert(gait.finger);
    }
    EXPECT_EQ(run.Job().state, JobState::kDone) << run.Job().error;
    EXPECT_FALSE(left.empty());
    EXPECT_FALSE(left.contains(kRing));
  }
}

}  // namespace
}  // namespace regrasp
