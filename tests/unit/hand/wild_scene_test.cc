/// Mesh files with a scene of nodes, Collada and glTF: what the nodes say holds.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "core/hand/mesh.h"
#include "tests/unit/hand/wild_files.h"

namespace regrasp {
namespace {

/// A Collada file of the L [m]. `nodes`: of the scene; geometry "g" is the L.
std::string Collada(const std::string& nodes) {
  std::string points, indices;
  int corner = 0;
  for (const Corners& corners : Ell())
    for (const Vector3d& p : corners) {
      points += fmt::format("{} {} {} ", p.x() / 1000, p.y() / 1000, p.z() / 1000);
      indices += fmt::format("{} ", corner++);
    }
  return fmt::format(
      R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="meter" meter="1"/><up_axis>Z_UP</up_axis></asset><library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="180">{}</float_array><technique_common><accessor source="#a" count="60" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="20"><input semantic="VERTEX" source="#v" offset="0"/>
<p>{}</p></triangles></mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s">{}
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)",
      points, indices, nodes);
}

std::string Word(std::size_t number) {
  const auto word = static_cast<std::uint32_t>(number);
  return {reinterpret_cast<const char*>(&word), sizeof(word)};
}

std::string Container(std::string json, std::string bytes) {
  json.append((4 - json.size() % 4) % 4, ' ');
  bytes.append((4 - bytes.size() % 4) % 4, '\0');
  return "glTF" + Word(2) + Word(12 + 8 + json.size() + 8 + bytes.size()) + Word(json.size()) +
         "JSON" + json + Word(bytes.size()) + std::string("BIN\0", 4) + bytes;
}

/// A binary glTF file of the L [m]. `nodes`: of the scene, of which there are `count`; mesh 0 is
/// the L. `more`: of the JSON object.
std::string Glb(const std::string& nodes, int count = 1, const std::string& more = "") {
  std::string points;
  for (const Corners& corners : Ell())
    for (const Vector3d& p : corners) {
      const Eigen::Vector3f single = (p / 1000).cast<float>();
      points.append(reinterpret_cast<const char*>(single.data()), 12);
    }
  const std::string json = fmt::format(
      R"({{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[{}]}}],"nodes":[{}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],"buffers":[{{"byteLength":{}}}],"bufferViews":[{{"buffer":0,"byteLength":{}}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":{},"type":"VEC3"}}]{}}})",
      count == 1 ? "0" : "0,1", nodes, points.size(), points.size(), points.size() / 12, more);
  return Container(json, points);
}

TEST_F(WildTest, AMirroredNodeOfACollada) {
  for (const char* scale : {"1 1 1", "-1 1 1"}) {
    Write("objects/node.dae",
          Collada(
              fmt::format("<node><scale>{}</scale><instance_geometry url=\"#g\"/></node>", scale)));
    ExpectEll(Load("<mesh filename=\"node.dae\"/>"));
  }
}

// Moves of some millimetres, turns of half a degree, scales of less than a percent.
TEST_F(WildTest, ANodeThatIsNearlyAtTheOriginIsWhereItIs) {
  const std::string quarter = fmt::format("0,0,{},{}", std::sin(M_PI / 720), std::cos(M_PI / 720));
  const struct {
    const char* collada;
    std::string gltf;
    Isometry3d X;
    double scale;
  } cases[] = {{"<translate>0.004 0 -0.009</translate>", "\"translation\":[0.004,0,-0.009]",
                Isometry3d(Eigen::Translation3d(0.004, 0, -0.009)), 1},
               {"<rotate>0 0 1 0.5</rotate>", "\"rotation\":[" + quarter + "]",
                Isometry3d(Eigen::AngleAxisd(M_PI / 360, Vector3d::UnitZ())), 1},
               {"<scale>1.009 1.009 1.009</scale>", "\"scale\":[1.009,1.009,1.009]",
                Isometry3d::Identity(), 1.009}};
  for (const auto& c : cases) {
    Write("objects/near.dae",
          Collada(fmt::format("<node>{}<instance_geometry url=\"#g\"/></node>", c.collada)));
    Write("objects/near.glb", Glb(fmt::format("{{\"mesh\":0,{}}}", c.gltf)));
    for (const char* file : {"near.dae", "near.glb"}) {
      SCOPED_TRACE(std::string(file) + c.collada);
      const TriangleMesh mesh = LoadMesh(root_ / "objects" / file, Vector3d::Ones());
      EXPECT_EQ(mesh.triangles.size(), 20u);
      for (const Corners& corners : Ell())
        for (const Vector3d& corner : corners) {
          const Vector3d p = c.X * (c.scale * corner / 1000);
          double nearest = 1;
          for (const Vector3d& v : mesh.vertices) nearest = std::min(nearest, (v - p).norm());
          EXPECT_LT(nearest, 2e-7);  // single precision
        }
    }
  }
}

