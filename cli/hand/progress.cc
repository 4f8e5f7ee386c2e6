#include "cli/hand/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace regrasp::hand {

Progress::Progress(bool quiet) : quiet_(quiet), terminal_(::isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
  if (!quiet_ && terminal_ && percent_ >= 0) fmt::print(stderr, "\r{:60}\r", "");
}

void Progress::Show(const std::string& what, double done) {
  const int percent = static_cast<int>(100 * done);
  if (quiet_ || (percent == percent_ && what == what_)) return;
  if (!terminal_ && what == what_ && percent < percent_ + 20) return;
  percent_ = percent;
  what_ = what;
  fmt::print(stderr, "{}{} {:3d} %{}", terminal_ ? "\r" : "", what, percent,
             terminal_ ? "   " : "\n");
  std::fflush(stderr);
}

}  // namespace regrasp::hand
