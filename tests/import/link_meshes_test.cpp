// Meshes of URDF links: where they are looked for, how they hang on their links, and what happens to broken
// ones.
#include "import/link_meshes.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "convert/convert.h"
#include "reading.h"

namespace sinew::import::test {
namespace {

/// A tetrahedron with corners at the origin and at 1, 2, 3 along x, y, z.
const char kStl[] = R"(solid t
facet normal 0 0 -1
outer loop
vertex 0 0 0
vertex 0 2 0
vertex 1 0 0
endloop
endfacet
facet normal 0 -1 0
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 0 3
endloop
endfacet
facet normal -1 0 0
outer loop
vertex 0 0 0
vertex 0 0 3
vertex 0 2 0
endloop
endfacet
facet normal 0.857 0.429 0.286
outer loop
vertex 1 0 0
vertex 0 2 0
vertex 0 0 3
endloop
endfacet
endsolid t
)";

const char kObj[] = "mtllib part.mtl\nv 0 0 0\nv 1 0 0\nv 0 2 0\nusemtl red\nf 1 2 3\n";
const char kMtl[] = "newmtl red\nKd 0.75 0.125 0.125\n";

std::string visual(const std::string& file, const std::string& more = "", const std::string& origin = "") {
  return "<visual>" + origin + "<geometry><mesh filename=\"" + file + "\" " + more + "/></geometry>" +
         "<material name=\"blue\"><color rgba=\"0 0 1 1\"/></material></visual>";
}

/// Two links: the second hangs half a metre above the first, turned by a right angle about x.
std::string robot(const std::string& first, const std::string& second = "") {
  const std::string inertial =
      "<inertial><mass value=\"2\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" "
      "iyz=\"0\"/></inertial>";
  return "<robot name=\"r\"><link name=\"base\">" + inertial + first + "</link><link name=\"arm\">" +
         inertial + second +
         "</link><joint name=\"j\" type=\"revolute\"><origin xyz=\"0 0 0.5\" rpy=\"1.5707963267948966 0 0\"/>"
         "<parent link=\"base\"/><child link=\"arm\"/><axis xyz=\"0 0 1\"/>"
         "<limit lower=\"-1\" upper=\"1\" effort=\"5\" velocity=\"1\"/></joint></robot>";
}

SourceScene read_robot(const std::filesystem::path& file, const Packages& packages = {}) {
  const Outcome outcome = read(file);
  EXPECT_TRUE(outcome.ok) << outcome.error;
  SourceScene scene = outcome.scene;
  read_link_meshes(file.string(), packages, {}, scene);
  return scene;
}

bool notes(const SourceScene& scene, const std::string& words) {
  return std::any_of(scene.notes.begin(), scene.notes.end(),
                     [&](const std::string& note) { return note.find(words) != std::string::npos; });
}

/// Largest coordinates of an asset's mesh, m in model space.
Eigen::Vector3f corner(const Mesh& mesh) {
  Eigen::Vector3f high = Eigen::Vector3f::Constant(-1e9f);
  for (std::size_t v = 0; v < mesh.positions.size(); v += 3)
    high = high.cwiseMax(Eigen::Vector3f(mesh.positions[v], mesh.positions[v + 1], mesh.positions[v + 2]));
  return high;
}

Asset convert_robot(const std::filesystem::path& file, nlohmann::json& report,
                    const nlohmann::json& options = nlohmann::json::object()) {
  Asset asset;
  const convert::Error error = convert::convert_files({file.string()}, options, asset, report);
  EXPECT_FALSE(error) << error.message;
  return asset;
}

TEST(LinkMeshes, HangOnTheirLinksAtRest) {
  const Scratch scratch;
  scratch.write("part.stl", kStl);
  nlohmann::json report;
  const Asset asset = convert_robot(
      scratch.write("r.urdf", robot(visual("part.stl"), visual("part.stl", "scale=\"0.1 0.1 0.1\"",
                                                               "<origin xyz=\"0.2 0 0\"/>"))),
      report);
  ASSERT_EQ(asset.meshes.size(), 2u);
  EXPECT_TRUE(corner(asset.meshes[0]).isApprox(Eigen::Vector3f(1, 2, 3), 1e-6f));
  // y of the arm points up, z back: (0.3, 0.2, 0.3) of the arm is (0.3, −0.3 … 0, 0.5 + 0.2).
  EXPECT_TRUE(corner(asset.meshes[1]).isApprox(Eigen::Vector3f(0.3f, 0, 0.7f), 1e-5f))
      << corner(asset.meshes[1]).transpose();
  for (const std::uint16_t joint : asset.meshes[1].joints) EXPECT_EQ(joint, 1);
  ASSERT_EQ(asset.inverse_bind.size(), 2u);
  EXPECT_LT((asset.inverse_bind[1] * Vec3<float>(0, 0, 0.5f)).norm(), 1e-6f);
  ASSERT_EQ(asset.materials.size(), 1u) << "both are blue";
  EXPECT_EQ(asset.materials[0].base_color[2], 1.f);
}

// Every face of the solid looks outwards: signed volumes of a closed mesh add up to its own, 1·2·3/6.
TEST(LinkMeshes, MirrorsTurnTheTrianglesWithThem) {
  const Scratch scratch;
  scratch.write("part.stl", kStl);
  nlohmann::json report;
  const Asset asset =
      convert_robot(scratch.write("r.urdf", robot(visual("part.stl", "scale=\"-1 1 1\""))), report);
  ASSERT_GE(asset.meshes.size(), 1u);
  const Mesh& mesh = asset.meshes[0];
  double volume = 0;
  const auto at = [&](std::size_t k) {
    const float* p = &mesh.positions[3 * mesh.indices[k]];
    return Vec3<double>(double(p[0]), double(p[1]), double(p[2]));
  };
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3)
    volume += at(t).dot(at(t + 1).cross(at(t + 2))) / 6;
  EXPECT_NEAR(volume, 1, 1e-6);
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
    const Vec3<double> across = (at(t + 1) - at(t)).cross(at(t + 2) - at(t));
    const float* n = &mesh.normals[3 * mesh.indices[t]];
    EXPECT_GT(across.normalized().dot(Vec3<double>(double(n[0]), double(n[1]), double(n[2]))), 0.99);
  }
}

