// Latency of requests while the simulation runs at full speed: the daemon in this process, one
// client, round trips over its socket. The round trip bounds the daemon's own time from above.
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
  double RoundTrip(const std::string& method) {
    const std::string line = R"({"jsonrpc":"2.0","id":1,"method":")" + method + "\"}\n";
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

}  // namespace

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 2000;
  char name[] = "/tmp/regrasp-bench-XXXXXX";
  const std::string directory = ::mkdtemp(name);
  regrasp::DaemonConfig config;
  config.socket = directory + "/bench.sock";
  config.output_dir = directory;
  config.speed = "max";
  regrasp::Daemon daemon(config);
  std::thread thread([&] { daemon.Run(false); });
  {
    Client client(config.socket);
    client.RoundTrip("grasp");
    std::printf("%-10s %10s %10s %10s\n", "method", "median us", "p99 us", "max us");
    for (const char* method :
         {"version", "status", "contacts", "quality", "joints", "truth", "param.get", "describe"}) {
      std::vector<double> times;
      for (int i = 0; i < count; ++i) times.push_back(1e6 * client.RoundTrip(method));
      std::ranges::sort(times);
      std::printf("%-10s %10.1f %10.1f %10.1f\n", method, times[times.size() / 2],
                  times[times.size() * 99 / 100], times.back());
    }
  }
  daemon.Stop();
  thread.join();
  std::filesystem::remove_all(directory);
}
