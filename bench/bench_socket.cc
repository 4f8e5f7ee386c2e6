// Latency of requests while the simulation runs at full speed: the daemon in this process, one
// client, round trips over its socket. The round trip bounds the daemon's own time from above. Then
// that of saving and restoring a checkpoint of a held ball and of a held mesh, in lockstep; saving
// waits for the disk.
//   build/release/bin/bench_socket [COUNT]

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "bench/connect.h"
#include "daemon/config/config.h"
#include "daemon/daemon.h"

namespace {

class Client {
 public:
  explicit Client(const std::string& path) : fd_(regrasp::Connect(path)) {}
  ~Client() { ::close(fd_); }

  /// Seconds from the request to the end of its answer.
  double RoundTrip(const std::string& method, const std::string& params = "{}") {
    const std::string line =
        R"({"jsonrpc":"2.0","id":1,"method":")" + method + R"(","params":)" + params + "}\n";
    const auto start = std::chrono::steady_clock::now();
    if (::send(fd_, line.data(), line.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(line.size()))
      throw std::runtime_error("the daemon has gone");
    char chunk[65536];
    for (;;) {
      const auto got = ::recv(fd_, chunk, sizeof chunk, 0);
      if (got <= 0) throw std::runtime_error("the daemon has gone");
      if (chunk[got - 1] == '\n') break;
    }
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }

 private:
  int fd_;
};

void Print(const std::string& name, std::vector<double> times_s) {
  std::ranges::sort(times_s);
  std::printf("%-24s %10.1f %10.1f %10.1f\n", name.c_str(), 1e6 * times_s[times_s.size() / 2],
              1e6 * times_s[times_s.size() * 99 / 100], 1e6 * times_s.back());
}

void Requests(const regrasp::DaemonConfig& config, int count) {
  regrasp::Daemon daemon(config);
  std::thread thread([&] { daemon.Run(false); });
  {
    Client client(config.socket);
    client.RoundTrip("grasp");
    for (const char* method :
         {"version", "status", "contacts", "quality", "joints", "truth", "param.get", "describe"}) {
      std::vector<double> times;
      for (int i = 0; i < count; ++i) times.push_back(client.RoundTrip(method));
      Print(method, std::move(times));
    }
  }
  daemon.Stop();
  thread.join();
}

void Checkpoints(regrasp::DaemonConfig config, const std::string& object, int count) {
  config.clock = "lockstep";
  config.object = object;
  regrasp::Daemon daemon(config);
  std::thread thread([&] { daemon.Run(false); });
  {
    Client client(config.socket);
    client.RoundTrip("grasp");
    client.RoundTrip("job.wait", R"({"id":1})");
    std::vector<double> saved, restored;
    for (int i = 0; i < count; ++i) {
      saved.push_back(client.RoundTrip("checkpoint.save", R"({"name":"held"})"));
      restored.push_back(client.RoundTrip("checkpoint.restore", R"({"name":"held"})"));
    }
    Print("save " + object, saved);
    Print("restore " + object, restored);
  }
  daemon.Stop();
  thread.join();
}

}  // namespace

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 2000;
  char name[] = "/tmp/regrasp-bench-XXXXXX";
  const std::string directory = ::mkdtemp(name);
  regrasp::DaemonConfig config;
  config.socket = directory + "/bench.sock";
  config.output_dir = directory;
  config.speed = "max";
  std::printf("%-24s %10s %10s %10s\n", "method", "median us", "p99 us", "max us");
  Requests(config, count);
  for (const char* object : {"sphere", "zoo_peanut_lying", "egg"})
    Checkpoints(config, object, std::max(1, count / 20));
  std::filesystem::remove_all(directory);
}
