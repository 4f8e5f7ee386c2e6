#include "core/hand/mesh_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <string_view>
#include <system_error>

#include "core/hand/mesh_text.h"

namespace regrasp {
namespace {

namespace fs = std::filesystem;

/// NAME/REST; a package directory given as such may have another name.
fs::path InPackage(const fs::path& urdf, std::string_view name, const char* variable) {
  const std::size_t slash = name.find('/');
  if (slash == std::string_view::npos || slash == 0) return {};
  const fs::path package = name.substr(0, slash), inside = name.substr(slash + 1);
  std::error_code ignored;
  fs::path directory = fs::absolute(urdf, ignored).lexically_normal().parent_path();
  for (; !directory.empty(); directory = directory.parent_path()) {
    if (directory.filename() == package) return directory / inside;
    if (fs::is_directory(directory / package, ignored)) return directory / package / inside;
    if (fs::is_regular_file(directory / "package.xml", ignored) &&
        fs::is_regular_file(directory / inside, ignored))
      return directory / inside;
    if (directory == directory.root_path()) break;
  }
  const char* roots = std::getenv(variable);
  std::istringstream list(roots == nullptr ? "" : roots);
  for (std::string root; std::getline(list, root, ':');) {
    if (fs::path(root).filename() == package) return fs::path(root) / inside;
    if (fs::is_directory(fs::path(root) / package, ignored)) return root / package / inside;
  }
  return {};
}

/// REST where its package is not there, as hands are often published: beside the URDF file or one
/// directory up; where there is no such file, where the first would be.
fs::path WithoutPackage(const fs::path& urdf, std::string_view name) {
  const std::size_t slash = name.find('/');
  if (slash == std::string_view::npos || slash == 0 || slash + 1 == name.size()) return {};
  const fs::path inside = name.substr(slash + 1);
  std::error_code ignored;
  for (const fs::path& way : {inside, ".." / inside})
    if (fs::is_regular_file(urdf.parent_path() / way, ignored)) return urdf.parent_path() / way;
  return urdf.parent_path() / inside;
}

}  // namespace

fs::path ResolveMesh(const fs::path& urdf, const std::string& name, std::string* why) {
  constexpr std::string_view kFile = "file://", kPackage = "package://", kModel = "model://";
  const std::string_view text = name;
  if (text.find("${") != std::string_view::npos || text.find("$(") != std::string_view::npos) {
    *why = "run xacro over the file first";
    return {};
  }
  if (text.starts_with(kFile)) return text.substr(kFile.size());
  for (const auto& [scheme, variable] :
       {std::pair{kPackage, "ROS_PACKAGE_PATH"}, std::pair{kModel, "GAZEBO_MODEL_PATH"}}) {
    if (!text.starts_with(scheme)) continue;
    const std::string_view named = text.substr(scheme.size());
    fs::path file = InPackage(urdf, named, variable);
    if (file.empty()) file = WithoutPackage(urdf, named);
    if (file.empty())
      *why = fmt::format("must be {}NAME/FILE, NAME a directory above the file or in ${}", scheme,
                         variable);
    return file;
  }
  if (text.find("://") != std::string_view::npos) {
    *why =
        "allowed are a path relative to the URDF file, an absolute path, file://, package:// or "
        "model://";
    return {};
  }
  if (text.find('\\') != std::string_view::npos) {
    std::string slashes = name;
    std::replace(slashes.begin(), slashes.end(), '\\', '/');
    std::error_code ignored;
    const fs::path file = urdf.parent_path() / slashes;
    if (fs::is_regular_file(file, ignored)) return file;
  }
  return urdf.parent_path() / name;
}

fs::path OtherCase(const fs::path& file) {
  std::error_code error;
  const std::string name = InLowerCase(file.filename().string());
  const fs::path directory = file.has_parent_path() ? file.parent_path() : fs::path(".");
  for (const auto& entry : fs::directory_iterator(directory, error))
    if (InLowerCase(entry.path().filename().string()) == name && entry.is_regular_file(error))
      return entry.path();
  return {};
}

std::string WhyNoFile(const fs::path& file) {
  std::error_code ignored;
  if (fs::is_directory(file, ignored)) return "is a directory; must be a mesh file";
  if (fs::is_regular_file(file, ignored)) return "";
  const fs::path other = OtherCase(file);
  return "mesh file not found" + (other.empty() ? ""
                                                : fmt::format("; did you mean {}? Capitals count",
                                                              other.filename().string()));
}

std::string WherePackagesAre(std::string_view name) {
  if (name.starts_with("package://"))
    return ", nor its package in a directory above the file or in $ROS_PACKAGE_PATH";
  if (name.starts_with("model://"))
    return ", nor its model in a directory above the file or in $GAZEBO_MODEL_PATH";
  return "";
}

}  // namespace regrasp
