/// Objects: what their files say, and what of it is refused.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/unit/hand/model_files.h"

namespace regrasp {
namespace {

TEST_F(LoaderTest, RefusesBadObjects) {
  struct Case {
    const char *from, *to;
    std::initializer_list<const char*> words;
  };
  const Case cases[] = {
      {"radius=\"0.025\"",
       "radius=\"-1\"",
       {"ball.urdf", "link \"object\"", "<sphere> radius", "> 0"}},
      {"radius=\"0.025\"", "radius=\"25\"", {"ball.urdf", "bounding radius", "25", "0.001 .. 1"}},
      {"value=\"0.08\"", "value=\"nan\"", {"ball.urdf"}},
      {"<inertial>",
       "<inertial><origin xyz=\"0 0 0.03\"/>",
       {"ball.urdf", "centre of mass", "outside of the shape"}},
      {"</robot>",
       "<link name=\"b\"/><joint name=\"j\" type=\"revolute\"><parent link=\"object\"/><child "
       "link=\"b\"/><limit lower=\"0\" upper=\"1\" effort=\"1\"/></joint></robot>",
       {"ball.urdf", "joint \"j\"", "\"revolute\"", "one rigid body; allowed is fixed"}},
      {"<sphere radius=\"0.025\"/>", "<mesh filename=\"no.obj\"/>", {"no.obj", "not found"}},
      {"<sphere radius=\"0.025\"/>",
       "<mesh filename=\"package://a/b.obj\"/>",
       {"ball.urdf", "package://a/b.obj"}},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(std::string(c.from) + " -> " + c.to);
    EditBall(c.from, c.to);
    ExpectRefused(c.words);
  }
  std::string text = kBallUrdf;
  const std::size_t begin = text.find("<inertial>");
  Write("objects/ball.urdf", text.erase(begin, text.find("</inertial>") + 11 - begin));
  ExpectRefused({"ball.urdf", "link \"object\"", "<inertial>"});
}

TEST_F(LoaderTest, ReadsFrictionBesideTheObject) {
  Write("objects/ball.toml", "friction = 0.35\n");
  EXPECT_EQ(Load().object.friction, 0.35);
  Write("objects/ball.toml", "friction = 1.5\n");
  ExpectRefused({"ball.toml:1", "friction", "1.5", "1"});
  Write("objects/ball.toml", "frictoin = 0.5\n");
  ExpectRefused({"ball.toml:1", "did you mean 'friction'?"});
}

TEST_F(LoaderTest, ReadsClosedMeshesAndCentresThem) {
  Write("objects/tetra.obj", kTetrahedron);
  EditBall("<sphere radius=\"0.025\"/>", "<mesh filename=\"tetra.obj\" scale=\"2 2 2\"/>");
  Write("objects/ball.urdf",
        Replaced(Replaced(kBallUrdf, "<sphere radius=\"0.025\"/>",
                          "<mesh filename=\"tetra.obj\" scale=\"2 2 2\"/>"),
                 "<inertial>", "<inertial><origin xyz=\"0.015 0.015 0.015\"/>"));
  const ObjectModel object = Load().object;
  EXPECT_EQ(object.kind, ObjectModel::Kind::kMesh);
  ASSERT_EQ(object.vertices_O.size(), 4u);
  ASSERT_EQ(object.triangles.size(), 4u);
  Vector3d sum = Vector3d::Zero();
  for (const Vector3d& v : object.vertices_O) sum += v;
  EXPECT_LT(sum.norm(), 1e-8);  // mesh files are read in single precision
  EXPECT_NEAR(object.bounding_radius, std::sqrt(0.045 * 0.045 + 2 * 0.015 * 0.015), 1e-8);
}

TEST_F(LoaderTest, RefusesOpenAndInsideOutMeshes) {
  EditBall("<sphere radius=\"0.025\"/>", "<mesh filename=\"tetra.obj\"/>");
  Write("objects/tetra.obj",
        Replaced(Replaced(kTetrahedron, "f 2 3 4\n", ""), "f 1 3 2\n", "f 1 3 2\nf 1 2 3\n"));
  ExpectRefused({"tetra.obj", "not closed: 2 of 6 edges are open, the first at (0, 0.015, 0.015)",
                 "two triangles", "Fill Holes"});
  // A face within: the one on which two tetrahedra meet.
  Write("objects/tetra.obj",
        std::string(kTetrahedron) + "v 0.03 0.03 0.03\nf 2 3 5\nf 3 4 5\nf 4 2 5\n");
  ExpectRefused({"tetra.obj", "not one surface: 3 of 9 edges belong to three triangles or more",
                 "Interior Faces"});
  Write("objects/tetra.obj", Replaced(kTetrahedron, "f 2 3 4\n", "f 2 4 3\n"));
  ExpectRefused({"tetra.obj",
                 "mesh has no holes, but along 3 of 6 edges triangles are turned against their "
                 "neighbours, the first at (0.015, 0.015, 0)",
                 "Recalculate Outside"});
  Write("objects/tetra.obj",
        Replaced(
            Replaced(Replaced(Replaced(kTetrahedron, "f 1 3 2", "f 1 2 3"), "f 1 2 4", "f 1 4 2"),
                     "f 1 4 3", "f 1 3 4"),
            "f 2 3 4", "f 2 4 3"));
  ExpectRefused({"tetra.obj", "volume is -", "counter-clockwise"});
  Write("objects/tetra.obj", "f one two\n");
  ExpectRefused({"tetra.obj"});
}

}  // namespace
}  // namespace regrasp
