// Names and files that come from outside, and files that appear whole or not at all.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "core/files/draft.h"
#include "core/files/names.h"
#include "core/files/problem_list.h"
#include "core/files/read_file.h"
#include "core/files/toml_text.h"

namespace regrasp {
namespace {

namespace fs = std::filesystem;

class Files : public ::testing::Test {
 protected:
  Files() {
    char name[] = "/tmp/regrasp-files-XXXXXX";
    directory = ::mkdtemp(name);
  }
  ~Files() override {
    std::error_code ignored;
    fs::remove_all(directory, ignored);
  }
  std::size_t Count() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(directory), fs::directory_iterator()));
  }
  fs::path directory;
};

TEST(ProblemList, IsOneLineOrOneALineInTheOrderOfTheFile) {
  ProblemList list;
  EXPECT_TRUE(list.empty());
  list.Add("whole");
  EXPECT_EQ(list.Text(), "whole");
  list.Add(7, "f:7: b\x1b[2J\nc");
  list.Add(3, "f:3: a");
  list.Add(3, "f:3: a");
  EXPECT_EQ(list.Text(), "3 errors:\n  f:3: a\n  f:7: b\\x1b[2J\\x0ac\n  whole");
}

TEST(ProblemList, CountsWhatAreTooMany) {
  ProblemList list;
  for (int i = 1; i <= 60; ++i) list.Add(i, "f:" + std::to_string(i));
  EXPECT_EQ(list.count(), 60u);
  EXPECT_EQ(list.Messages().size(), 51u);
  EXPECT_EQ(list.Messages().back(), "and 10 more");
  list.Add(1, "f:1");  // told already
  ProblemList all("g: first");
  all.Add(list);
  EXPECT_EQ(all.Messages().size(), 51u);
  EXPECT_EQ(all.Messages()[49], "f:49");
  EXPECT_EQ(all.Messages().back(), "and 11 more");
}

TEST(Names, OfPeopleAreTaken) {
  for (const char* name : {"ring", "joint_0.0", "WRJ1", "Daumen (Kuppe)", "親指", "a b", "é"})
    EXPECT_EQ(NameFault(name), "") << name;
  for (const char* name : {"run-001.mcap", "büro.png", "a..b"})
    EXPECT_EQ(FileNameFault(name), "") << name;
}

TEST(Names, ThatDoHarmAreRefused) {
  const std::string nul("a\0b", 3);
  for (const std::string& name :
       {std::string(), std::string(kMaxNameBytes + 1, 'x'), nul, std::string("a\nb"),
        std::string("\x1b[2J"), std::string("\x7f"), std::string("\xc2\x85"),
        std::string("abc\xe2\x80\xaegnp.exe"), std::string("\xe2\x81\xa6x"),
        std::string("\xef\xbb\xbfx"), std::string("\xff"), std::string("\xc0\xaf"),
        std::string("\xed\xa0\x80"), std::string("\xe2\x80"), std::string("\xf4\x90\x80\x80")})
    EXPECT_NE(NameFault(name), "") << Shown(name);
  for (const char* name : {"../x", "/etc/passwd", "a/b", ".hidden", "..", ".", "-rf", "--help"})
    EXPECT_NE(FileNameFault(name), "") << name;
}

TEST(Names, AreShownWithoutWhatATerminalObeys) {
  EXPECT_EQ(Shown("a\x1b[2Jb"), "a\\x1b[2Jb");
  EXPECT_EQ(Shown(std::string(100, 'x')), std::string(64, 'x') + "...");
  EXPECT_EQ(Shown("hä nd"), "hä nd");
  EXPECT_EQ(Shown(std::string(63, 'x') + "ää"), std::string(63, 'x') + "...");
  EXPECT_EQ(ShownText("µ = 0.5\x1b[2J \xe2\x80\xae\xff\n"),
            "µ = 0.5\\x1b[2J \\xe2\\x80\\xae\\xff\\x0a");
}

TEST(Toml, IsRefusedWhereAParserWouldRecurseTooDeep) {
  const std::string deep(33, '['), dots = "a" + std::string(33, '.') + "b";
  std::string key = "a";
  for (int i = 0; i < 33; ++i) key += " . \"b.c\"";
  for (const std::string& text :
       {"a = " + deep, key + " = 1", "[" + key + "]", "a = {" + key + " = 1}", "a = '\\' " + deep,
        "a = [\"\"\"\n\"\"\", " + deep, "a = '''\n'''' " + deep, "a = \"\\\"\" " + deep,
        "# " + dots + "\n" + key, "a = \"\n" + deep})
    EXPECT_EQ(TomlFault(text), "nested deeper than 32") << text;
  for (const std::string& text :
       {"a = \"" + deep + dots + "\"", "a = '" + deep + dots + "' # " + deep,
        "a = '''\n\"" + deep + dots + "''''", "a = \"\"\"\n\\\"\"\"\\\"" + deep + "\"\"\"",
        "# " + dots, std::string("a = [1.5, 2.5,\n 3.5]\n[b.c]\nd = 1.5\n")})
    EXPECT_EQ(TomlFault(text), "") << text;
  EXPECT_EQ(TomlFault(std::string("a\0", 2)), "the file holds a zero byte");
  EXPECT_EQ(ReadTomlText("/dev/null"), "");
  EXPECT_THROW(ReadTomlText("/dev/zero"), std::runtime_error);
}

