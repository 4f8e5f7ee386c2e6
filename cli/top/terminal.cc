#include "cli/top/terminal.h"

// Without the macros named like everyday words (clear, move, …).
#define NCURSES_NOMACROS
#define NCURSES_WIDECHAR 1
#include <curses.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <string>

#include "cli/client/errors.h"

namespace regrasp::cli {
namespace {

struct Look {
  attr_t attributes;
  short color;
};

/// The look of an ink; colours by their number in the terminal's own palette, -1: none.
Look LookOf(Ink ink) {
  switch (ink) {
    case Ink::kPlain:
      return {A_NORMAL, -1};
    case Ink::kBold:
      return {A_BOLD, -1};
    case Ink::kDim:
      return {A_DIM, -1};
    case Ink::kTitle:
      return {A_BOLD, COLOR_CYAN};
    case Ink::kGood:
      return {A_NORMAL, COLOR_GREEN};
    case Ink::kWarn:
      return {A_NORMAL, COLOR_YELLOW};
    case Ink::kBad:
      return {A_BOLD, COLOR_RED};
    case Ink::kBadge:
      return {A_BOLD | A_REVERSE, COLOR_GREEN};
    case Ink::kBadBadge:
      return {A_BOLD | A_REVERSE, COLOR_RED};
    default: {
      constexpr short kCurves[kCurveInks] = {COLOR_BLUE, COLOR_GREEN, COLOR_YELLOW, COLOR_MAGENTA,
                                             COLOR_CYAN};
      return {A_NORMAL, kCurves[static_cast<int>(ink) - static_cast<int>(Ink::kCurve)]};
    }
  }
}

}  // namespace

struct FullScreen::State {
  FILE* out = nullptr;  ///< the terminal, on a file descriptor of our own
  SCREEN* screen = nullptr;
  WINDOW* keys = nullptr;  ///< keys are read through it: a pad, which reading does not draw
  int memory = -1;         ///< takes what ncurses writes while it draws
  bool color = false;
};

FullScreen::FullScreen(bool color) : state_(nullptr) {
  if (::isatty(STDIN_FILENO) != 1 || ::isatty(STDOUT_FILENO) != 1) {
    throw CliError(kUsage, "top needs a terminal for input and output",
                   "regrasp status, or regrasp watch status");
  }
  state_ = new State;
  state_->memory = ::memfd_create("frame", MFD_CLOEXEC);
  state_->out = ::fdopen(::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3), "w");
  if (state_->memory >= 0 && state_->out != nullptr)
    state_->screen = ::newterm(nullptr, state_->out, stdin);
  if (state_->screen == nullptr) {
    Free();
    throw CliError(kUsage, "the terminal type in $TERM is unknown here",
                   "TERM=xterm regrasp top, or regrasp status");
  }
  if (::tigetstr("cup") == nullptr) {
    ::endwin();
    Free();
    throw CliError(kUsage, "the terminal in $TERM cannot place the cursor: no full screen",
                   "regrasp status, or regrasp watch status");
  }
  ::cbreak();
  ::noecho();
  ::nonl();
  state_->keys = ::newpad(1, 1);
  ::keypad(state_->keys, TRUE);
  ::nodelay(state_->keys, TRUE);
  ::typeahead(-1);  // a picture is never left half drawn because a key came
  ::set_escdelay(25);
  ::curs_set(0);
  if (color && ::has_colors()) {
    ::start_color();
    const bool own = ::use_default_colors() == OK;
    for (short i = 0; i < 8; ++i)
      ::init_pair(static_cast<short>(i + 1), i, own ? static_cast<short>(-1) : COLOR_BLACK);
    state_->color = true;
  }
}

FullScreen::~FullScreen() {
  ::endwin();
  Free();
}

void FullScreen::Free() {
  if (state_->screen != nullptr) ::delscreen(state_->screen);
  if (state_->out != nullptr) std::fclose(state_->out);
  if (state_->memory >= 0) ::close(state_->memory);
  delete state_;
}

int FullScreen::rows() const { return getmaxy(stdscr); }
int FullScreen::columns() const { return getmaxx(stdscr); }

void FullScreen::Show(const Screen& screen) {
  ::werase(stdscr);
  for (int row = 0; row < screen.rows(); ++row) {
    for (int column = 0; column < screen.columns(); ++column) {
      const Cell& cell = screen.at(row, column);
      if (cell.glyph == U' ' && cell.ink == Ink::kPlain) continue;
      const Look look = LookOf(cell.ink);
      const wchar_t text[2] = {static_cast<wchar_t>(cell.glyph), 0};
      const short pair =
          state_->color && look.color >= 0 ? static_cast<short>(look.color + 1) : short{0};
      cchar_t character;
      ::setcchar(&character, text, look.attributes, pair, nullptr);
      ::mvwadd_wch(stdscr, row, column, &character);
    }
  }
  ::wnoutrefresh(stdscr);
  // ncurses writes a picture in pieces, which a terminal may show one by one. They are collected
  // and written at once. Ctrl-Z waits until the terminal itself is written to again.
  sigset_t stop, before;
  sigemptyset(&stop);
  sigaddset(&stop, SIGTSTP);
  sigprocmask(SIG_BLOCK, &stop, &before);
  const int fd = ::fileno(state_->out);
  ::dup2(state_->memory, fd);
  ::doupdate();
  ::dup2(STDOUT_FILENO, fd);
  sigprocmask(SIG_SETMASK, &before, nullptr);
  std::string frame(static_cast<std::size_t>(::lseek(state_->memory, 0, SEEK_CUR)), '\0');
  const ssize_t size = ::pread(state_->memory, frame.data(), frame.size(), 0);
  ::lseek(state_->memory, 0, SEEK_SET);
  for (std::size_t done = 0; size > 0 && done < static_cast<std::size_t>(size);) {
    const ssize_t n =
        ::write(STDOUT_FILENO, frame.data() + done, static_cast<std::size_t>(size) - done);
    if (n < 0 && errno != EINTR)
      throw CliError(kIo, std::string("cannot write to the terminal: ") + std::strerror(errno));
    if (n > 0) done += static_cast<std::size_t>(n);
  }
}

int FullScreen::Key() {
  while (true) {
    const int key = ::wgetch(state_->keys);
    if (key == ERR) return 0;
    // A new size of the window, or several that ended where they began, of which ncurses would see
    // no change: what the terminal still shows is unknown, so the next picture is drawn whole.
    if (key == KEY_RESIZE) ::clearok(curscr, TRUE);
    if (key < 256) return key;  // a function key: nothing to do here
  }
}

}  // namespace regrasp::cli