TEST_F(WildTest, TwoNodesOfOneMeshNearTheOriginAreTwo) {
  const auto node = [](double z) {
    return fmt::format("<node><translate>0 0 {}</translate><instance_geometry url=\"#g\"/></node>",
                       z);
  };
  Write("objects/two.dae", Collada(node(-0.008) + node(0.008)));
  Write("objects/two.glb", Glb("{\"mesh\":0,\"translation\":[0,0,-0.008]},"
                               "{\"mesh\":0,\"translation\":[0,0,0.008]}",
                               2));
  for (const char* file : {"two.dae", "two.glb"}) {
    SCOPED_TRACE(file);
    const ObjectModel object = Load(fmt::format("<mesh filename=\"{}\"/>", file));
    EXPECT_EQ(object.triangles.size(), 40u);
    // The L is 20 mm thick: moved apart by 16 mm they are a union 36 mm thick, measured by columns.
    EXPECT_NEAR(ObjectSolid(object).volume, 1.8 * kEllVolume * 1e-9, 0.01 * kEllVolume * 1e-9);
  }
}

std::string Required(const std::string& extension) {
  return ",\"extensionsUsed\":[\"" + extension + "\"],\"extensionsRequired\":[\"" + extension +
         "\"]";
}

// glTF demands it. Read by assimp all the same, each of them gives another body.
TEST_F(WildTest, AGltfExtensionThatIsNotReadIsNamed) {
  const std::string node = "{\"mesh\":0}", mesh = "<mesh filename=\"e.glb\"/>";
  for (const char* extension :
       {"KHR_mesh_quantization", "EXT_meshopt_compression", "EXT_mesh_gpu_instancing"}) {
    Write("objects/e.glb", Glb(node, 1, Required(extension)));
    const std::string refusal = Refusal(mesh);
    EXPECT_NE(refusal.find(fmt::format("e.glb: cannot read the mesh: requires the glTF extension "
                                       "{}, which is not read; export it without",
                                       extension)),
              std::string::npos)
        << refusal;
  }
  Write("objects/e.glb", Glb(node, 1, Required("KHR_materials_unlit")));
  ExpectEll(Load(mesh));
  // Integers without the extension that allows them.
  Write("objects/e.glb", Replaced(Glb(node), "5126", "5122"));
  const std::string refusal = Refusal(mesh);
  EXPECT_NE(refusal.find("its corners are no floats"), std::string::npos) << refusal;
}

/// A box of 24 x 60 x 30 mm, written by draco_encoder -qp 16.
std::string DracoBox() {
  constexpr std::string_view kHex =
      "445241434f02020101000000080c000b0000035f4b1501011001ff00000100090300000201010100"
      "1103011001083301280400ba1c81cccc0000000000000100ffffc832b30040ff3f96990100feffb1"
      "cc0c0000000000000000ffff0000a69b44bc8fc2f5bc8fc275bc8fc2753d10";
  std::string bytes;
  for (std::size_t i = 0; i < kHex.size(); i += 2)
    bytes += static_cast<char>(std::stoi(std::string(kHex.substr(i, 2)), nullptr, 16));
  return bytes;
}

TEST_F(WildTest, DracoCompressionIsRead) {
  const std::string draco = DracoBox();
  const std::string json = fmt::format(
      R"({{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"extensions":{{"KHR_draco_mesh_compression":
{{"bufferView":0,"attributes":{{"POSITION":0}}}}}}}}]}}],"buffers":[{{"byteLength":{}}}],"bufferViews":[{{"buffer":0,"byteLength":{}}}],
"accessors":[{{"componentType":5126,"count":8,"type":"VEC3"}},{{"componentType":5123,"count":36,"type":"SCALAR"}}]{}}})",
      draco.size(), draco.size(), Required("KHR_draco_mesh_compression"));
  Write("objects/draco.glb", Container(json, draco));
  const ObjectModel object = Load("<mesh filename=\"draco.glb\"/>");
  EXPECT_EQ(object.triangles.size(), 12u);
  EXPECT_NEAR(ObjectSolid(object).volume, 0.024 * 0.06 * 0.03, 1e-8);
}

}  // namespace
}  // namespace regrasp
