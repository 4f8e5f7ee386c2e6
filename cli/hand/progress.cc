#include "cli/hand/progress.h"

#include <fmt/format.h>

#include <cstdio>

namespace regrasp::hand {

Progress::Progress(bool quiet) : quiet_(quiet), line_(!quiet) {}

void Progress::Show(const std::string& what, double done) {
  const int percent = static_cast<int>(100 * done);
  if (quiet_ || (percent == percent_ && what == what_)) return;
  if (!line_.on() && what == what_ && percent < percent_ + 20) return;
  percent_ = percent;
  what_ = what;
  const std::string text = fmt::format("{} {:3d} %", what, percent);
  if (line_.on()) return line_.Show(text);
  fmt::print(stderr, "{}\n", text);
  std::fflush(stderr);
}

}  // namespace regrasp::hand
