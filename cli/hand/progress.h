#pragma once

/// How far a search is, on standard error.

#include <string>

namespace regrasp::hand {

/// Progress on a terminal's last line, or a line per fifth elsewhere.
class Progress {
 public:
  explicit Progress(bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void Show(const std::string& what, double done);

 private:
  bool quiet_, terminal_;
  int percent_ = -1;
  std::string what_;
};

}  // namespace regrasp::hand
