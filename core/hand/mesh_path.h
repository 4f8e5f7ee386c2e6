#pragma once

/// Where the mesh file is that a URDF names.

#include <filesystem>
#include <string>
#include <string_view>

namespace regrasp {

/// A mesh file, and where that is a guess what a user is told of it.
struct MeshPlace {
  std::filesystem::path file;
  std::string guess = {};
};

/// The file behind `name`, written in the URDF file `urdf`: a path (relative to the URDF file, or
/// absolute), file://PATH, package://NAME/REST or model://NAME/REST (of which %XX is decoded). A
/// package is a directory that is called NAME or whose package.xml says so: of $ROS_PACKAGE_PATH or
/// of the share/ of $AMENT_PREFIX_PATH (model://: of $GAZEBO_MODEL_PATH), else the nearest above
/// the URDF file or beside one above. Where there is none, a guess: REST in the package that the
/// URDF file is in, beside the URDF file or one directory up. Whether the file is there is for the
/// caller to find out. An empty path where nothing can be meant: then `why` says what is allowed.
MeshPlace ResolveMesh(const std::filesystem::path& urdf, const std::string& name, std::string* why);

/// The file beside `file` whose name differs by capitals only, which other systems take for the
/// same; empty where there is none.
std::filesystem::path OtherCase(const std::filesystem::path& file);

/// Why `file` is no file that can be read, or "".
std::string WhyNoFile(const std::filesystem::path& file);

/// What else was looked for where the file behind such a name is not found; empty for a plain path.
std::string WherePackagesAre(std::string_view name);

}  // namespace regrasp
