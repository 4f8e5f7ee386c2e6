#pragma once

/// What tests of postures share: a folder for hands made up for them.

#include <gtest/gtest.h>

#include "core/posture/hand_guess.h"
#include "tests/unit/hand/model_files.h"
#include "tests/unit/posture/radial_hand.h"

namespace regrasp {

class PostureTest : public testing::Test {
 protected:
  PostureTest() {
    std::string name = (fs::temp_directory_path() / "regrasp_posture_XXXXXX").string();
    directory_ = mkdtemp(name.data());
  }
  ~PostureTest() override { fs::remove_all(directory_); }

  fs::path Write(const std::string& name, const std::string& text) const {
    const fs::path path = directory_ / name;
    std::ofstream(path) << text;
    return path;
  }
  static std::string WhyNot(const fs::path& file) {
    try {
      GuessHand(file);
    } catch (const ModelError& error) {
      return error.what();
    }
    return "";
  }

  fs::path directory_;
};

}  // namespace regrasp
