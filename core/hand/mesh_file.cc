#include "core/hand/mesh_file.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <memory>
#include <optional>
#include <string>

#include "core/hand/mesh_path.h"
#include "core/hand/mesh_text.h"
#include "core/hand/ply_file.h"
#include "core/hand/stl_file.h"

namespace regrasp {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 5> kSuffixes = {".obj", ".stl", ".ply", ".dae", ".glb"};

/// Precedes what the child sends: `text` bytes of an error, or vertices (3 floats each) and
/// triangles (3 ints each).
struct Header {
  std::uint32_t magic = kMagic;
  std::uint32_t text = 0;
  std::uint64_t vertices = 0, triangles = 0;
  static constexpr std::uint32_t kMagic = 0x6d657368;
};

/// How a file is read.
struct Kind {
  std::string suffix;                       ///< in lower case
  std::optional<std::uint64_t> stl_rest{};  ///< of a binary STL file: BinaryStlRest
};

// ---- in the child ----

void Send(int out, const void* data, std::size_t size) {
  const char* at = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t sent = ::write(out, at, size);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) ::_exit(1);
    at += sent;
    size -= static_cast<std::size_t>(sent);
  }
}

void SendError(int out, const std::string& text) {
  Header header;
  header.text = static_cast<std::uint32_t>(std::min<std::size_t>(text.size(), 1000));
  Send(out, &header, sizeof(header));
  Send(out, text.data(), header.text);
}

/// A mesh where a node of the scene has it.
struct Placed {
  const aiMesh* mesh;
  aiMatrix4x4 X;
};

/// Every mesh of the scene, by material and then as the nodes stand. An instance costs nothing to
/// write: from `most` vertices on they are only counted on, in the header.
std::vector<Placed> PlacedMeshes(const aiScene& scene, std::uint64_t most) {
  struct Open {
    const aiNode* node;
    aiMatrix4x4 X;
  };
  std::vector<Placed> placed;
  std::uint64_t vertices = 0;
  std::vector<Open> open = {{scene.mRootNode, scene.mRootNode->mTransformation}};
  while (!open.empty() && vertices <= most) {
    const Open at = open.back();
    open.pop_back();
    for (unsigned m = 0; m < at.node->mNumMeshes && vertices <= most; ++m) {
      placed.push_back({scene.mMeshes[at.node->mMeshes[m]], at.X});
      vertices += placed.back().mesh->mNumVertices;
    }
    for (unsigned c = at.node->mNumChildren; c > 0; --c) {
      const aiNode* child = at.node->mChildren[c - 1];
      open.push_back({child, at.X * child->mTransformation});
    }
  }
  std::ranges::stable_sort(placed, {}, [](const Placed& p) { return p.mesh->mMaterialIndex; });
  return placed;
}

std::uint64_t Triangles(const std::vector<Placed>& placed) {
  std::uint64_t triangles = 0;
  for (const Placed& part : placed)
    for (unsigned i = 0; i < part.mesh->mNumFaces; ++i)  // points and lines enclose nothing
      triangles += part.mesh->mFaces[i].mNumIndices == 3;
  return triangles;
}

void SendScene(int out, const aiScene& scene, const MeshLimits& limits) {
  const std::vector<Placed> placed = PlacedMeshes(scene, limits.vertices);
  Header header;
  for (const Placed& part : placed) header.vertices += part.mesh->mNumVertices;
  header.triangles = Triangles(placed);
  Send(out, &header, sizeof(header));
  std::vector<aiVector3D> moved;
  for (const Placed& part : placed) {
    static_assert(sizeof(aiVector3D) == 3 * sizeof(float));
    moved.assign(part.mesh->mVertices, part.mesh->mVertices + part.mesh->mNumVertices);
    if (!part.X.IsIdentity())
      for (aiVector3D& v : moved) v = part.X * v;
    Send(out, moved.data(), moved.size() * sizeof(aiVector3D));
  }
  std::uint32_t first = 0;
  for (const Placed& part : placed) {
    const bool mirrored = part.X.Determinant() < 0;
    for (unsigned i = 0; i < part.mesh->mNumFaces; ++i) {
      if (part.mesh->mFaces[i].mNumIndices != 3) continue;
      std::uint32_t corners[3];
      for (int k = 0; k < 3; ++k) corners[k] = first + part.mesh->mFaces[i].mIndices[k];
      if (mirrored) std::swap(corners[1], corners[2]);
      Send(out, corners, sizeof(corners));
    }
    first += part.mesh->mNumVertices;
  }
}

void SendMesh(int out, const RawMesh& mesh) {
  static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float) &&
                sizeof(Eigen::Vector3i) == 3 * sizeof(std::uint32_t));
  Header header;
  header.vertices = mesh.vertices.size();
  header.triangles = mesh.triangles.size();
  Send(out, &header, sizeof(header));
  Send(out, mesh.vertices.data(), mesh.vertices.size() * sizeof(Eigen::Vector3f));
  Send(out, mesh.triangles.data(), mesh.triangles.size() * sizeof(Eigen::Vector3i));
}

