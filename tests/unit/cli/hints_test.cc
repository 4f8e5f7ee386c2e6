// What an error advises is a command that the parser takes: every literal of the sources that
// begins with "regrasp " is parsed, but for those that are no whole command: with a part that is
// put in later ({}, %, or text after its end) or a place holder in capitals (FILE, NAME).

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "cli/client/errors.h"
#include "cli/grammar/grammar.h"
#include "cli/shell/words.h"

namespace regrasp::cli {
namespace {

namespace fs = std::filesystem;

struct Literal {
  std::string where;  ///< file
  std::string text;   ///< of all its parts
  bool whole;         ///< nothing is appended
};

/// Reads the literal whose opening quote is at `at`, with those that follow it at once.
Literal ReadLiteral(const std::string& where, const std::string& source, std::size_t at) {
  Literal literal{where, "", true};
  while (source[at] == '"') {
    for (++at; source[at] != '"'; ++at) {
      if (source[at] == '\\') ++at;
      literal.text += source[at];
    }
    at = source.find_first_not_of(" \n", at + 1);
  }
  literal.whole = source[at] != '+';
  return literal;
}

/// Every literal that begins with "regrasp ". The examples of the help are whole lines of a shell.
std::vector<Literal> Literals() {
  std::vector<Literal> literals;
  for (const char* part : {"core", "daemon", "cli", "snapshots"})
    for (const auto& entry :
         fs::recursive_directory_iterator(fs::path(REGRASP_SOURCE_DIR) / part)) {
      const std::string extension = entry.path().extension();
      if ((extension != ".cc" && extension != ".h") || entry.path().filename() == "examples.cc")
        continue;
      std::stringstream text;
      text << std::ifstream(entry.path()).rdbuf();
      const std::string source = text.str();
      for (auto at = source.find("\"regrasp "); at != std::string::npos;
           at = source.find("\"regrasp ", at + 1))
        literals.push_back(ReadLiteral(entry.path(), source, at));
    }
  return literals;
}

bool IsPlaceHolder(const std::string& word) {
  return word.size() > 1 && std::ranges::any_of(word, [](char c) { return std::isupper(c); }) &&
         std::ranges::none_of(word, [](char c) { return std::islower(c); });
}

/// The commands of a hint: "A, then B", "A, or B", "A    (why)"; what is not a command is prose.
std::vector<std::string> CommandsOf(std::string hint) {
  hint = hint.substr(0, hint.find("    ("));
  std::vector<std::string> commands;
  for (std::size_t begin = 0; begin < hint.size();) {
    const std::size_t end = std::min(hint.find(", ", begin), hint.size());
    std::string part = hint.substr(begin, end - begin);
    for (const std::string_view joint : {"then ", "or "})
      if (part.starts_with(joint)) part.erase(0, joint.size());
    if (part.starts_with("regrasp ")) commands.push_back(part);
    begin = end + 2;
  }
  return commands;
}

/// "" when the parser takes it.
std::string Refusal(const std::vector<std::string>& words) {
  std::vector<const char*> argv;
  for (const std::string& word : words) argv.push_back(word.c_str());
  GlobalOptions options;
  try {
    const Invocation invocation = Parse(static_cast<int>(argv.size()), argv.data(), &options);
    if (words[1] != "help" || words.size() == 2) return "";
    std::string about = words[2];
    for (std::size_t i = 3; i < words.size(); ++i) about += " " + words[i];
    return FindCommands(about).empty() ? "no such command" : "";
  } catch (const std::exception& error) {
    return error.what();
  }
}

TEST(Hints, AreCommandsThatTheParserTakes) {
  int parsed = 0;
  for (const Literal& literal : Literals()) {
    if (!literal.whole || literal.text.ends_with(' ') ||
        literal.text.find_first_of("{%") != std::string::npos)
      continue;
    for (const std::string& command : CommandsOf(literal.text)) {
      const std::vector<std::string> words = SplitWords(command);
      if (std::ranges::any_of(words, IsPlaceHolder)) continue;
      EXPECT_EQ(Refusal(words), "") << literal.where << ": " << literal.text;
      ++parsed;
    }
  }
  EXPECT_GT(parsed, 90);  // they are found at all
}

TEST(Hints, NameTheSocketThatWasNamed) {
  EXPECT_EQ(AtSocket("regrasp down, then regrasp up    (regrasp doctor)", "/s"),
            "regrasp -s /s down, then regrasp -s /s up    (regrasp -s /s doctor)");
  EXPECT_EQ(AtSocket("regrasp help up", "/s"), "regrasp help up");
  EXPECT_EQ(AtSocket("regrasp up", ""), "regrasp up");
  const std::string word = "'my regrasp runs/it'\\''s regrasp 1.mcap' (regrasp's)";
  EXPECT_EQ(AtSocket("regrasp replay " + word, "a b"), "regrasp -s 'a b' replay " + word);
}

TEST(Hints, AWrongOneIsRefused) {
  EXPECT_EQ(Refusal({"regrasp", "param", "set", "exploration.turn_axis", "0,0,-1"}), "");
  EXPECT_NE(Refusal({"regrasp", "param", "set", "exploration.turn_axis=0,0,-1"}), "");
  EXPECT_NE(Refusal({"regrasp", "rotate", "--angel", "20"}), "");
  EXPECT_NE(Refusal({"regrasp", "help", "turn"}), "");
  const std::vector<std::string> two = {"regrasp down", "regrasp up"};
  EXPECT_EQ(CommandsOf("regrasp down, then regrasp up    (of one version)"), two);
}

}  // namespace
}  // namespace regrasp::cli