TEST(LinkMeshes, PackagesAreFoundByNameUpwardsAndBeside) {
  const Scratch scratch;
  scratch.write("ws/robot_description/meshes/a.stl", kStl);
  scratch.write("elsewhere/meshes/b.stl", kStl);
  scratch.write("ws/robot_description/urdf/meshes/c.stl", kStl);
  const auto file = scratch.write(
      "ws/robot_description/urdf/r.urdf",
      robot(visual("package://robot_description/meshes/a.stl") + visual("package://other/meshes/b.stl") +
            visual("package://nobody/meshes/c.stl") + visual("../meshes/a.stl")));
  EXPECT_EQ(read_robot(file, {{"other", scratch.path("elsewhere").string()}}).meshes.size(), 4u);
  const SourceScene without = read_robot(file);
  EXPECT_EQ(without.meshes.size(), 3u);
  EXPECT_TRUE(notes(without,
                    "1 mesh not found, the first 'package://other/meshes/b.stl'; say where its package is "
                    "(--package other=DIRECTORY)"));
}

TEST(LinkMeshes, NothingElseIsOpened) {
  const Scratch scratch;
  scratch.write("secret.stl", kStl);
  scratch.write("a/b/c/near.stl", kStl);
  const auto file = scratch.write(
      "a/b/c/r.urdf",
      robot(visual("../../../secret.stl") + visual("file://" + scratch.path("secret.stl").string()) +
            visual("package://c/../../../secret.stl") + visual("package://../../secret.stl") +
            visual("file://" + std::filesystem::canonical(scratch.path("a/b/c")).string() + "/near.stl")));
  const SourceScene scene = read_robot(file);
  EXPECT_EQ(scene.meshes.size(), 1u);
  EXPECT_TRUE(notes(scene, "4 meshes not found"));
}

