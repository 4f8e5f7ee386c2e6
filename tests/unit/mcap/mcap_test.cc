// MCAP files written and read back by ourselves; tests/end_to_end/test_record.py reads them with
// the public @mcap/core.

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

#include "core/mcap/mcap_format.h"
#include "core/mcap/mcap_reader.h"

namespace regrasp {
namespace {

namespace fs = std::filesystem;

class Mcap : public ::testing::Test {
 protected:
  Mcap() {
    char name[] = "/tmp/regrasp-mcap-XXXXXX";
    directory = ::mkdtemp(name);
    path = directory / "run.mcap";
  }
  ~Mcap() override { fs::remove_all(directory); }
  /// Three chunks of ten messages on two topics.
  void WriteSome() {
    McapWriter writer(path);
    const auto a = writer.AddChannel("a", "test.a", R"({"type":"object"})");
    const auto b = writer.AddChannel("b", "test.b", R"({"type":"object"})");
    for (int i = 0; i < 30; ++i) {
      writer.Write(i % 3 ? a : b, static_cast<std::uint64_t>(i),
                   "{\"i\":" + std::to_string(i) + "}");
      if (i % 10 == 9) {
        writer.Flush();
        flushed.push_back(writer.bytes());
      }
    }
    writer.Finish();
  }
  std::string Bytes() const {
    std::stringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
  }
  void Replace(const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

  fs::path directory, path;
  std::vector<std::uint64_t> flushed;
};

TEST_F(Mcap, GivesBackWhatWasWritten) {
  WriteSome();
  std::vector<std::string> found;
  const McapSummary summary = ReadMcap(path, [&](const McapMessage& message) {
    found.push_back(std::string(message.topic) + std::string(message.data));
    EXPECT_EQ(message.time, found.size() - 1);
    EXPECT_EQ(message.schema, R"({"type":"object"})");
  });
  EXPECT_TRUE(summary.complete);
  EXPECT_EQ(summary.messages, 30u);
  ASSERT_EQ(found.size(), 30u);
  EXPECT_EQ(found[3], "b{\"i\":3}");
  EXPECT_EQ(found[29], "a{\"i\":29}");
}

TEST_F(Mcap, TellsThatTheFileLostItsName) {
  const auto finish = [&](const std::function<void()>& change) {
    McapWriter writer(path);
    writer.Write(writer.AddChannel("a", "test.a", R"({"type":"object"})"), 1, "{}");
    change();
    writer.Finish();
  };
  EXPECT_THROW(finish([&] { fs::remove(path); }), McapError);
  EXPECT_THROW(finish([&] { fs::rename(path, directory / "other.mcap"); }), McapError);
  EXPECT_TRUE(ReadMcap(directory / "other.mcap", [](const McapMessage&) {}).complete);
  EXPECT_THROW(finish([&] {
                 fs::remove(path);
                 Replace("another file");
               }),
               McapError);
  fs::remove(path);
  EXPECT_NO_THROW(finish([&] {  // moved, and a link leads there
    fs::rename(path, directory / "there.mcap");
    fs::create_symlink(directory / "there.mcap", path);
  }));
}

TEST_F(Mcap, ReadsOnlyTheChunksThatAreWanted) {
  WriteSome();
  std::vector<std::uint64_t> times;
  const auto keep = [&](const McapMessage& message) { times.push_back(message.time); };
  const McapSummary summary = ReadMcap(path, keep, [](const McapChunk& chunk) {
    EXPECT_EQ(chunk.topics, (std::set<std::string, std::less<>>{"a", "b"}));
    EXPECT_EQ(chunk.end, chunk.start + 9);
    return chunk.start == 10;
  });
  ASSERT_EQ(times.size(), 10u);
  EXPECT_EQ(times.front(), 10u);
  EXPECT_TRUE(summary.complete && summary.lost.empty());
  // Damage in another chunk is not seen, in this one it is.
  std::string bytes = Bytes();
  bytes[bytes.find("{\"i\":15}") + 5] = '6';
  Replace(bytes);
  times.clear();
  EXPECT_EQ(ReadMcap(path, keep, [](const McapChunk& c) { return c.start == 0; }).lost.size(), 0u);
  EXPECT_EQ(ReadMcap(path, keep, [](const McapChunk& c) { return c.start == 10; }).lost.size(), 1u);
  EXPECT_EQ(times.size(), 10u);
  // Without an index all is read.
  Replace(bytes.substr(0, flushed.back()));
  times.clear();
  EXPECT_EQ(ReadMcap(path, keep, [](const McapChunk&) { return false; }).lost.size(), 1u);
  EXPECT_EQ(times.size(), 20u);
}

TEST_F(Mcap, CutOffAnywhereKeepsEveryFlushedMessage) {
  WriteSome();
  const std::string whole = Bytes();
  for (std::size_t size = 8; size < whole.size(); size += 7) {
    Replace(whole.substr(0, size));
    std::uint64_t expected = 0;
    for (const std::uint64_t end : flushed) expected += end <= size ? 10 : 0;
    const McapSummary summary = ReadMcap(path, [](const McapMessage&) {});
    // The index behind a chunk belongs to its flush, but a reader can do without.
    EXPECT_GE(summary.messages, expected) << size;
    EXPECT_LE(summary.messages, expected + 10) << size;
  }
}

TEST_F(Mcap, ReadsTheGoodChunksAndNamesTheBadOne) {
  WriteSome();
  std::string bytes = Bytes();
  const std::size_t at = bytes.find("{\"i\":15}");
  bytes[at + 5] = '6';
  Replace(bytes);
  std::vector<std::uint64_t> times;
  const McapSummary summary =
      ReadMcap(path, [&](const McapMessage& message) { times.push_back(message.time); });
  EXPECT_EQ(times.size(), 20u);
  EXPECT_EQ(times[10], 20u);
  EXPECT_TRUE(summary.complete);
  ASSERT_EQ(summary.lost.size(), 1u);
  const McapLoss& loss = summary.lost[0];
  EXPECT_LT(loss.offset, at);
  EXPECT_GT(loss.offset + loss.bytes, at);
  EXPECT_EQ(loss.start, 10u);
  EXPECT_EQ(loss.end, 19u);
  EXPECT_NE(LossText(loss).find("checksum"), std::string::npos);
}

TEST_F(Mcap, AChunkTakenOutOrPutInTwiceIsTold) {
  WriteSome();
  const std::string bytes = Bytes();
  const std::string chunk = bytes.substr(flushed[0], flushed[1] - flushed[0]);
  const auto cause = [&](const std::string& changed) {
    Replace(changed);
    const McapSummary summary = ReadMcap(path, [](const McapMessage&) {});
    return summary.lost.empty() ? "nothing" : summary.lost[0].cause;
  };
  EXPECT_EQ(cause(bytes), "nothing");
  EXPECT_EQ(cause(Bytes().erase(flushed[0], chunk.size())),
            "the file counts 30 messages, 20 were found");
  EXPECT_EQ(cause(std::string(bytes).insert(flushed[1], chunk)),
            "the file counts 30 messages, 40 were found");
}

TEST_F(Mcap, OneTurnedBitAnywhereCostsAtMostOneChunk) {
  WriteSome();
  const std::string whole = Bytes();
  const std::size_t behind_summary = whole.size() - 8 - 29;  // the footer
  for (std::size_t at = 8; at < whole.size(); ++at) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << (at % 8)));
    Replace(bytes);
    std::uint64_t found = 0;
    try {
      const McapSummary summary = ReadMcap(path, [&](const McapMessage& message) {
        ++found;
        EXPECT_LT(message.time, 30u);
      });
      EXPECT_GE(found, 20u) << at;
      // What is missing is told, wherever a whole file ends as one.
      if (found < 30 && at < behind_summary) {
        EXPECT_FALSE(summary.lost.empty()) << at;
      }
    } catch (const McapError& e) {
      FAIL() << at << ": " << e.what();
    }
  }
}

