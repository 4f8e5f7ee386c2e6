#include "cli/print/progress_line.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace regrasp::cli {
namespace {

bool CanErase() {
  const char* term = std::getenv("TERM");
  const std::string_view name = term != nullptr ? term : "";
  return !name.empty() && name != "dumb";
}

std::size_t Columns() {
  winsize size{};
  const bool known = ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : 80;
}

/// The first `most` characters.
std::string Beginning(const std::string& text, std::size_t most) {
  std::size_t end = 0, count = 0;
  for (; end < text.size(); ++end)
    if ((static_cast<unsigned char>(text[end]) & 0xC0) != 0x80 && count++ == most) break;
  return text.substr(0, end);
}

}  // namespace

ProgressLine::ProgressLine(bool wanted)
    : on_(wanted && ::isatty(STDERR_FILENO) == 1 && CanErase()) {}

ProgressLine::~ProgressLine() {
  if (shown_) std::fputs("\r\x1b[K", stderr);
}

void ProgressLine::Show(const std::string& text) {
  if (!on_) return;
  // The last column stays free: a terminal may go to the next line after it.
  std::fputs(("\r\x1b[K" + Beginning(text, Columns() - 1)).c_str(), stderr);
  std::fflush(stderr);
  shown_ = true;
}

}  // namespace regrasp::cli
