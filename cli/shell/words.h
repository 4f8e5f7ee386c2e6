#pragma once

/// A line of the shell as words: blanks separate, '…' and "…" hold blanks, \ takes the next
/// character as it is (not inside '…'), # at the beginning of a word begins a comment.

#include <string>
#include <vector>

namespace regrasp::cli {

/// The words of a line; none for a blank line or a comment. Throws CliError(kUsage) for a quote
/// without its end.
std::vector<std::string> SplitWords(const std::string& line);

/// The line up to the cursor, for completion: the words that are finished, and the one that is
/// being typed (empty after a blank).
struct TypedWords {
  std::vector<std::string> words;
  std::string last;
  std::size_t last_begin = 0;  ///< byte at which the last word begins in the line
};
TypedWords SplitTyped(const std::string& line);

/// `word` as it must be typed to be read as one word.
std::string QuoteWord(const std::string& word);

}  // namespace regrasp::cli