TEST_F(Mcap, ChunksInChunksAreDamage) {
  std::string chunks;
  for (int depth = 0; depth < 3; ++depth) {
    mcap::Bytes content, record;
    content.Add(std::uint64_t{0});
    content.Add(std::uint64_t{0});
    content.Add(static_cast<std::uint64_t>(chunks.size()));
    content.Add(std::uint32_t{0});  // no checksum
    content.AddText("");
    content.Add(static_cast<std::uint64_t>(chunks.size()));
    content.data += chunks;
    record.AddRecord(mcap::kChunk, content.data);
    chunks = record.data;
  }
  Replace(std::string(mcap::kMagic.begin(), mcap::kMagic.end()) + chunks);
  const McapSummary summary = ReadMcap(path, [](const McapMessage&) {});
  EXPECT_EQ(summary.messages, 0u);
  EXPECT_EQ(summary.lost.size(), 1u);
}

TEST_F(Mcap, RefusesWhatIsNoMcap) {
  Replace("something else");
  EXPECT_THROW(ReadMcap(path, [](const McapMessage&) {}), McapError);
  Replace("");
  EXPECT_THROW(ReadMcap(path, [](const McapMessage&) {}), McapError);
  EXPECT_THROW(ReadMcap(directory / "none", [](const McapMessage&) {}), McapError);
  EXPECT_THROW(ReadMcap(directory, [](const McapMessage&) {}), McapError);
  fs::remove(path);
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  EXPECT_THROW(ReadMcap(path, [](const McapMessage&) {}), McapError);
}

TEST_F(Mcap, WhatIsRefusedIsClosed) {
  const auto next_descriptor = [] {
    const int fd = ::dup(0);
    ::close(fd);
    return fd;
  };
  const int before = next_descriptor();
  for (int i = 0; i < 3; ++i)
    EXPECT_THROW(ReadMcap(directory, [](const McapMessage&) {}), McapError);
  EXPECT_EQ(next_descriptor(), before);
}

TEST_F(Mcap, NeverOverwrites) {
  WriteSome();
  EXPECT_THROW(McapWriter{path}, McapError);
}

}  // namespace
}  // namespace regrasp