TEST_F(Files, AppearWholeOrNotAtAll) {
  const std::string target = directory / "a.txt";
  {
    Draft draft(target, Draft::Existing::kKeep);
    std::ofstream(draft.path()) << "half";
    EXPECT_FALSE(fs::exists(target));
  }
  EXPECT_EQ(Count(), 0u);
  WriteWhole(target, "whole", Draft::Existing::kKeep);
  EXPECT_EQ(ReadRegularFile(target, 100), "whole");
  EXPECT_THROW(WriteWhole(target, "other", Draft::Existing::kKeep), std::runtime_error);
  EXPECT_EQ(ReadRegularFile(target, 100), "whole");
  WriteWhole(target, "other", Draft::Existing::kReplace);
  EXPECT_EQ(ReadRegularFile(target, 100), "other");
  EXPECT_EQ(Count(), 1u);
}

TEST_F(Files, OfWritersThatCannotBeAskedStayForADay) {
  const pid_t gone = fork();
  if (gone == 0) _exit(0);
  ASSERT_EQ(waitpid(gone, nullptr, 0), gone);
  const Draft ours((directory / "a.txt").string(), Draft::Existing::kKeep);
  std::string killed = fs::path(ours.path()).filename().string();
  killed.replace(7, killed.find('-', 7) - 7, std::to_string(gone));  // .draft-PID-...
  const std::string elsewhere = ".draft-" + std::to_string(gone) + "-12345-1.txt";
  const std::string old = ".draft-" + std::to_string(gone) + "-12345-2.txt";
  for (const std::string& name : {killed, elsewhere, old})
    std::ofstream(directory / name) << "half";
  fs::last_write_time(directory / old, fs::file_time_type::clock::now() - std::chrono::hours(25));
  RemoveAbandonedDrafts(directory.string());
  EXPECT_FALSE(fs::exists(directory / killed));
  EXPECT_FALSE(fs::exists(directory / old));
  EXPECT_TRUE(fs::exists(directory / elsewhere));
}

TEST_F(Files, DoNotTakeANameThatWasTakenMeanwhile) {
  const std::string target = directory / "a.txt";
  Draft draft(target, Draft::Existing::kKeep);
  std::ofstream(draft.path()) << "late";
  std::ofstream(target) << "first";
  EXPECT_THROW(draft.Commit(), std::runtime_error);
  EXPECT_EQ(ReadRegularFile(target, 100), "first");
}

TEST_F(Files, ReplaceALinkInsteadOfFollowingIt) {
  const std::string victim = directory / "victim", link = directory / "link";
  std::ofstream(victim) << "mine";
  fs::create_symlink(victim, link);
  WriteWhole(link, "new", Draft::Existing::kReplace);
  EXPECT_EQ(ReadRegularFile(victim, 100), "mine");
  EXPECT_FALSE(fs::is_symlink(link));
}

TEST_F(Files, LeaveNothingWhereTheDiskIsFull) {
  // The limit on a file's size stands for a full disk; in a child, because it cannot be taken back.
  const std::string target = directory / "big";
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{1000, 1000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    try {
      WriteWhole(target, std::string(5000, 'x'), Draft::Existing::kKeep);
    } catch (const std::runtime_error& e) {
      ::_exit(std::string(e.what()).find("too large") != std::string::npos ? 0 : 2);
    }
    ::_exit(1);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(Count(), 0u);
}

TEST_F(Files, OfOtherKindsAreNotWaitedFor) {
  const std::string pipe = directory / "pipe", zero = directory / "zero";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  fs::create_symlink("/dev/zero", zero);
  for (const std::string& path : {pipe, zero, directory.string(), (directory / "none").string()})
    EXPECT_THROW(ReadRegularFile(path, 1000), std::runtime_error) << path;
  const std::string big = directory / "big";
  std::ofstream(big) << std::string(2000, 'x');
  EXPECT_THROW(ReadRegularFile(big, 1000), std::runtime_error);
  EXPECT_EQ(ReadRegularFile(big, 1000, 10), "xxxxxxxxxx");
}

}  // namespace
}  // namespace regrasp