constexpr unsigned kSteps = aiProcess_Triangulate | aiProcess_DropNormals;

void ReadByAssimp(int out, const std::string& file, const std::string& suffix,
                  const MeshLimits& limits) {
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const std::string text = TextForAssimp(file, suffix);
  const aiScene* scene = text.empty() ? importer.ReadFile(file, kSteps)
                                      : importer.ReadFileFromMemory(text.data(), text.size(),
                                                                    kSteps, suffix.c_str() + 1);
  if (scene == nullptr || scene->mRootNode == nullptr)
    SendError(out, importer.GetErrorString());
  else
    SendScene(out, *scene, limits);
}

/// Polygons are cut by assimp. One that it cannot cut (it has a corner twice, say) it leaves out;
/// then all are cut from their first corner.
void ReadPlyFile(int out, const std::string& file, const MeshLimits& limits) {
  PolygonMesh read = ReadPly(file, limits);
  if (read.polygons.empty()) return SendMesh(out, read.mesh);
  Assimp::Importer importer;
  const std::string text = ObjText(read);
  const aiScene* scene = importer.ReadFileFromMemory(
      text.data(), text.size(), kSteps | aiProcess_JoinIdenticalVertices, "obj");
  const bool cut = scene != nullptr && scene->mRootNode != nullptr &&
                   Triangles(PlacedMeshes(*scene, limits.vertices)) == read.triangles;
  if (cut)
    SendScene(out, *scene, limits);
  else
    SendMesh(out, Fans(std::move(read)));
}

void LimitChild(const MeshLimits& limits) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGTERM, SIGINT, SIGHUP})
    ::signal(signal, SIG_DFL);
  const auto limit = [](auto resource, rlim_t most) {
    const rlimit value{most, most};
    ::setrlimit(resource, &value);
  };
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, static_cast<rlim_t>(limits.time_s) + 1);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  // (The sanitizers reserve terabytes of addresses.)
  char text[64] = "";
  const int statm = ::open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  const ssize_t got = statm < 0 ? 0 : ::read(statm, text, sizeof(text) - 1);
  const std::size_t pages = got > 0 ? std::strtoull(text, nullptr, 10) : 0;
  limit(RLIMIT_AS, pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)) + limits.memory_bytes);
#endif
}

[[noreturn]] void RunChild(const std::string& file, const Kind& kind, int out,
                           const MeshLimits& limits) {
  LimitChild(limits);
  const int nowhere = ::open("/dev/null", O_RDWR);
  ::dup2(nowhere, STDERR_FILENO);
  ::dup2(nowhere, STDOUT_FILENO);
  ::dup2(out, 3);
  ::close_range(4, ~0U, 0);
  try {
    if (kind.suffix == ".ply")
      ReadPlyFile(3, file, limits);
    else if (kind.stl_rest)
      SendMesh(3, ReadBinaryStl(file, limits));
    else
      ReadByAssimp(3, file, kind.suffix, limits);
  } catch (const std::bad_alloc&) {
    SendError(3, fmt::format("needs more than {} MiB of memory", limits.memory_bytes >> 20));
  } catch (const std::exception& error) {
    SendError(3, error.what());
  }
  ::_exit(0);
}

// ---- in the parent ----

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
  const std::size_t most = sizeof(Header) + 12 * (limits.vertices + limits.triangles) + 1;
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

Kind CheckFile(const fs::path& file, const MeshLimits& limits) {
  const std::string suffix = InLowerCase(file.extension().string());
  if (std::ranges::find(kSuffixes, suffix) == kSuffixes.end())
    Fail(file, fmt::format("a mesh file cannot end in \"{}\"; allowed are {}", suffix,
                           fmt::join(kSuffixes, ", ")));
  std::error_code error;
  if (const std::string why = WhyNoFile(file); !why.empty()) Fail(file, why);
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
  Header header;
  const auto broken = [&] { Fail(file, "cannot read the mesh: the reader stopped half-way"); };
  if (bytes.size() < sizeof(header)) broken();
  std::memcpy(&header, bytes.data(), sizeof(header));
  bytes = bytes.subspan(sizeof(header));
  if (header.magic != Header::kMagic) broken();
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
  const Kind kind = CheckFile(file, limits);
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0)
    Fail(file, fmt::format("cannot start the mesh reader: {}", std::strerror(errno)));
  const Descriptor in(ends[0]);
  auto out = std::make_unique<Descriptor>(ends[1]);
  const pid_t pid = ::fork();
  if (pid < 0) Fail(file, fmt::format("cannot start the mesh reader: {}", std::strerror(errno)));
  if (pid == 0) RunChild(file.string(), kind, ends[1], limits);
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
