#include <gtest/gtest.h>

#include "cli/client/errors.h"
#include "cli/shell/words.h"

namespace regrasp::cli {
namespace {

using Words = std::vector<std::string>;

TEST(ShellWords, BlanksSeparateAndQuotesHold) {
  EXPECT_EQ(SplitWords("  grasp\t--wait \r"), (Words{"grasp", "--wait"}));
  EXPECT_EQ(SplitWords("plot quality -o 'a b.png'"), (Words{"plot", "quality", "-o", "a b.png"}));
  EXPECT_EQ(SplitWords(R"(call x "{\"a\": 1}")"), (Words{"call", "x", R"({"a": 1})"}));
  EXPECT_EQ(SplitWords(R"(a\ b 'c\d' e"f"'g')"), (Words{"a b", R"(c\d)", "efg"}));
  EXPECT_EQ(SplitWords("''"), (Words{""}));
}

TEST(ShellWords, CommentsBeginAtTheBeginningOfAWord) {
  EXPECT_EQ(SplitWords("# all of it"), Words{});
  EXPECT_EQ(SplitWords("stop # the rest"), (Words{"stop"}));
  EXPECT_EQ(SplitWords("a#b '#'"), (Words{"a#b", "#"}));
}

TEST(ShellWords, AQuoteNeedsItsEnd) {
  EXPECT_THROW(SplitWords("plot 'quality"), CliError);
  EXPECT_THROW(SplitWords("\""), CliError);
}

TEST(ShellWords, QuotingIsUndoneBySplitting) {
  for (const std::string word :
       {"plain", "two words", "", "it's", "say \"so\"", "back\\slash", "#1"})
    EXPECT_EQ(SplitWords(QuoteWord(word)), Words{word});
  EXPECT_EQ(QuoteWord("plain"), "plain");
}

TEST(ShellWords, TheWordBeingTypedIsApart) {
  const TypedWords open = SplitTyped("explore ri");
  EXPECT_EQ(open.words, (Words{"explore"}));
  EXPECT_EQ(open.last, "ri");
  EXPECT_EQ(open.last_begin, 8u);
  const TypedWords blank = SplitTyped("explore ");
  EXPECT_EQ(blank.words, (Words{"explore"}));
  EXPECT_EQ(blank.last, "");
  EXPECT_EQ(blank.last_begin, 8u);
  const TypedWords quoted = SplitTyped("evaluate \"my fi");
  EXPECT_EQ(quoted.last, "my fi");
  EXPECT_EQ(quoted.last_begin, 9u);
}

}  // namespace
}  // namespace regrasp::cli
