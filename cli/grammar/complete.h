#pragma once

/// What may stand at the cursor of a command line: for the completion of shells, and of ours.

#include <functional>
#include <string>
#include <vector>

namespace regrasp::cli {

struct Candidate {
  std::string word, meaning;
};

struct Candidates {
  std::vector<Candidate> words;  ///< those that begin with what is typed
  bool files = false;            ///< a file name may stand here
  std::string suffix = {};       ///< of such files, "" for any; directories besides
};

/// The names that only a daemon knows for parameter `param` of `method` ("explore", "finger"); of
/// "param.get" the words that the control parameter `param` takes.
using AskNames =
    std::function<std::vector<std::string>(const std::string& method, const std::string& param)>;

/// Completes `current`, the word at the cursor, after `words` (without the program's name):
/// commands, options, and values out of the grammar; `ask` is called at most once. Never throws
/// what `ask` does not.
Candidates Complete(const std::vector<std::string>& words, const std::string& current,
                    const AskNames& ask);

/// How long completion waits for a daemon [s]: the user is waiting with a finger on Tab.
inline constexpr double kTabPatience = 0.15;

/// Names from the daemon at `socket` ("": the usual place), within `patience_s` from the call on;
/// none when there is no answer by then.
AskNames AskDaemon(const std::string& socket, double patience_s = kTabPatience);

/// `regrasp __complete WORD… CURRENT`, for the scripts of CompletionScript(): a line
/// "WORD\tMEANING" each; the line ":files", with the suffix that it has, when a file may stand
/// there.
std::string CompletionLines(const std::vector<std::string>& arguments);

}  // namespace regrasp::cli
