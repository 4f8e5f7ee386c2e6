/// Names of mesh files as strangers write them: each leads to the file that is meant.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "core/hand/object_loader.h"
#include "tests/unit/hand/wild_files.h"

namespace regrasp {
namespace {

/// The L [m] as an OBJ file.
std::string EllObj() {
  std::string text, faces;
  int corner = 0;
  for (const Corners& corners : Ell()) {
    for (const Vector3d& p : corners)
      text += fmt::format("v {} {} {}\n", p.x() / 1e3, p.y() / 1e3, p.z() / 1e3);
    faces += fmt::format("f {} {} {}\n", corner + 1, corner + 2, corner + 3);
    corner += 3;
  }
  return text + faces;
}

/// An environment variable for a while.
struct Variable {
  Variable(const char* name_in, const std::string& value) : name(name_in) {
    ::setenv(name, value.c_str(), 1);
  }
  ~Variable() { ::unsetenv(name); }
  const char* name;
};

TEST_F(WildTest, PathsOfOtherSystems) {
  fs::create_directories(root_ / "objects/meshes");
  Write("objects/meshes/ell.obj", EllObj());
  const std::string root = fs::absolute(root_).string();
  for (const std::string& path :
       {std::string("meshes/ell.obj"), std::string("./meshes/../meshes/ell.obj"),
        std::string("meshes\\ell.obj"), std::string("package://objects/meshes/ell.obj"),
        std::string("model://objects/meshes/ell.obj"), "file://" + root + "/objects/meshes/ell.obj",
        root + "/objects/meshes/ell.obj"}) {
    SCOPED_TRACE(path);
    ExpectEll(Load(fmt::format("<mesh filename=\"{}\"/>", path)));
  }
  const fs::path elsewhere = root_ / "elsewhere/ell_description/meshes";
  fs::create_directories(elsewhere);
  fs::copy(root_ / "objects/meshes/ell.obj", elsewhere);
  const std::string mesh = "<mesh filename=\"model://ell_description/meshes/ell.obj\"/>";
  ExpectEll(Load(mesh));  // without its package, as it is often published
  const std::string gone =
      Refusal("<mesh filename=\"package://ell_description/meshes/gone.obj\"/>");
  EXPECT_NE(gone.find("gone.obj\": file not found, nor its package"), std::string::npos) << gone;
  for (const char* name : {"package://", "package:///", "package://ell_description"})
    EXPECT_NE(Refusal(fmt::format("<mesh filename=\"{}\"/>", name)).find("$ROS_PACKAGE_PATH"),
              std::string::npos);
  ::setenv("GAZEBO_MODEL_PATH", ("/nowhere:" + root + "/elsewhere").c_str(), 1);
  ExpectEll(Load(mesh));
  ::unsetenv("GAZEBO_MODEL_PATH");
}

class PackagesTest : public WildTest {
 protected:
  /// A package below the test's directory, with meshes/m.obj: the L where it is the one meant, else
  /// a tetrahedron.
  void Package(const std::string& directory, bool meant, const std::string& name = "") {
    fs::create_directories(root_ / directory / "meshes");
    Write(directory + "/meshes/m.obj", meant ? EllObj() : kTetrahedron);
    if (!name.empty())
      Write(directory + "/package.xml",
            "<package format=\"2\">\n  <name> " + name + "</name>\n</package>");
  }
  /// The warnings of an object whose URDF is in the package "own".
  std::vector<std::string> Warnings(const std::string& mesh, std::size_t triangles) {
    Write("own/thing.urdf", Replaced(kBallUrdf, "<sphere radius=\"0.025\"/>",
                                     fmt::format("<mesh filename=\"{}\"/>", mesh)));
    LoadOptions options;
    options.inertia_from_shape = true;
    ModelReport report;
    EXPECT_EQ(LoadObjectFile(root_ / "own/thing.urdf", options, &report).triangles.size(),
              triangles);
    std::vector<std::string> lines;
    for (const ModelWarning& warning : report.warnings) lines.push_back(warning.Line());
    return lines;
  }
  static constexpr const char* kMesh = "package://other/meshes/m.obj";
  static constexpr std::size_t kMeant = 20, kGuessed = 4;  // triangles
};

TEST_F(PackagesTest, OfThePathVariableCountBeforeWhatIsGuessed) {
  Package("own", false, "own");
  Package("path/other", true, "other");
  Package("prefix/share/other", true, "other");
  for (const auto& [name, value] :
       {std::pair{"ROS_PACKAGE_PATH", "/nowhere::" + (root_ / "path").string()},
        std::pair{"ROS_PACKAGE_PATH", (root_ / "path/other/").string()},
        std::pair{"AMENT_PREFIX_PATH", "/nowhere:" + (root_ / "prefix").string()}}) {
    SCOPED_TRACE(value);
    const Variable variable(name, value);
    EXPECT_EQ(Warnings(kMesh, kMeant), std::vector<std::string>());
  }
  fs::remove(root_ / "path/other/package.xml");
  for (const char* slash : {"", "/"}) {
    const Variable variable("ROS_PACKAGE_PATH", (root_ / "path/other").string() + slash);
    EXPECT_EQ(Warnings(kMesh, kMeant), std::vector<std::string>());
  }
  // The package is there, but not the file: another package's is none.
  fs::remove(root_ / "path/other/meshes/m.obj");
  const Variable variable("ROS_PACKAGE_PATH", (root_ / "path").string());
  EXPECT_THROW(LoadObjectFile(root_ / "own/thing.urdf"), ModelError);
}

TEST_F(PackagesTest, AGuessIsTold) {
  Package("own", false, "own");
  const std::vector<std::string> told = Warnings(kMesh, kGuessed);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_NE(told[0].find("own/thing.urdf:3: <mesh> filename = \"package://other/meshes/m.obj\": "
                         "package://other is no directory above the file, nor in "
                         "$ROS_PACKAGE_PATH or $AMENT_PREFIX_PATH; "),
            std::string::npos)
      << told[0];
  EXPECT_NE(told[0].find("/own is taken for it"), std::string::npos) << told[0];
}

TEST_F(PackagesTest, ADirectoryOfAnotherNameIsThePackageThatItsPackageXmlNames) {
  Package("own", true, "other");
  EXPECT_EQ(Warnings(kMesh, kMeant), std::vector<std::string>());
  Package("own", true, "another");  // no part of a name counts
  EXPECT_EQ(Warnings(kMesh, kMeant).size(), 1u);
}

TEST_F(PackagesTest, CodesInUrisAreDecoded) {
  fs::create_directories(root_ / "own/my meshes");
  Write("own/my meshes/100%25.obj", EllObj());
  Write("own/my meshes/100%.obj", kTetrahedron);
  const std::string own = (root_ / "own").string();
  for (const std::string& begin :
       {"file://" + own, "file://localhost" + own, std::string("package://own")}) {
    SCOPED_TRACE(begin);
    EXPECT_TRUE(Warnings(begin + "/my%20meshes/100%25.obj", kGuessed).empty());
    EXPECT_TRUE(
        Warnings(begin + "/my meshes/100%25.obj", kMeant).empty());  // is there as it stands
    EXPECT_TRUE(Warnings(begin + "/my%20meshes/100%.obj", kGuessed).empty());
    EXPECT_TRUE(Warnings(begin + "//my meshes/100%.obj", kGuessed).empty());
  }
}

}  // namespace
}  // namespace regrasp
