#pragma once

/// What tests of the pictures share: a folder, a made-up run, and how it is drawn.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "snapshots/plots.h"
#include "tests/unit/snapshots/synthetic_run.h"

namespace regrasp {

/// A folder of this test, removed at its end.
class Snapshots : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(::testing::TempDir()) /
              (std::string("regrasp_snapshots_") + info->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string File(std::string_view name, const std::string& suffix = "") const {
    return (folder_ / name).string() + suffix;
  }

  const HandModel hand_ = SyntheticHand();
  const std::vector<Frame> run_ = SyntheticRun(6);
  const std::vector<Event> events_ = {{1000, EventKind::kContactMade, 0, 0, 0, "contact"},
                                      {2500, EventKind::kPush, -1, 0, 0, "push"}};
  const ObjectModel object_;
  std::filesystem::path folder_;
};

/// A drop at the end of the history; the last finger let go half a second before.
inline IncidentNote NoteOf(std::span<const Frame> history) {
  IncidentNote note;
  if (!history.empty()) note.tick = history.back().tick;
  note.time_s = 1e-3 * static_cast<double>(note.tick);
  note.cause = "Dropped while holding: a push, then three lost its contact first.";
  note.margin_limit = 0.1;
  note.drop_distance = 0.03;
  note.ends = {{2, note.time_s - 0.5, false}};
  return note;
}

/// A ball of 25 mm felt on the side of +x, by `off` too large [m].
inline FeltSurface FeltBall(double off) {
  FeltSurface felt;
  for (const Vector3d& way : {Vector3d(1, 0, 0), Vector3d(1, 0.3, 0.2), Vector3d(1, -0.3, 0.4)}) {
    const Vector3d u = way.normalized();
    felt.Add((0.025 + off) * u, u, 50);
  }
  return felt;
}

/// A history, or its newest frame, as every picture takes it.
inline PlotInput InputOf(std::span<const Frame> history, const PlotOptions& options = {}) {
  PlotInput input;
  input.frames.assign(history.begin(), history.end());
  input.events = {{1000, EventKind::kContactMade, 0, 0, 0, "contact"},
                  {2500, EventKind::kPush, -1, 0, 0, "push"}};
  input.explorations = {{input.frames, "", ""}, {input.frames, "", ""}};
  input.incident = NoteOf(history);
  input.felt = std::make_shared<FeltSurface>(FeltBall(0.0004));
  input.hand = SyntheticHand();
  input.options = options;
  return input;
}

inline void Draw(const PlotRow& plot, std::span<const Frame> history, const PlotOptions& options,
                 const std::string& path) {
  DrawPlot(plot.name, InputOf(history, options), path);
}

inline std::string ErrorOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

inline std::string Bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace regrasp
