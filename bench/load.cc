// A daemon under load, from outside: requests per second, latencies, wrong answers, whether the
// simulation keeps real time, and whether clients that come and go leave anything behind.
//   bench/load.sh [BIN]                    starts a daemon and runs all of it
//   load SOCKET clients [COUNT] [SECONDS]  so many clients, each with one request open, mixed
//   load SOCKET connects [COUNT]           connect, ask, leave
//   load SOCKET alone [COUNT] [REDIS]      one client: status, and PING of a redis-server's socket

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/connect.h"

namespace {

using Clock = std::chrono::steady_clock;

double Since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// What is asked, in proportion to `weight`, and what an answer must hold.
struct Request {
  int weight;
  bool read;
  const char *method, *params, *holds;
};
constexpr Request kMix[] = {
    {30, true, "status", "", "\"state_hash\":\""},
    {15, true, "contacts", "", "\"fingers\":{"},
    {15, true, "joints", "", "\"tick\":"},
    {10, true, "quality", "", "\"stability\":"},
    {10, true, "truth", "", "\"p_WO_m\":["},
    {5, true, "version", "", "\"protocol\":"},
    {5, true, "job.list", "", "\"jobs\":["},
    {5, true, "events", R"({"count":20})", "\"events\":["},
    {2, false, "push", R"({"force_n":[0,0,0.01],"duration_s":0.01})", "\"duration_s\":"},
    {2, false, "param.set", R"({"name":"object.friction","value":0.5})", "\"name\":"},
    {1, false, "noise.set", R"({"preset":"paper"})", "\"position_m\":"},
};

std::string Line(std::uint64_t id, std::string_view method, std::string_view params) {
  std::string line = R"({"jsonrpc":"2.0","id":)" + std::to_string(id) + R"(,"method":")";
  line += method;
  line += params.empty() ? "\"}\n" : "\",\"params\":" + std::string(params) + "}\n";
  return line;
}

class Client {
 public:
  explicit Client(const std::string& path) : fd_(regrasp::Connect(path)) {}
  Client(Client&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  ~Client() {
    if (fd_ >= 0) ::close(fd_);
  }

  void Send(std::string_view line) const {
    if (::send(fd_, line.data(), line.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(line.size()))
      throw std::runtime_error("the daemon has gone");
  }
  /// Takes in what has come; true when it ends a line.
  bool Receive() {
    char chunk[65536];
    const auto got = ::recv(fd_, chunk, sizeof chunk, 0);
    if (got <= 0) throw std::runtime_error("the daemon has gone");
    text.append(chunk, static_cast<std::size_t>(got));
    return text.back() == '\n';
  }
  const std::string& Ask(std::string_view line) {
    text.clear();
    Send(line);
    while (!Receive()) {
    }
    return text;
  }
  int fd() const { return fd_; }
  pid_t peer() const {
    ucred credentials{};
    socklen_t size = sizeof credentials;
    ::getsockopt(fd_, SOL_SOCKET, SO_PEERCRED, &credentials, &size);
    return credentials.pid;
  }

  std::string text;  ///< of the answer so far
  const Request* open = nullptr;
  std::uint64_t id = 0;
  Clock::time_point asked;

 private:
  int fd_;
};

double Number(const std::string& answer, std::string_view key) {
  const auto at = answer.find("\"" + std::string(key) + "\":");
  if (at == std::string::npos) throw std::runtime_error("no " + std::string(key) + ": " + answer);
  return std::strtod(answer.c_str() + at + key.size() + 3, nullptr);
}

double At(std::vector<double>* times, double quantile) {
  if (times->empty()) return 0;
  std::ranges::sort(*times);
  return (*times)[static_cast<std::size_t>(quantile * static_cast<double>(times->size() - 1))];
}

struct Process {
  long resident_kb = 0;
  std::size_t descriptors = 0;
};
Process Look(pid_t pid) {
  Process process;
  const std::string directory = "/proc/" + std::to_string(pid);
  std::ifstream status(directory + "/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmRSS:")) process.resident_kb = std::atol(line.c_str() + 6);
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(directory + "/fd"))
    ++process.descriptors;
  return process;
}

/// Sends the next request of the mix.
void AskNext(Client* client, std::mt19937_64* random) {
  int weight = 0;
  for (const Request& request : kMix) weight += request.weight;
  int drawn = std::uniform_int_distribution<int>(0, weight - 1)(*random);
  const Request* request = kMix;
  while (drawn >= request->weight) drawn -= request++->weight;
  client->open = request;
  client->text.clear();
  client->asked = Clock::now();
  client->Send(Line(++client->id, request->method, request->params));
}

struct Counts {
  std::uint64_t answers = 0, wrong = 0, busy = 0;
  std::vector<double> reads, writes;  ///< round trips [s]
};

