// Subscribes to what the controller senses and prints the force of every sample, until COUNT of
// them have come. C++20 and POSIX, no library.
//   regrasp up --speed max && g++ -std=c++20 watch.cc -o watch && ./watch [SOCKET [COUNT]]

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>

namespace {

class Connection {
 public:
  explicit Connection(const std::string& path) : fd_(::socket(AF_UNIX, SOCK_STREAM, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (path.size() >= sizeof address.sun_path) throw std::runtime_error("the path is too long");
    std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
    if (::connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
      throw std::runtime_error("cannot connect to " + path + ": " + std::strerror(errno));
  }
  ~Connection() { ::close(fd_); }

  void Send(const std::string& line) {
    if (::send(fd_, line.data(), line.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(line.size()))
      throw std::runtime_error("the daemon has gone");
  }
  std::string Line() {
    for (;;) {
      if (const auto end = buffer_.find('\n'); end != std::string::npos) {
        std::string line = buffer_.substr(0, end);
        buffer_.erase(0, end + 1);
        return line;
      }
      char chunk[65536];
      const ssize_t n = ::recv(fd_, chunk, sizeof chunk, 0);
      if (n <= 0) throw std::runtime_error("the daemon has gone");
      buffer_.append(chunk, static_cast<std::size_t>(n));
    }
  }

 private:
  int fd_;
  std::string buffer_;
};

/// $REGRASP_SOCKET, or the first that is there of the places where `regrasp up` puts it.
std::string FindSocket() {
  if (const char* named = std::getenv("REGRASP_SOCKET")) return named;
  const char* runtime = std::getenv("XDG_RUNTIME_DIR");
  for (const std::string& folder : {std::string(runtime ? runtime : "/run") + "/regrasp",
                                    "/tmp/regrasp-" + std::to_string(::getuid())}) {
    const std::string path = folder + "/regrasp.sock";
    if (::access(path.c_str(), F_OK) == 0) return path;
  }
  return std::string(runtime ? runtime : "/run") + "/regrasp/regrasp.sock";
}

/// The number after the first `key` from `at` on; `at` moves behind it. A real program would use a
/// JSON library.
double Number(const std::string& line, const std::string& key, std::size_t* at) {
  const auto found = line.find("\"" + key + "\":", *at);
  if (found == std::string::npos) throw std::runtime_error("no " + key + " in: " + line);
  *at = found + key.size() + 3;
  return std::strtod(line.c_str() + *at, nullptr);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string path = argc > 1 ? argv[1] : FindSocket();
  const int count = argc > 2 ? std::atoi(argv[2]) : 10;
  try {
    Connection connection(path);
    connection.Send(R"({"jsonrpc":"2.0","id":1,"method":"subscribe",)"
                    R"("params":{"topic":"contacts","rate_hz":20}})"
                    "\n");
    if (const std::string answer = connection.Line(); answer.find("\"sub\":") == std::string::npos)
      throw std::runtime_error("refused: " + answer);
    for (int i = 0; i < count; ++i) {
      const std::string line = connection.Line();
      std::size_t at = 0;
      std::printf("%8.3f s ", Number(line, "t_s", &at));
      for (at = line.find("\"fingers\""); line.find("\"force_n\":", at) != std::string::npos;)
        std::printf(" %6.3f N", Number(line, "force_n", &at));
      std::printf("\n");
    }
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "watch: %s\n", error.what());
    return 1;
  }
}
