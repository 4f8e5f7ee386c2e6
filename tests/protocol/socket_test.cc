// The socket in the file system (docs/protocol.md: Access).

#include "daemon/server/socket.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "tests/protocol/daemon_fixture.h"

namespace regrasp::test {
namespace {

ExitCode Refusal(const std::string& path) {
  try {
    const ListenSocket socket(path);
    return ExitCode::kOk;
  } catch (const SocketError& e) {
    return e.exit_code();
  }
}

unsigned Mode(const std::string& path) {
  struct stat info {};
  return ::stat(path.c_str(), &info) == 0 ? info.st_mode & 0777 : 0;
}

/// A socket file nobody listens on, as a killed daemon leaves it.
void LeaveStaleSocket(const std::string& path) {
  const int fd = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::snprintf(address.sun_path, sizeof address.sun_path, "%s", path.c_str());
  ASSERT_EQ(::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  ::close(fd);
}

TEST(ListenSocket, IsPrivateAndGoesAway) {
  const TemporaryDirectory directory;
  const std::string path = directory / "run/s.sock";
  {
    const ListenSocket socket(path);
    EXPECT_EQ(Mode(directory / "run"), 0700u);
    EXPECT_EQ(Mode(path), 0600u);
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(ListenSocket, TakesOverAStaleOne) {
  const TemporaryDirectory directory;
  const std::string path = directory / "s.sock";
  LeaveStaleSocket(path);
  ASSERT_TRUE(std::filesystem::exists(path));
  EXPECT_EQ(Refusal(path), ExitCode::kOk);
}

TEST(ListenSocket, HasOneOwner) {
  const TemporaryDirectory directory;
  const ListenSocket first(directory / "s.sock");
  EXPECT_EQ(Refusal(directory / "s.sock"), ExitCode::kRefused);
  EXPECT_TRUE(std::filesystem::exists(directory / "s.sock"));
}

TEST(ListenSocket, LeavesAloneWhatIsNotASocket) {
  const TemporaryDirectory directory;
  const std::string path = directory / "s.sock";
  std::ofstream(path) << "precious";
  EXPECT_EQ(Refusal(path), ExitCode::kIo);
  std::string text;
  std::ifstream(path) >> text;
  EXPECT_EQ(text, "precious");

  const std::string link = directory / "link.sock";
  std::filesystem::create_symlink(path, link);
  EXPECT_EQ(Refusal(link), ExitCode::kIo);
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  std::filesystem::create_directory(directory / "d.sock");
  EXPECT_EQ(Refusal(directory / "d.sock"), ExitCode::kIo);
}

TEST(ListenSocket, DoesNotRemoveWhatReplacedIt) {
  const TemporaryDirectory directory;
  const std::string path = directory / "s.sock";
  {
    const ListenSocket socket(path);
    std::filesystem::remove(path);
    std::ofstream(path) << "other";
  }
  EXPECT_TRUE(std::filesystem::is_regular_file(path));
}

TEST(ListenSocket, RefusesADirectoryOthersCanWrite) {
  const TemporaryDirectory directory;
  std::filesystem::create_directory(directory / "open");
  ::chmod((directory / "open").c_str(), 0777);
  EXPECT_EQ(Refusal(directory / "open/s.sock"), ExitCode::kPermission);
}

TEST(ListenSocket, RefusesAPathThatDoesNotFit) {
  EXPECT_EQ(Refusal("/tmp/" + std::string(120, 'x')), ExitCode::kUsage);
  EXPECT_EQ(Refusal(""), ExitCode::kUsage);
}

TEST_F(DaemonTest, TwoDaemonsNeedTwoSockets) {
  Start();
  EXPECT_THROW(Daemon(config, &limits), SocketError);
  EXPECT_EQ(Connect()->Error("status"), 0);
}

}  // namespace
}  // namespace regrasp::test
