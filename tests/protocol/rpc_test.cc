// Lines in, requests out, without a daemon.

#include "daemon/wire/rpc.h"

#include <gtest/gtest.h>

#include "core/protocol/methods.h"

namespace regrasp {
namespace {

struct Case {
  std::string line;
  int code;          // 0: accepted
  std::string note;  // why it is here
};

std::string Nested(int levels) {
  // The request object itself is one level, params the second.
  std::string deep;
  for (int i = 0; i < levels - 2; ++i) deep += "[";
  for (int i = 0; i < levels - 2; ++i) deep += "]";
  return R"({"jsonrpc":"2.0","id":1,"method":"status","params":{"x":)" + deep + "}}";
}

std::string Padded(std::size_t bytes) {
  const std::string head = R"({"jsonrpc":"2.0","id":1,"method":"status","params":{"x":")",
                    tail = "\"}}";
  return head + std::string(bytes - head.size() - tail.size(), 'x') + tail;
}

std::string Batch(int count) {
  std::string text = "[";
  for (int i = 0; i < count; ++i)
    text += std::string(i ? "," : "") + R"({"jsonrpc":"2.0","method":"x"})";
  return text + "]";
}

TEST(ParseLine, AcceptsAndRefusesWithTheRightCode) {
  const std::string ok = R"({"jsonrpc":"2.0","id":1,"method":"status"})";
  const std::vector<Case> cases = {
      {ok, 0, "plain"},
      {ok + "\r", 0, "carriage return"},
      {"  " + ok + "  ", 0, "spaces"},
      {R"({"jsonrpc":"2.0","id":"a","method":"status","params":{}})", 0, "string id"},
      {R"({"jsonrpc":"2.0","id":-9007199254740992,"method":"x"})", 0, "-2^53"},
      {R"({"jsonrpc":"2.0","id":9007199254740992,"method":"x"})", 0, "2^53"},
      {R"({"jsonrpc":"2.0","id":9007199254740993,"method":"x"})", -32600, "beyond 2^53"},
      {R"({"jsonrpc":"2.0","id":1.5,"method":"x"})", -32600, "fraction"},
      {R"({"jsonrpc":"2.0","id":null,"method":"x"})", -32600, "null id"},
      {R"({"jsonrpc":"2.0","id":true,"method":"x"})", -32600, "boolean id"},
      {R"({"jsonrpc":"2.0","id":[1],"method":"x"})", -32600, "array id"},
      {R"({"jsonrpc":"2.0","id":")" + std::string(64, 'i') + R"(","method":"x"})", 0, "64 bytes"},
      {R"({"jsonrpc":"2.0","id":")" + std::string(65, 'i') + R"(","method":"x"})", -32600,
       "65 bytes"},
      {R"({"id":1,"method":"x"})", -32600, "no version"},
      {R"({"jsonrpc":"1.0","id":1,"method":"x"})", -32600, "old version"},
      {R"({"jsonrpc":2.0,"id":1,"method":"x"})", -32600, "version as a number"},
      {R"({"jsonrpc":"2.0","id":1})", -32600, "no method"},
      {R"({"jsonrpc":"2.0","id":1,"method":7})", -32600, "method is a number"},
      {R"({"jsonrpc":"2.0","id":1,"method":"x","parms":{}})", -32600, "unknown member"},
      {R"({"jsonrpc":"2.0","id":1,"method":"x","params":[1]})", -32602, "positional"},
      {R"({"jsonrpc":"2.0","id":1,"method":"x","params":"a"})", -32602, "params is text"},
      {R"({"jsonrpc":"2.0","id":1,"method":"x","params":null})", -32602, "params is null"},
      {R"({"jsonrpc":"2.0","id":1,"method":"x","params":[]})", 0, "no parameters, as an array"},
      {R"({"jsonrpc":"2.0","id":1,"method":"x","method":"y"})", -32600, "duplicate member"},
      {R"({"jsonrpc":"2.0","id":1,"method":"x","params":{"a":1,"a":2}})", -32600,
       "duplicate parameter"},
      {R"({"jsonrpc":"2.0","id":1,"method":"x","params":{"a":1,"\u0061":2}})", -32600,
       "duplicate, escaped"},
      {R"({"jsonrpc":"2.0","id":1,"method":"x","params":{"a":{"b":1},"c":{"b":1}}})", 0,
       "same key, two objects"},
      {R"({"jsonrpc":"2.0","id":1,"method":"x","params":{"a":NaN}})", -32700, "NaN"},
      {R"({"jsonrpc":"2.0","id":1,"method":"x","params":{"a":Infinity}})", -32700, "Infinity"},
      {R"({"jsonrpc":"2.0","id":1,"method":"x","params":{"a":1e999}})", -32700, "overflow"},
      {"{", -32700, "cut off"},
      {"status", -32700, "not JSON"},
      {ok + ok, -32700, "two objects on a line"},
      {"\"\xff\"", -32700, "not UTF-8"},
      {"{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"\xc0\xaf\"}", -32700, "overlong UTF-8"},
      {std::string(1, '\0'), -32700, "a zero byte"},
      {"3", -32600, "a number"},
      {"[]", -32600, "empty batch"},
      {"[1]", -32600, "a batch of no request"},
      {Batch(32), 0, "a full batch"},
      {Batch(33), -32600, "batch too long"},
      {Nested(32), 0, "32 levels"},
      {Nested(33), -32600, "33 levels"},
      {std::string(60000, '['), -32600, "60000 levels, unclosed"},
      {R"({"jsonrpc":"2.0","id":1,"method":")" + std::string(40, '[') + "\"}", 0,
       "brackets in a string"},
      {Padded(kMaxRequestBytes), 0, "64 KiB"},
      {Padded(kMaxRequestBytes + 1), -32011, "one byte more"},
  };
  for (const Case& c : cases) {
    const RpcLine line = ParseLine(c.line);
    ASSERT_FALSE(line.requests.empty()) << c.note;
    const auto& error = line.requests.front().error;
    EXPECT_EQ(error ? static_cast<int>(error->code) : 0, c.code)
        << c.note << (error ? ": " + error->message : "");
  }
}

TEST(ParseLine, IgnoresBlankLines) {
  for (const char* blank : {"", "\r", "   ", " \t\r"})
    EXPECT_TRUE(ParseLine(blank).requests.empty());
}

TEST(ParseLine, KeepsTheIdOfABadRequestWhenItCanBeRead) {
  const RpcLine line =
      ParseLine(R"({"jsonrpc":"2.0","id":"k","method":"x","params":{"a":1,"a":2}})");
  ASSERT_TRUE(line.requests.front().id.has_value());
  EXPECT_EQ(std::get<std::string>(*line.requests.front().id), "k");
  // Which of two ids was meant cannot be known.
  EXPECT_FALSE(
      ParseLine(R"({"jsonrpc":"2.0","id":1,"id":2,"method":"x"})").requests.front().id.has_value());
}

TEST(ParseLine, NamesTheNearestMember) {
  const RpcLine line = ParseLine(R"({"jsonrpc":"2.0","id":1,"method":"x","parms":{}})");
  EXPECT_EQ(line.requests.front().error->hint, "did you mean 'params'?");
}

TEST(ToLine, WritesOneLineWhateverTheText) {
  const std::string line = ToLine(ErrorMessage({}, {ErrorCode::kIo, "bad\nname \xff", "", "", {}}));
  EXPECT_EQ(line.find('\n'), line.size() - 1);
  EXPECT_EQ(Json::parse(line)["id"], Json());
}

}  // namespace
}  // namespace regrasp
