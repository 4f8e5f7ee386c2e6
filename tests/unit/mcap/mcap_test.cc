// MCAP files written and read back by ourselves; tests/end_to_end/test_record.py reads them with
// the public @mcap/core.

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

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
    const auto a = writer.AddChannel("a", R"({"type":"object"})");
    const auto b = writer.AddChannel("b", R"({"type":"object"})");
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

TEST_F(Mcap, RefusesADamagedChunkAndWhatIsNoMcap) {
  WriteSome();
  std::string bytes = Bytes();
  bytes[bytes.find("{\"i\":5}") + 5] = '6';
  Replace(bytes);
  EXPECT_THROW(ReadMcap(path, [](const McapMessage&) {}), McapError);
  Replace("something else");
  EXPECT_THROW(ReadMcap(path, [](const McapMessage&) {}), McapError);
  EXPECT_THROW(ReadMcap(directory / "none", [](const McapMessage&) {}), McapError);
}

TEST_F(Mcap, NeverOverwrites) {
  WriteSome();
  EXPECT_THROW(McapWriter{path}, McapError);
}

}  // namespace
}  // namespace regrasp
