#include "cli/shell/words.h"

#include <fmt/format.h>

#include "cli/client/errors.h"

namespace regrasp::cli {
namespace {

bool Blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

struct Reader {
  std::vector<std::string> words;
  std::string word;
  bool in_word = false;
  char quote = 0;
  std::size_t word_begin = 0;

  explicit Reader(const std::string& line) {
    for (std::size_t i = 0; i < line.size(); ++i) {
      const char c = line[i];
      if (quote == 0 && Blank(c)) {
        if (in_word) Finish();
        continue;
      }
      if (quote == 0 && !in_word && c == '#') return;
      if (!in_word) word_begin = i;
      in_word = true;
      if (quote == 0 && (c == '\'' || c == '"')) {
        quote = c;
      } else if (c == quote) {
        quote = 0;
      } else if (c == '\\' && quote != '\'' && i + 1 < line.size()) {
        word += line[++i];
      } else {
        word += c;
      }
    }
  }
  void Finish() {
    words.push_back(std::move(word));
    word.clear();
    in_word = false;
  }
};

}  // namespace

std::vector<std::string> SplitWords(const std::string& line) {
  Reader reader(line);
  if (reader.quote != 0) {
    throw CliError(kUsage, fmt::format("a quote {} has no end", reader.quote),
                   fmt::format("{}{}", line, reader.quote));
  }
  if (reader.in_word) reader.Finish();
  return reader.words;
}

TypedWords SplitTyped(const std::string& line) {
  Reader reader(line);
  return {reader.words, reader.word, reader.in_word ? reader.word_begin : line.size()};
}

std::string QuoteWord(const std::string& word) {
  if (!word.empty() && word.find_first_of(" \t\r'\"\\#") == std::string::npos) return word;
  std::string quoted = "\"";
  for (const char c : word) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

}  // namespace regrasp::cli
