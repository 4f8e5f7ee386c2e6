#include "core/hand/mesh_child.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <new>
#include <utility>
#include <vector>

#include "core/hand/gltf_check.h"
#include "core/hand/mesh_text.h"
#include "core/hand/ply_file.h"
#include "core/hand/stl_file.h"

namespace regrasp {
namespace {

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
  MeshHeader header;
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
  MeshHeader header;
  for (const Placed& part : placed) header.vertices += part.mesh->mNumVertices;
  header.triangles = Triangles(placed);
  Send(out, &header, sizeof(header));
  std::vector<aiVector3D> moved;
  for (const Placed& part : placed) {
    static_assert(sizeof(aiVector3D) == 3 * sizeof(float));
    moved.assign(part.mesh->mVertices, part.mesh->mVertices + part.mesh->mNumVertices);
    // (IsIdentity() is true of what is off by 0.01.)
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
  MeshHeader header;
  header.vertices = mesh.vertices.size();
  header.triangles = mesh.triangles.size();
  Send(out, &header, sizeof(header));
  Send(out, mesh.vertices.data(), mesh.vertices.size() * sizeof(Eigen::Vector3f));
  Send(out, mesh.triangles.data(), mesh.triangles.size() * sizeof(Eigen::Vector3i));
}

constexpr unsigned kSteps = aiProcess_Triangulate | aiProcess_DropNormals;

void ReadByAssimp(int out, const std::string& file, const std::string& suffix,
                  const MeshLimits& limits) {
  if (suffix == ".glb")
    if (const std::string why = WhyNoGltf(file); !why.empty()) return SendError(out, why);
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

}  // namespace

void RunMeshChild(const std::string& file, const MeshKind& kind, int out,
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

}  // namespace regrasp
