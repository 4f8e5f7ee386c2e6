#include "core/hand/mesh_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string_view>
#include <system_error>
#include <vector>

#include "core/hand/mesh_text.h"

namespace regrasp {
namespace {

namespace fs = std::filesystem;

/// Where packages of a kind are looked for, beside the directories above the URDF file.
struct Scheme {
  std::string_view begin;
  struct Roots {
    const char* variable;
    const char* below;  ///< each of its directories
  };
  std::vector<Roots> roots;
  std::string Variables() const {
    std::string names;
    for (const Roots& r : roots) names += (names.empty() ? "$" : " or $") + std::string(r.variable);
    return names;
  }
};

const Scheme kSchemes[] = {
    {"package://", {{"ROS_PACKAGE_PATH", ""}, {"AMENT_PREFIX_PATH", "share"}}},
    {"model://", {{"GAZEBO_MODEL_PATH", ""}}}};

bool IsFile(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

/// "a%20b" as "a b"; what is no such code stays.
std::string Decoded(std::string_view text) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    int byte = 0;
    const bool code = text[i] == '%' && i + 2 < text.size() &&
                      std::isxdigit(static_cast<unsigned char>(text[i + 1])) &&
                      std::from_chars(text.data() + i + 1, text.data() + i + 3, byte, 16).ptr ==
                          text.data() + i + 3;
    decoded += code && byte != 0 ? static_cast<char>(byte) : text[i];
    if (code && byte != 0) i += 2;
  }
  return decoded;
}

/// A file in a directory, named by a URI: as it stands where there is such a file, else with its
/// %XX decoded.
fs::path Below(const fs::path& directory, std::string_view inside) {
  const fs::path written = directory / fs::path(inside).relative_path();
  return IsFile(written) ? written : directory / fs::path(Decoded(inside)).relative_path();
}

/// Whether the package.xml of a directory says that it is the package.
bool SaysItIs(const fs::path& directory, const std::string& package) {
  const fs::path file = directory / "package.xml";
  if (!IsFile(file)) return false;
  constexpr std::size_t kMost = 65536;
  std::ifstream in(file, std::ios::binary);
  std::string text(kMost, '\0');
  in.read(text.data(), kMost);
  text.resize(static_cast<std::size_t>(in.gcount()));
  constexpr std::string_view kBegin = "<name>", kSpace = " \t\r\n";
  std::size_t at = text.find(kBegin);
  if (at == std::string::npos) return false;
  at = text.find_first_not_of(kSpace, at + kBegin.size());
  return at != std::string::npos && text.compare(at, package.size(), package) == 0 &&
         text.find_first_not_of(kSpace, at + package.size()) == text.find('<', at);
}

std::vector<fs::path> DirectoriesAbove(const fs::path& urdf) {
  std::error_code ignored;
  std::vector<fs::path> list;
  fs::path directory = fs::absolute(urdf, ignored).lexically_normal().parent_path();
  for (; !directory.empty(); directory = directory.parent_path()) {
    list.push_back(directory);
    if (directory == directory.root_path()) break;
  }
  return list;
}

/// Directories that are the package by name: of the variables, then above the URDF file.
std::vector<fs::path> PackagesOf(const fs::path& urdf, const std::string& package,
                                 const Scheme& scheme) {
  std::error_code ignored;
  std::vector<fs::path> found;
  const auto add = [&](const fs::path& directory) {
    if (directory.filename() == package || SaysItIs(directory, package))
      found.push_back(directory);
    else if (fs::is_directory(directory / package, ignored))
      found.push_back(directory / package);
  };
  for (const Scheme::Roots& roots : scheme.roots) {
    const char* value = std::getenv(roots.variable);
    std::istringstream list(value == nullptr ? "" : value);
    for (std::string root; std::getline(list, root, ':');)
      if (const fs::path directory = fs::path(root) / roots.below; !root.empty())
        add(directory.has_filename() ? directory : directory.parent_path());
  }
  for (const fs::path& directory : DirectoriesAbove(urdf)) add(directory);
  return found;
}

/// NAME/REST. Where no directory is the package by its name, REST is looked for, as hands are often
/// published: in the package that the URDF file is in, beside the URDF file, one directory up.
/// Empty where `named` is no such name; where there is no such file, where the first would be.
MeshPlace InPackage(const fs::path& urdf, std::string_view named, const Scheme& scheme) {
  const std::size_t slash = named.find('/');
  if (slash == std::string_view::npos || slash == 0 || slash + 1 == named.size()) return {};
  const std::string package(named.substr(0, slash));
  const std::string_view inside = named.substr(slash + 1);
  const std::vector<fs::path> packages = PackagesOf(urdf, package, scheme);
  for (const fs::path& directory : packages)
    if (const fs::path file = Below(directory, inside); IsFile(file)) return {file};
  if (!packages.empty()) return {Below(packages.front(), inside)};
  std::vector<fs::path> guesses;
  for (const fs::path& directory : DirectoriesAbove(urdf))
    if (IsFile(directory / "package.xml")) guesses.push_back(directory);
  guesses.push_back(urdf.parent_path());
  guesses.push_back(urdf.parent_path() / "..");
  for (const fs::path& directory : guesses)
    if (const fs::path file = Below(directory, inside); IsFile(file))
      return {file,
              fmt::format("{}{} is no directory above the file, nor in {}; {} is taken for it",
                          scheme.begin, package, scheme.Variables(),
                          directory.empty() ? "." : directory.lexically_normal().string())};
  return {Below(urdf.parent_path(), inside)};
}

}  // namespace

MeshPlace ResolveMesh(const fs::path& urdf, const std::string& name, std::string* why) {
  constexpr std::string_view kFile = "file://", kHere = "localhost/";
  const std::string_view text = name;
  if (text.find("${") != std::string_view::npos || text.find("$(") != std::string_view::npos) {
    *why = "run xacro over the file first";
    return {};
  }
  if (text.starts_with(kFile)) {
    std::string_view path = text.substr(kFile.size());
    if (path.starts_with(kHere)) path.remove_prefix(kHere.size() - 1);
    return {IsFile(path) ? fs::path(path) : fs::path(Decoded(path))};
  }
  for (const Scheme& scheme : kSchemes) {
    if (!text.starts_with(scheme.begin)) continue;
    const MeshPlace place = InPackage(urdf, text.substr(scheme.begin.size()), scheme);
    if (place.file.empty())
      *why = fmt::format("must be {}NAME/FILE, NAME a directory above the file or in {}",
                         scheme.begin, scheme.Variables());
    return place;
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
    if (const fs::path file = urdf.parent_path() / slashes; IsFile(file)) return {file};
  }
  return {urdf.parent_path() / name};
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
  if (IsFile(file)) return "";
  const fs::path other = OtherCase(file);
  return "mesh file not found" + (other.empty() ? ""
                                                : fmt::format("; did you mean {}? Capitals count",
                                                              other.filename().string()));
}

std::string WherePackagesAre(std::string_view name) {
  for (const Scheme& scheme : kSchemes)
    if (name.starts_with(scheme.begin))
      return fmt::format(", nor its {} in a directory above the file or in {}",
                         scheme.begin.substr(0, scheme.begin.find(':')), scheme.Variables());
  return "";
}

}  // namespace regrasp