TEST(LinkMeshes, BrokenOnesAreLeftOutAndTheRestStays) {
  const Scratch scratch;
  scratch.write("good.stl", kStl);
  scratch.write("empty.stl", "");
  scratch.write("text.stl", "this is no mesh at all, whatever its name says");
  scratch.write("strange.xyz", "0 0 0");
  const SourceScene scene =
      read_robot(scratch.write("r.urdf", robot(visual("good.stl") + visual("empty.stl") + visual("text.stl") +
                                               visual("strange.xyz"))));
  EXPECT_EQ(scene.meshes.size(), 1u);
  EXPECT_TRUE(notes(scene, "mesh 'empty.stl' left out"));
  EXPECT_TRUE(notes(scene, "mesh 'text.stl' left out"));
  EXPECT_TRUE(notes(scene, "mesh 'strange.xyz' left out: not an STL, OBJ, COLLADA or glTF file"));
}

TEST(LinkMeshes, MaterialsOfTheirOwnGoBeforeTheUrdfs) {
  const Scratch scratch;
  scratch.write("part.obj", kObj);
  scratch.write("part.mtl", kMtl);
  const SourceScene scene = read_robot(scratch.write("r.urdf", robot(visual("part.obj"))));
  ASSERT_EQ(scene.meshes.size(), 1u);
  ASSERT_EQ(scene.materials.size(), 1u);
  EXPECT_EQ(scene.materials[0].name, "red");
  EXPECT_FLOAT_EQ(scene.materials[0].base_color[0], 0.75f);
}

/// A COLLADA file of one triangle, whose axis ROS ignores and whose unit it does not.
std::string collada(const std::string& up) {
  return R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimetre" meter="0.01"/><up_axis>)" +
         up + R"(</up_axis></asset><library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="9">0 0 0 100 0 0 0 200 0</float_array><technique_common>
<accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s"><node id="n">
<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

TEST(LinkMeshes, ColladaKeepsItsUnitAndNotItsAxis) {
  for (const char* up : {"Y_UP", "Z_UP"}) {
    const Scratch scratch;
    scratch.write("part.dae", collada(up));
    nlohmann::json report;
    const Asset asset = convert_robot(scratch.write("r.urdf", robot(visual("part.dae"))), report);
    ASSERT_GE(asset.meshes.size(), 1u) << report.dump(1);
    EXPECT_TRUE(corner(asset.meshes[0]).isApprox(Eigen::Vector3f(1, 2, 0), 1e-5f))
        << up << ": " << corner(asset.meshes[0]).transpose();
  }
}

TEST(LinkMeshes, LinksWithoutOneShowTheirSolids) {
  const Scratch scratch;
  scratch.write("part.stl", kStl);
  const auto file = scratch.write(
      "r.urdf",
      robot(visual("part.stl"), "<visual><geometry><box size=\"0.2 0.4 0.6\"/></geometry></visual>"));
  nlohmann::json report;
  const Asset asset = convert_robot(file, report);
  ASSERT_EQ(asset.meshes.size(), 2u);
  EXPECT_TRUE(corner(asset.meshes[1]).isApprox(Eigen::Vector3f(0.1f, 0.3f, 0.7f), 1e-5f))
      << corner(asset.meshes[1]).transpose();
}

TEST(LinkMeshes, GiveLinksThatHaveNoPrimitiveAShape) {
  const Scratch scratch;
  scratch.write("part.stl", kStl);
  nlohmann::json report;
  const Asset asset = convert_robot(scratch.write("r.urdf", robot(visual("part.stl"))), report);
  ASSERT_FALSE(asset.skeleton.colliders.empty());
  const Collider& shape = asset.skeleton.colliders[0];
  EXPECT_EQ(shape.joint, 0);
  ASSERT_EQ(shape.shape, Shape::kBox) << "1 × 2 × 3 m in a box take less than in a capsule";
  EXPECT_TRUE(shape.size.isApprox(Vec3<double>(0.5, 1, 1.5), 1e-9));
  EXPECT_TRUE(shape.local.translation.isApprox(Vec3<double>(0.5, 1, 1.5), 1e-9));
}

TEST(LinkMeshes, PackagesComeFromTheOptions) {
  const Scratch scratch;
  scratch.write("shelf/part.stl", kStl);
  const auto file = scratch.write("robots/r.urdf", robot(visual("package://p/part.stl")));
  nlohmann::json report;
  const nlohmann::json options = {{"packages", {{"p", scratch.path("shelf").string()}}}};
  EXPECT_EQ(convert_robot(file, report, options).meshes.size(), 1u);
  EXPECT_TRUE(convert_robot(file, report).meshes.empty());
}

}  // namespace
}  // namespace sinew::import::test
