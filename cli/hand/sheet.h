#pragma once

/// What `hand new` says of the scenario that it made.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "cli/hand/hand_command.h"
#include "cli/hand/trial.h"
#include "core/hand/model_report.h"
#include "core/posture/hand_guess.h"

namespace regrasp::hand {

struct Sheet {
  std::filesystem::path file, urdf;
  std::uint64_t seed = 0;  ///< of the search
  HandGuess guess;
  std::vector<std::string> left_out;  ///< names of fingers
  ModelReport report;
  Found best;
  bool ball = true;       ///< is what is held; otherwise an object that is laid into the grasp
  std::string ball_file;  ///< of a ball of its own, beside the scenario; empty: it ships
  double ball_mm = 0;     ///< across; of the one that stands for the object
  int ways = 0;           ///< to lay it in, that were tried

  /// A comment for the scenario: what the grasp is worth.
  std::string ScoreLine() const;
  Answer Tell() const;

 private:
  std::string StandIn() const;
  std::string Tried() const;
  Json Used() const;  ///< null where it was not tried
  std::vector<std::string> Remarks() const;
  void AddUseRemarks(std::vector<std::string>* remarks) const;
};

}  // namespace regrasp::hand
