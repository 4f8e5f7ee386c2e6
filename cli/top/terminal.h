#pragma once

/// ncurses, known to one file: puts a Screen on the terminal and reads keys.

#include "cli/top/screen.h"

namespace regrasp::cli {

/// Takes the terminal over; gives it back as it was when destroyed, on every way out.
class FullScreen {
 public:
  /// Throws CliError(kUsage) when stdin or stdout is no terminal, or one that ncurses does not
  /// know.
  explicit FullScreen(bool color);
  ~FullScreen();
  FullScreen(const FullScreen&) = delete;
  FullScreen& operator=(const FullScreen&) = delete;

  int rows() const;
  int columns() const;
  /// Draws what differs from the last picture, in one write.
  void Show(const Screen& screen);
  /// A key that was pressed, without waiting: its character, 0 when there is none. A new size of
  /// the window is taken in here.
  int Key();

 private:
  void Free();

  struct State;
  State* state_;
};

}  // namespace regrasp::cli
