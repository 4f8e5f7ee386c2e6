#include "cli/print/terminal_graphics.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string_view>

#include "cli/print/terminal_image.h"

namespace regrasp::cli {
namespace {

// For the terminal's answer, perhaps over a slow line, unless --timeout says so [s].
constexpr double kPatience = 1.0;

std::string Variable(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : "";
}

/// Keys are neither echoed nor kept for a line while this lives.
class RawInput {
 public:
  RawInput() {
    ::tcgetattr(STDIN_FILENO, &before_);
    termios raw = before_;
    raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    raw.c_cc[VMIN] = raw.c_cc[VTIME] = 0;
    ::tcsetattr(STDIN_FILENO, TCSANOW, &raw);
  }
  ~RawInput() { ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &before_); }
  RawInput(const RawInput&) = delete;
  RawInput& operator=(const RawInput&) = delete;

 private:
  termios before_ = {};
};

TerminalAnswer AskTerminal(double patience_s) {
  const std::string term = Variable("TERM");
  if (::isatty(STDIN_FILENO) != 1 || ::isatty(STDOUT_FILENO) != 1) return {};
  if (term.empty() || term == "dumb" || term == "linux") return {};  // would print the question
  const Interruptible interruptible;
  const RawInput raw;
  constexpr std::string_view kQuestion = "\x1b_Gi=31,s=1,v=1,a=q,t=d,f=24;AAAA\x1b\\\x1b[16t\x1b[c";
  if (::write(STDOUT_FILENO, kQuestion.data(), kQuestion.size()) < 0) return {};
  std::string text;
  const auto deadline = Deadline(patience_s);
  while (!ReadAnswer(text).complete && WaitFor(STDIN_FILENO, POLLIN, deadline)) {
    char chunk[256];
    const ssize_t n = ::read(STDIN_FILENO, chunk, sizeof chunk);
    if (n <= 0) break;
    text.append(chunk, static_cast<std::size_t>(n));
  }
  return ReadAnswer(text);
}

Graphics Choose(bool color, const TerminalAnswer& answer) {
  const std::string wish = Variable("REGRASP_GRAPHICS");
  if (wish == "kitty") return Graphics::kKitty;
  if (wish == "sixel") return Graphics::kSixel;
  if (wish == "blocks") return Graphics::kBlocks;
  if (wish == "dots") return Graphics::kDots;
  if (!wish.empty() && wish != "auto") {
    throw CliError(
        kUsage,
        fmt::format("$REGRASP_GRAPHICS '{}' is none of auto, kitty, sixel, blocks, dots", wish),
        "REGRASP_GRAPHICS=blocks regrasp plot quality --show");
  }
  if (answer.kitty) return Graphics::kKitty;
  if (answer.sixel) return Graphics::kSixel;
  return color ? Graphics::kBlocks : Graphics::kDots;
}

}  // namespace

TerminalAnswer ReadAnswer(const std::string& text) {
  TerminalAnswer answer;
  answer.kitty = text.find("\x1b_Gi=31;OK") != std::string::npos;
  for (auto at = text.find("\x1b["); at != std::string::npos; at = text.find("\x1b[", at + 1)) {
    const auto end = text.find_first_not_of("0123456789;?", at + 2);
    if (end == std::string::npos) break;
    const std::string body = text.substr(at + 2, end - at - 2);
    if (text[end] == 't')
      std::sscanf(body.c_str(), "6;%d;%d", &answer.cell_height, &answer.cell_width);
    if (text[end] == 'c' && body.starts_with('?')) {
      answer.complete = true;
      // Attribute 4 is sixel.
      answer.sixel = (body.substr(1) + ";").find(";4;") != std::string::npos;
    }
  }
  return answer;
}

std::string DrawPicture(Context& context, const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string png{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) {
    throw CliError(kIo, fmt::format("cannot read {}: {}", file, std::strerror(errno)),
                   "regrasp plot NAME -o FILE");
  }
  const Image image = DecodePng(png, file);
  const bool asked = Variable("REGRASP_GRAPHICS").empty() || Variable("REGRASP_GRAPHICS") == "auto";
  const TerminalAnswer answer =
      asked ? AskTerminal(context.options().timeout_s.value_or(kPatience)) : TerminalAnswer{};
  winsize window = {};
  ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &window);
  const int columns = window.ws_col > 0 ? window.ws_col : 80;
  const int rows =
      std::max((window.ws_row > 0 ? window.ws_row : 50) - 2, 1);  // the path and the prompt
  int cell_width = answer.cell_width, cell_height = answer.cell_height;
  if (cell_width <= 0 || cell_height <= 0) {
    cell_width = window.ws_xpixel > 0 ? window.ws_xpixel / columns : 10;
    cell_height = window.ws_ypixel > 0 ? window.ws_ypixel / (rows + 2) : 20;
  }
  const auto fitted = [&image](int width, int height) {
    const Size size = Fit(image, width, height);
    return Resize(image, size.width, size.height);
  };
  switch (Choose(context.out().color(), answer)) {
    case Graphics::kKitty: {
      const Size size = Fit(image, columns * cell_width, rows * cell_height);
      return Kitty(png, size.width < image.width ? std::max(size.width / cell_width, 1) : 0);
    }
    case Graphics::kSixel:
      return Sixel(fitted(columns * cell_width, rows * cell_height));
    case Graphics::kBlocks: {
      const std::string depth = Variable("COLORTERM");
      return HalfBlocks(fitted(columns, 2 * rows), depth == "truecolor" || depth == "24bit");
    }
    case Graphics::kDots:
      break;
  }
  return Dots(fitted(2 * columns, 4 * rows));
}

}  // namespace regrasp::cli
