#include "core/hand/model_path.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <set>
#include <system_error>

#include "core/common/nearest_name.h"

namespace regrasp {
namespace {

namespace fs = std::filesystem;

bool IsFile(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

bool IsDirectory(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

std::string Suffix(const std::string& name) {
  std::string suffix = fs::path(name).extension().string();
  std::ranges::transform(suffix, suffix.begin(), [](unsigned char c) { return std::tolower(c); });
  return suffix;
}

/// What to do with a file of another kind.
const char* Advice(const std::string& suffix) {
  if (suffix == ".xacro") return "; run xacro over it: xacro FILE.xacro -o FILE.urdf";
  for (const char* mesh : {".obj", ".stl", ".ply", ".dae", ".glb"})
    if (suffix == mesh)
      return "; a mesh needs one that names it in <collision><geometry><mesh filename=...>, with "
             "its "
             "mass";
  for (const char* other : {".sdf", ".world", ".xml", ".mjcf", ".usd", ".usda"})
    if (suffix == other) return "; SDF, MJCF and USD are not read";
  return "";
}

}  // namespace

std::vector<fs::path> ModelSearchPath(const std::string& models_dir) {
  std::vector<fs::path> path;
  const auto add = [&](const fs::path& directory) {
    std::error_code ignored;
    const fs::path clean = fs::weakly_canonical(directory, ignored);
    if (IsDirectory(clean) && std::find(path.begin(), path.end(), clean) == path.end())
      path.push_back(clean);
  };
  if (!models_dir.empty()) {
    if (!IsDirectory(models_dir))
      throw ModelError::NoModel(fmt::format("{}: models directory not found", models_dir));
    add(models_dir);
  }
  if (const char* named = std::getenv("REGRASP_MODELS_DIR"); named != nullptr && *named != '\0') {
    if (!IsDirectory(named))
      throw ModelError::NoModel(fmt::format("{}: $REGRASP_MODELS_DIR is not a directory", named));
    add(named);
  }
  // Programs are installed in bin/ and libexec/regrasp/, both beside share/.
  std::error_code ignored;
  const fs::path bin = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  for (const fs::path& prefix : {bin.parent_path(), bin.parent_path().parent_path()})
    if (!prefix.empty()) add(prefix / "share/regrasp/models");
  add(REGRASP_SOURCE_MODELS_DIR);
  add(REGRASP_INSTALLED_MODELS_DIR);
  return path;
}

fs::path FindModel(const std::string& name, const char* kind,
                   const std::vector<fs::path>& search_path) {
  if (Suffix(name) == ".urdf") {
    if (IsFile(name)) return name;
    throw ModelError::NoModel(fmt::format("{}: file not found", name));
  }
  const bool names_file = name.find('/') != std::string::npos && fs::path(name).has_extension();
  if (names_file || IsFile(name))
    throw ModelError(
        fmt::format("{}: a model file must end in .urdf{}", name, Advice(Suffix(name))));
  // A name is one path component, so that it cannot lead out of the search path.
  if (!name.empty() && fs::path(name).filename() == name)
    for (const fs::path& directory : search_path) {
      const fs::path file = directory / kind / (name + ".urdf");
      if (IsFile(file)) return file;
    }
  if (search_path.empty())
    throw ModelError::NoModel(
        fmt::format("there is no model \"{}\": no directory of models was found "
                    "($REGRASP_MODELS_DIR names one)",
                    name));
  std::vector<std::string> directories;
  for (const fs::path& directory : search_path) directories.push_back((directory / kind).string());
  const std::vector<std::string> known = ListModels(search_path, kind);
  throw ModelError::NoModel(fmt::format("there is no model \"{}\" in {}{}; available are {}", name,
                                        fmt::join(directories, ", "), OrNearest(name, known),
                                        fmt::join(known, ", ")));
}

std::vector<std::string> ListModels(const std::vector<fs::path>& search_path, const char* kind) {
  std::set<std::string> names;
  for (const fs::path& directory : search_path) {
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(directory / kind, ignored))
      if (entry.path().extension() == ".urdf") names.insert(entry.path().stem().string());
  }
  return {names.begin(), names.end()};
}

}  // namespace regrasp
