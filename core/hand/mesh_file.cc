#include "core/hand/mesh_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <memory>
#include <optional>
#include <string>

#include "core/hand/mesh_child.h"
#include "core/hand/mesh_path.h"
#include "core/hand/mesh_text.h"
#include "core/hand/stl_file.h"

namespace regrasp {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 5> kSuffixes = {".obj", ".stl", ".ply", ".dae", ".glb"};

struct Descriptor {
  explicit Descriptor(int n) : number(n) {}
  ~Descriptor() { ::close(number); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number;
};

/// Ends and buries the child at the end of a scope.
class Child {
 public:
  explicit Child(pid_t pid) : pid_(pid) {}
  ~Child() {
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      Wait();
    }
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  int Wait() {
    int status = 0;
    while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    return status;
  }

 private:
  pid_t pid_;
};

[[noreturn]] void Fail(const fs::path& file, const std::string& message) {
  throw ModelError(fmt::format("{}: {}", file.string(), message));
}

/// All that the child sends until it ends. Throws where it takes too long or sends too much.
std::vector<std::byte> Receive(const fs::path& file, int in, const MeshLimits& limits) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                      std::chrono::duration<double>(limits.time_s));
  const std::size_t most = sizeof(MeshHeader) + 12 * (limits.vertices + limits.triangles) + 1;
  std::vector<std::byte> bytes;
  std::size_t size = 0;
  for (;;) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    if (left <= 0) Fail(file, fmt::format("reading the mesh took more than {} s", limits.time_s));
    pollfd wait{in, POLLIN, 0};
    const int ready = ::poll(&wait, 1, static_cast<int>(left));
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) continue;
    if (size > most)
      Fail(file, fmt::format("more than {} vertices and {} triangles", limits.vertices,
                             limits.triangles));
    bytes.resize(std::max<std::size_t>(bytes.size(), size + 65536));
    const ssize_t got = ::read(in, bytes.data() + size, bytes.size() - size);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) Fail(file, fmt::format("cannot read the mesh: {}", std::strerror(errno)));
    if (got == 0) break;
    size += static_cast<std::size_t>(got);
    if (size + 65536 > bytes.size()) bytes.resize(2 * bytes.size());
  }
  bytes.resize(size);
  return bytes;
}

/// What Git leaves of a large file that was not fetched.
bool IsLfsPointer(const fs::path& file) {
  constexpr std::string_view kBegin = "version https://git-lfs.github.com/spec/";
  std::string begin(kBegin.size(), '\0');
  std::ifstream in(file, std::ios::binary);
  return in.read(begin.data(), static_cast<std::streamsize>(begin.size())) && begin == kBegin;
}

MeshKind CheckFile(const fs::path& file, const MeshLimits& limits) {
  const std::string suffix = InLowerCase(file.extension().string());
  if (std::ranges::find(kSuffixes, suffix) == kSuffixes.end())
    Fail(file, fmt::format("a mesh file cannot end in \"{}\"; allowed are {}", suffix,
                           fmt::join(kSuffixes, ", ")));
  std::error_code error;
  if (const std::string why = WhyNoFile(file); !why.empty()) Fail(file, why);
  if (IsLfsPointer(file)) Fail(file, "a Git LFS pointer, not the mesh; run git lfs pull");
  const auto size = fs::file_size(file, error);
  if (error || size > limits.file_bytes)
    Fail(file,
         fmt::format("{} bytes; allowed are at most {}", error ? 0 : size, limits.file_bytes));
  try {
    if (suffix == ".stl") return {suffix, BinaryStlRest(file, size)};
  } catch (const ModelError& why) {
    Fail(file, why.what());
  }
  return {suffix};
}

}  // namespace

RawMesh DecodeMesh(const fs::path& file, std::span<const std::byte> bytes,
                   const MeshLimits& limits) {
  MeshHeader header;
  const auto broken = [&] { Fail(file, "cannot read the mesh: the reader stopped half-way"); };
  if (bytes.size() < sizeof(header)) broken();
  std::memcpy(&header, bytes.data(), sizeof(header));
  bytes = bytes.subspan(sizeof(header));
  if (header.magic != MeshHeader::kMagic) broken();
  if (header.text > 0) {
    if (bytes.size() < header.text) broken();
    const std::string text(reinterpret_cast<const char*>(bytes.data()), header.text);
    Fail(file, "cannot read the mesh: " + text);
  }
  if (header.vertices > limits.vertices || header.triangles > limits.triangles)
    Fail(file, fmt::format("{} vertices and {} triangles; allowed are at most {} and {}",
                           header.vertices, header.triangles, limits.vertices, limits.triangles));
  if (bytes.size() != 12 * (header.vertices + header.triangles)) broken();
  RawMesh mesh;
  mesh.vertices.resize(header.vertices);
  mesh.triangles.resize(header.triangles);
  if (header.vertices > 0) std::memcpy(mesh.vertices.data(), bytes.data(), 12 * header.vertices);
  if (header.triangles > 0)
    std::memcpy(mesh.triangles.data(), bytes.data() + 12 * header.vertices, 12 * header.triangles);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    if (!mesh.vertices[i].allFinite()) Fail(file, fmt::format("vertex {} is not finite", i));
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (const int corner : mesh.triangles[i])
      if (corner < 0 || static_cast<std::size_t>(corner) >= mesh.vertices.size())
        Fail(file, fmt::format("triangle {} has the corner {}; there are {} vertices", i,
                               static_cast<unsigned>(corner), mesh.vertices.size()));
  return mesh;
}

RawMesh ReadMeshFile(const fs::path& file, const MeshLimits& limits) {
  const MeshKind kind = CheckFile(file, limits);
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0)
    Fail(file, fmt::format("cannot start the mesh reader: {}", std::strerror(errno)));
  const Descriptor in(ends[0]);
  auto out = std::make_unique<Descriptor>(ends[1]);
  const pid_t pid = ::fork();
  if (pid < 0) Fail(file, fmt::format("cannot start the mesh reader: {}", std::strerror(errno)));
  if (pid == 0) RunMeshChild(file.string(), kind, ends[1], limits);
  Child child(pid);
  out.reset();
  const std::vector<std::byte> bytes = Receive(file, in.number, limits);
  const int status = child.Wait();
  if (WIFSIGNALED(status))
    Fail(file, fmt::format("cannot read the mesh: the reader died of it ({})",
                           ::strsignal(WTERMSIG(status))));
  RawMesh mesh = DecodeMesh(file, bytes, limits);
  mesh.unread_bytes = kind.stl_rest.value_or(0);
  return mesh;
}

}  // namespace regrasp
