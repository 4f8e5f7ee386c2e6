#pragma once

/// A daemon in this process, on a socket in a fresh directory, and a client that waits with poll().

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "daemon/config/config.h"
#include "daemon/daemon.h"
#include "daemon/server/connection.h"
#include "daemon/wire/json.h"

namespace regrasp::test {

/// A directory of its own (0700), removed at the end.
class TemporaryDirectory {
 public:
  TemporaryDirectory() {
    char name[] = "/tmp/regrasp-test-XXXXXX";
    path_ = ::mkdtemp(name);
  }
  ~TemporaryDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  std::string operator/(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

class TestClient {
 public:
  explicit TestClient(const std::string& path) {
    fd_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::snprintf(address.sun_path, sizeof address.sun_path, "%s", path.c_str());
    if (::connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
      ADD_FAILURE() << "cannot connect to " << path;
  }
  ~TestClient() { ::close(fd_); }
  TestClient(const TestClient&) = delete;
  TestClient& operator=(const TestClient&) = delete;

  /// False when the peer has gone.
  bool Send(std::string_view bytes) {
    while (!bytes.empty()) {
      const auto sent = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
  }
  void FinishSending() { ::shutdown(fd_, SHUT_WR); }

  /// The next line, parsed; null at the end of the stream. Fails the test after 60 s of silence.
  Json Receive() {
    for (;;) {
      if (const auto end = buffer_.find('\n'); end != std::string::npos) {
        const Json message = Json::parse(buffer_.substr(0, end));
        buffer_.erase(0, end + 1);
        return message;
      }
      if (!Fill()) return nullptr;
    }
  }
  /// True when the stream ends (whatever still comes is thrown away).
  bool ReachesEnd() {
    while (Fill()) buffer_.clear();
    return ended_;
  }

  /// Sends a request and returns its whole answer; anything else that comes is a failure.
  Json Ask(const std::string& method, const Json& params = Json::object()) {
    const int id = ++last_id_;
    Send(Json({{"jsonrpc", "2.0"}, {"id", id}, {"method", method}, {"params", params}}).dump() +
         "\n");
    Json answer = Receive();
    EXPECT_EQ(answer.value("id", Json()), Json(id)) << answer.dump();
    return answer;
  }
  Json Result(const std::string& method, const Json& params = Json::object()) {
    const Json answer = Ask(method, params);
    EXPECT_TRUE(answer.contains("result")) << method << ": " << answer.dump();
    return answer.value("result", Json::object());
  }
  /// 0 when there was no error.
  int Error(const std::string& method, const Json& params = Json::object()) {
    const Json answer = Ask(method, params);
    return answer.contains("error") ? answer["error"]["code"].get<int>() : 0;
  }

 private:
  bool Fill() {
    pollfd descriptor{fd_, POLLIN, 0};
    if (::poll(&descriptor, 1, 60'000) != 1) {
      ADD_FAILURE() << "no answer within 60 s";
      return false;
    }
    char chunk[65536];
    const auto got = ::recv(fd_, chunk, sizeof chunk, 0);
    if (got <= 0) return ended_ = true, false;
    buffer_.append(chunk, static_cast<std::size_t>(got));
    return true;
  }

  int fd_ = -1;
  int last_id_ = 0;
  bool ended_ = false;
  std::string buffer_;
};

/// A paused daemon at --speed max unless a test changes `config` before Start().
class DaemonTest : public ::testing::Test {
 protected:
  DaemonTest() {
    config.socket = directory / "run/regrasp.sock";
    config.output_dir = directory / "out";
    config.speed = "max";
    config.paused = true;
  }
  ~DaemonTest() override { Finish(); }
  void Start() {
    daemon = std::make_unique<Daemon>(config, &limits);
    thread = std::thread([this] { daemon->Run(false); });
  }
  void Finish() {
    if (!daemon) return;
    daemon->Stop();
    thread.join();
    daemon.reset();
  }
  std::unique_ptr<TestClient> Connect() { return std::make_unique<TestClient>(config.socket); }

  TemporaryDirectory directory;
  DaemonConfig config;
  Limits limits;
  std::unique_ptr<Daemon> daemon;
  std::thread thread;
};

/// One with a client that steps it.
class SteppedDaemonTest : public DaemonTest {
 protected:
  void SetUp() override {
    Start();
    client = Connect();
  }
  Json Wait(const Json& job) { return client->Result("job.wait", {{"id", job}}); }
  void Step(int ticks) {
    const Json record = Wait(client->Result("step", {{"ticks", ticks}})["job"]);
    EXPECT_EQ(record["state"], "done") << record.dump();
  }

  std::unique_ptr<TestClient> client;
};

}  // namespace regrasp::test