void Take(const Client& client, Counts* counts) {
  ++counts->answers;
  (client.open->read ? counts->reads : counts->writes).push_back(Since(client.asked));
  const std::string begin = R"({"jsonrpc":"2.0","id":)" + std::to_string(client.id) + ",\"";
  const bool ours = client.text.starts_with(begin);
  const bool busy = !client.open->read && client.text.find("\"code\":-32001") != std::string::npos;
  counts->busy += busy;
  if (ours && (busy || client.text.find(client.open->holds) != std::string::npos)) return;
  if (++counts->wrong <= 5)
    std::fprintf(stderr, "wrong: %s: %.300s\n", client.open->method, client.text.c_str());
}

bool Clients(const std::string& path, int count, double seconds) {
  Client watcher(path);
  std::vector<Client> clients;
  std::mt19937_64 random(1);
  for (int i = 0; i < count - 1; ++i) clients.emplace_back(path);
  const std::string before = watcher.Ask(Line(1, "status", ""));
  const auto start = Clock::now();
  Counts counts;
  std::vector<pollfd> ready;
  for (Client& client : clients) {
    ready.push_back({client.fd(), POLLIN, 0});
    AskNext(&client, &random);
  }
  while (Since(start) < seconds) {
    ::poll(ready.data(), ready.size(), 1000);
    for (std::size_t i = 0; i < clients.size(); ++i) {
      if (ready[i].revents == 0 || !clients[i].Receive()) continue;
      Take(clients[i], &counts);
      AskNext(&clients[i], &random);
    }
  }
  const double elapsed = Since(start);
  const std::string after = watcher.Ask(Line(2, "status", ""));
  std::printf(
      "%d clients, %.1f s: %.0f requests/s, %llu wrong, %llu writes refused as busy\n"
      "  reads: median %.2f ms, p99 %.2f ms, longest %.1f ms; writes: p99 %.2f ms\n"
      "  simulation at %.4f of real time\n",
      count, elapsed, static_cast<double>(counts.answers) / elapsed,
      static_cast<unsigned long long>(counts.wrong), static_cast<unsigned long long>(counts.busy),
      1e3 * At(&counts.reads, 0.5), 1e3 * At(&counts.reads, 0.99), 1e3 * At(&counts.reads, 1),
      1e3 * At(&counts.writes, 0.99),
      (Number(after, "time_s") - Number(before, "time_s")) / elapsed);
  return counts.wrong == 0;
}

void Connects(const std::string& path, int count) {
  Client watcher(path);
  const auto rounds = [&](int n) {
    for (int i = 0; i < n; ++i) {
      Client client(path);
      client.Ask(Line(1, "status", ""));
    }
    while (Number(watcher.Ask(Line(1, "status", "")), "clients") > 1) {
    }
  };
  rounds(500);  // what is kept for reuse
  const Process before = Look(watcher.peer());
  const auto start = Clock::now();
  rounds(count);
  const double elapsed = Since(start);
  const Process after = Look(watcher.peer());
  std::printf("%d connects: %.0f/s, memory %ld to %ld kB, descriptors %zu to %zu\n", count,
              count / elapsed, before.resident_kb, after.resident_kb, before.descriptors,
              after.descriptors);
}

void Alone(const std::string& path, int count, const std::string& redis) {
  const auto measure = [&](const char* name, const std::string& socket, const std::string& line) {
    Client client(socket);
    std::vector<double> times;
    for (int i = 0; i < count; ++i) {
      const auto start = Clock::now();
      client.Ask(line);
      times.push_back(Since(start));
    }
    std::printf("one client, %s: median %.1f us, p99 %.1f us\n", name, 1e6 * At(&times, 0.5),
                1e6 * At(&times, 0.99));
    return At(&times, 0.5);
  };
  const double status = measure("status", path, Line(1, "status", ""));
  measure("version", path, Line(1, "version", ""));
  if (redis.empty()) return;
  const double ping = measure("redis PING", redis, "PING\r\n");
  std::printf("status takes %.2f times as long as redis PING\n", status / ping);
}

}  // namespace

int main(int argc, char** argv) {
  const auto word = [&](int i) { return std::string(argc > i ? argv[i] : ""); };
  const auto number = [&](int i, double otherwise) {
    return argc > i ? std::atof(argv[i]) : otherwise;
  };
  const std::string path = word(1), what = word(2);
  try {
    if (what == "clients")
      return Clients(path, static_cast<int>(number(3, 64)), number(4, 60)) ? 0 : 1;
    if (what == "connects") return Connects(path, static_cast<int>(number(3, 10000))), 0;
    if (what == "alone") return Alone(path, static_cast<int>(number(3, 20000)), word(4)), 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "load: %s\n", e.what());
    return 1;
  }
  std::fprintf(stderr, "load SOCKET clients|connects|alone ...: see the head of bench/load.cc\n");
  return 2;
}
