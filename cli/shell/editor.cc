#include "cli/shell/editor.h"

#include <histedit.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <utility>

#include "cli/print/print.h"
#include "cli/shell/words.h"
#include "core/protocol/user_directories.h"

namespace regrasp::cli {

struct LineEditor::State {
  EditLine* edit = nullptr;
  History* history = nullptr;
  std::string history_file, prompt;
  Completer completer;
  bool interrupted = false;
};

namespace {

constexpr int kHistoryLines = 1000;

LineEditor::State& StateOf(EditLine* edit) {
  void* data = nullptr;
  ::el_get(edit, EL_CLIENTDATA, &data);
  return *static_cast<LineEditor::State*>(data);
}

/// The longest text with which all begin.
std::string CommonPrefix(const std::vector<std::string>& words) {
  std::string prefix = words.empty() ? "" : words.front();
  for (const auto& word : words) {
    const auto differ = std::mismatch(prefix.begin(), prefix.end(), word.begin(), word.end()).first;
    prefix.erase(differ, prefix.end());
  }
  return prefix;
}

char* Prompt(EditLine* edit) { return StateOf(edit).prompt.data(); }

/// The words in columns, as wide as the terminal.
void List(const std::vector<std::string>& words) {
  winsize size = {};
  ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size);
  int widest = 0;
  for (const auto& word : words) widest = std::max(widest, DisplayWidth(word));
  const int columns = std::max((size.ws_col > 0 ? size.ws_col : 80) / (widest + 2), 1);
  std::string text = "\n";
  for (std::size_t i = 0; i < words.size(); ++i) {
    text += words[i];
    const bool last = i + 1 == words.size() || static_cast<int>(i + 1) % columns == 0;
    text += last ? "\n"
                 : std::string(static_cast<std::size_t>(widest + 2 - DisplayWidth(words[i])), ' ');
  }
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);
}

unsigned char OnTab(EditLine* edit, int) {
  const LineInfo* info = ::el_line(edit);
  const std::string line(info->buffer, info->cursor);
  const auto [words, begin] = StateOf(edit).completer(line);
  if (words.empty()) return CC_REFRESH_BEEP;
  const bool sure = words.size() == 1;
  // A folder goes on; anything else that is sure is followed by a blank.
  std::string text = sure ? words.front() : CommonPrefix(words);
  const bool blank = sure && !text.ends_with('/');
  text = QuoteWord(text);
  if (!sure && text.ends_with('"')) text.pop_back();
  const std::string typed = line.substr(begin);
  if (text.empty() || text == "\"" || text == typed) {
    if (!sure) {
      List(words);
      return CC_REDISPLAY;
    }
  } else {
    ::el_deletestr(edit, static_cast<int>(typed.size()));
    ::el_insertstr(edit, text.c_str());
  }
  if (blank) ::el_insertstr(edit, " ");
  return CC_REFRESH;
}

unsigned char OnInterrupt(EditLine* edit, int) {
  StateOf(edit).interrupted = true;
  return CC_EOF;
}

unsigned char OnSuspend(EditLine* edit, int) {
  ::el_set(edit, EL_PREP_TERM, 0);
  std::raise(SIGTSTP);
  ::el_set(edit, EL_PREP_TERM, 1);
  return CC_REDISPLAY;
}

}  // namespace

LineEditor::LineEditor(std::string history_file, Completer completer)
    : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.history_file = std::move(history_file);
  s.completer = std::move(completer);
  s.edit = ::el_init("regrasp", stdin, stdout, stderr);
  ::el_set(s.edit, EL_CLIENTDATA, state_.get());
  ::el_set(s.edit, EL_EDITOR, "emacs");
  ::el_set(s.edit, EL_PROMPT, Prompt);
  // SIGTERM and the like give the terminal back; Ctrl-C and Ctrl-Z are keys while a line is typed.
  ::el_set(s.edit, EL_SIGNAL, 1);
  ::el_set(s.edit, EL_SETTY, "-d", "-isig", nullptr);
  ::el_set(s.edit, EL_ADDFN, "complete-word", "complete the word", OnTab);
  ::el_set(s.edit, EL_ADDFN, "interrupt", "drop the line", OnInterrupt);
  ::el_set(s.edit, EL_ADDFN, "suspend", "stop this program", OnSuspend);
  ::el_set(s.edit, EL_BIND, "^I", "complete-word", nullptr);
  ::el_set(s.edit, EL_BIND, "^C", "interrupt", nullptr);
  ::el_set(s.edit, EL_BIND, "^Z", "suspend", nullptr);
  ::el_set(s.edit, EL_BIND, "^R", "em-inc-search-prev", nullptr);
  ::el_set(s.edit, EL_BIND, "^L", "ed-clear-screen", nullptr);
  s.history = ::history_init();
  HistEvent event;
  ::history(s.history, &event, H_SETSIZE, kHistoryLines);
  ::history(s.history, &event, H_SETUNIQUE, 1);
  if (!s.history_file.empty()) ::history(s.history, &event, H_LOAD, s.history_file.c_str());
  ::el_set(s.edit, EL_HIST, ::history, s.history);
  ::el_source(s.edit, nullptr);  // the user's ~/.editrc
}

LineEditor::~LineEditor() {
  ::el_end(state_->edit);
  ::history_end(state_->history);
}

LineEditor::Result LineEditor::Read(const std::string& prompt, std::string* line) {
  State& s = *state_;
  s.prompt = prompt;
  s.interrupted = false;
  int count = 0;
  const char* text = ::el_gets(s.edit, &count);
  if (s.interrupted) {
    std::fputs("^C\n", stdout);
    std::fflush(stdout);
    return Result::kInterrupted;
  }
  if (text == nullptr || count <= 0) return Result::kEnd;
  line->assign(text, static_cast<std::size_t>(count));
  while (!line->empty() && (line->back() == '\n' || line->back() == '\r')) line->pop_back();
  if (line->find_first_not_of(" \t") == std::string::npos) return Result::kLine;
  HistEvent event;
  ::history(s.history, &event, H_ENTER, line->c_str());
  if (!s.history_file.empty()) {
    const mode_t before = ::umask(077);
    ::history(s.history, &event, H_SAVE, s.history_file.c_str());
    ::umask(before);
  }
  return Result::kLine;
}

std::string HistoryFile() {
  const char* named = std::getenv("REGRASP_HISTORY");
  if (named != nullptr && *named != '\0') return named;
  std::string folder = StateHome();
  if (folder.empty()) return "";
  folder += "/regrasp";
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  return error ? "" : folder + "/history";
}

}  // namespace regrasp::cli
