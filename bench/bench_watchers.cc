// Do watchers disturb the simulation? A daemon in this process, in real time, holding the object;
// its lateness (how long after its due time a tick begins, 99th percentile of the last second)
// alone, and with sixteen subscribers at 50 Hz and one that subscribes to everything and never
// reads. The two states alternate, so that a slow spell of the machine hits both.
//   build/release/bin/bench_watchers [ROUNDS]        10 s a round

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "bench/connect.h"
#include "daemon/config/config.h"
#include "daemon/daemon.h"
#include "daemon/wire/json.h"

namespace regrasp {
namespace {

constexpr int kWatchers = 16, kSecondsPerState = 5;

class Client {
 public:
  explicit Client(const std::string& path) : fd_(regrasp::Connect(path)) {}
  ~Client() { ::close(fd_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  int fd() const { return fd_; }
  void Send(const std::string& method, const Json& params) const {
    const std::string line =
        Json({{"jsonrpc", "2.0"}, {"id", 1}, {"method", method}, {"params", params}}).dump() + "\n";
    if (::send(fd_, line.data(), line.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(line.size()))
      throw std::runtime_error("the daemon has gone");
  }
  Json Ask(const std::string& method, const Json& params = Json::object()) const {
    Send(method, params);
    std::string text;
    while (text.empty() || text.back() != '\n') {
      char chunk[65536];
      const auto got = ::recv(fd_, chunk, sizeof chunk, 0);
      if (got <= 0) throw std::runtime_error("the daemon has gone");
      text.append(chunk, static_cast<std::size_t>(got));
    }
    return Json::parse(text)["result"];
  }

 private:
  int fd_;
};

/// Sixteen that read what comes, in a thread of their own, and one that does not.
class Crowd {
 public:
  explicit Crowd(const std::string& path) : sleeper_(path) {
    for (const char* topic : {"status", "contacts", "quality", "joints", "truth", "events"})
      sleeper_.Send("subscribe", {{"topic", topic}, {"rate_hz", 100}});
    for (int i = 0; i < kWatchers; ++i) {
      watchers_.push_back(std::make_unique<Client>(path));
      watchers_.back()->Send("subscribe",
                             {{"topic", i % 2 ? "quality" : "contacts"}, {"rate_hz", 50}});
    }
    thread_ = std::thread([this] { Read(); });
  }
  ~Crowd() {
    stop_ = true;
    thread_.join();
  }
  std::size_t bytes() const { return bytes_; }

 private:
  void Read() {
    std::vector<pollfd> all;
    for (const auto& watcher : watchers_) all.push_back({watcher->fd(), POLLIN, 0});
    std::vector<char> chunk(1 << 16);
    while (!stop_) {
      if (::poll(all.data(), all.size(), 100) <= 0) continue;
      for (const pollfd& one : all)
        if (one.revents != 0)
          if (const auto got = ::recv(one.fd, chunk.data(), chunk.size(), MSG_DONTWAIT); got > 0)
            bytes_ += static_cast<std::size_t>(got);
    }
  }

  Client sleeper_;
  std::vector<std::unique_ptr<Client>> watchers_;
  std::atomic<bool> stop_{false};
  std::atomic<std::size_t> bytes_{0};
  std::thread thread_;
};

/// One value a second; the first second still holds ticks of the state before.
void Sample(const Client& client, std::vector<double>* lateness_us) {
  for (int i = 0; i <= kSecondsPerState; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));
    if (i > 0) lateness_us->push_back(1e6 * client.Ask("status")["lateness_p99_s"].get<double>());
  }
}

void Print(const char* state, std::vector<double>& us) {
  std::ranges::sort(us);
  std::printf("%-28s %8.0f %8.0f %8.0f\n", state, us.front(), us[us.size() / 2], us.back());
}

int Main(int rounds) {
  char name[] = "/tmp/regrasp-bench-XXXXXX";
  const std::string directory = ::mkdtemp(name);
  DaemonConfig config;
  config.socket = directory + "/bench.sock";
  config.output_dir = directory;
  Daemon daemon(config);
  std::thread thread([&] { daemon.Run(false); });
  std::vector<double> alone, watched;
  {
    const Client client(config.socket);
    const Json job = client.Ask("grasp");
    client.Ask("job.wait", {{"id", job["job"]}});
    for (int i = 0; i < rounds; ++i) {
      Sample(client, &alone);
      const Crowd crowd(config.socket);
      Sample(client, &watched);
      if (crowd.bytes() == 0) throw std::runtime_error("the watchers got nothing");
    }
  }
  std::printf("%-28s %8s %8s %8s\n", "lateness, p99 of a second", "least us", "median", "most");
  Print("alone", alone);
  Print("16 watchers, 1 that sleeps", watched);
  std::printf("the median moves by %.3f ms\n",
              1e-3 * (watched[watched.size() / 2] - alone[alone.size() / 2]));
  daemon.Stop();
  thread.join();
  std::filesystem::remove_all(directory);
  return 0;
}

}  // namespace
}  // namespace regrasp

int main(int argc, char** argv) { return regrasp::Main(argc > 1 ? std::atoi(argv[1]) : 6); }
