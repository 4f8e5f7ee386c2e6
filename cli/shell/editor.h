#pragma once

/// libedit, known to one file: a line typed by a user, with editing, history and completion.

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace regrasp::cli {

class LineEditor {
 public:
  /// What completion asks: candidates for the word under the cursor, given the line up to it, and
  /// the byte at which that word begins.
  struct Completion {
    std::vector<std::string> words;
    std::size_t begin = 0;
  };
  using Completer = std::function<Completion(const std::string& line)>;

  /// `history_file`: read now, written after each line; "": none.
  LineEditor(std::string history_file, Completer completer);
  ~LineEditor();
  LineEditor(const LineEditor&) = delete;
  LineEditor& operator=(const LineEditor&) = delete;

  enum class Result { kLine, kInterrupted, kEnd };
  /// Shows the prompt and reads a line (without its end). kInterrupted: Ctrl-C, the line is
  /// dropped; kEnd: Ctrl-D, or the terminal has gone.
  Result Read(const std::string& prompt, std::string* line);

  struct State;

 private:
  std::unique_ptr<State> state_;
};

/// $REGRASP_HISTORY, else regrasp/history in $XDG_STATE_HOME or ~/.local/state; "" without a home.
/// Makes the folder.
std::string HistoryFile();

}  // namespace regrasp::cli
