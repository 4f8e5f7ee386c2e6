#pragma once

/// How far a search is, on standard error.

#include <string>

#include "cli/print/progress_line.h"

namespace regrasp::hand {

/// Progress on a terminal's last line, or a line per fifth elsewhere.
class Progress {
 public:
  explicit Progress(bool quiet);
  void Show(const std::string& what, double done);

 private:
  bool quiet_;
  cli::ProgressLine line_;
  int percent_ = -1;
  std::string what_;
};

}  // namespace regrasp::hand
