#pragma once

#include <string>

namespace regrasp::cli {

/// One line on standard error that is written over, for a person who waits. None where that is no
/// terminal, or one that cannot erase a line ($TERM is dumb or not set).
class ProgressLine {
 public:
  explicit ProgressLine(bool wanted);
  /// Erases it.
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  bool on() const { return on_; }
  /// As much of `text`, plain UTF-8, as fits beside the others on one line of the terminal.
  void Show(const std::string& text);

 private:
  bool on_, shown_ = false;
};

}  // namespace regrasp::cli
