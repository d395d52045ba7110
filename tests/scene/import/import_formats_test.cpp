// Small files of each format, written here and read by the module "scenes".
#include <array>
#include <cmath>
#include <cstring>

#include <gmock/gmock.h>

#include "core/system/error.h"
#include "scene/import/import_file.h"
#include "tests/scene/gltf/encode_image.h"
#include "tests/scene/import/import_files.h"

namespace carousel::scene::import_formats_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

using ImportFormats = ImportFiles;

/// Two triangles that make a square from the origin on.
void expect_square(const Scene& scene, float side) {
  EXPECT_EQ(scene.instanced_triangle_count(), 2u);
  const Aabb box = scene.bounds();
  EXPECT_EQ(box.lo, Vec3(0));
  EXPECT_EQ(box.hi, Vec3(side, side, 0));
}

const char* const kObj =
    "mtllib a.mtl\no Square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n"
    "usemtl red\nf 1/1/1 2/2/1 3/3/1 4/4/1\n";

TEST_F(ImportFormats, ObjWithMaterials) {
  write("a.obj", kObj);
  write("a.mtl", "newmtl red\nKd 0.5 0.25 0\nKe 0 0 2\nNs 30\nd 0.75\nNi 1.33\n");
  const Scene scene = load("a.obj");
  expect_square(scene, 1);
  EXPECT_THAT(warnings_, IsEmpty());
  const Mesh& mesh = scene.meshes.at(0);
  EXPECT_EQ(mesh.positions.size(), 4u);
  EXPECT_EQ(mesh.normals.at(0), Vec3(0, 0, 1));
  for (std::size_t v = 0; v < 4; ++v)
    EXPECT_EQ(mesh.uv0[v], Vec2(mesh.positions[v].x, 1 - mesh.positions[v].y)) << "glTF's v grows downwards";
  const Material& m = scene.materials.at(mesh.triangle_materials.at(0).value);
  EXPECT_EQ(m.name, "red");
  EXPECT_EQ(m.base_color, Vec4(0.5f, 0.25f, 0, 0.75f));
  EXPECT_EQ(m.alpha_mode, AlphaMode::kBlend);
  EXPECT_EQ(m.emissive, Vec3(0, 0, 2));
  EXPECT_EQ(m.metallic, 0);
  EXPECT_NEAR(m.roughness, std::sqrt(std::sqrt(2.0 / 32)), 1e-6);
  EXPECT_FLOAT_EQ(m.ior, 1.33f);
  EXPECT_TRUE(m.double_sided);
  EXPECT_EQ(scene.nodes.back().name, "Square");
  EXPECT_TRUE(scene.added.camera);
}

TEST_F(ImportFormats, AMissingMaterialFileIsAWarningWithItsPlace) {
  write("a.obj", kObj);
  expect_square(load("a.obj"), 1);
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("failed to locate material red"),
                                     HasSubstr("a.obj: a.obj:1: the file 'a.mtl' is not there")));
}

TEST_F(ImportFormats, TexturesAreFoundBesideTheModelAndMissingOnesAreTold) {
  const std::vector<unsigned char> png = encode_png(2, 1, 4, {255, 0, 0, 255, 0, 255, 0, 255});
  write("wood.png", std::string(png.begin(), png.end()));
  write("a.obj", kObj);
  write("a.mtl", "newmtl red\nmap_Kd C:\\models\\wood.png\nmap_Ke none.png\nmap_Bump bumps.png\n");
  const Scene scene = load("a.obj");
  const Material& m = scene.materials.at(scene.meshes[0].triangle_materials.at(0).value);
  ASSERT_TRUE(m.base_color_texture);
  EXPECT_FALSE(m.emissive_texture);
  const Image& image = scene.images.at(scene.textures.at(m.base_color_texture->texture.value).image.value);
  EXPECT_EQ(image.width, 2u);
  EXPECT_EQ(image.rgba[1], 0);
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("a.obj: a.mtl:3: the image 'none.png' is not there"),
                                     HasSubstr("without a counterpart are ignored: textures of height (bump maps)")));
  write("wood.png", "no picture");
  EXPECT_THAT(error_of("a.obj"), HasSubstr("a.mtl:2: the image wood.png is neither PNG nor JPEG nor WebP"));
}

TEST_F(ImportFormats, FilesOutsideTheTwoFoldersAboveAreNotOpened) {
  write("a.obj", "mtllib ../../../../../../etc/passwd\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  load("a.obj");
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("a.obj:1: the file 'passwd' is not there, or is outside")));
}

TEST_F(ImportFormats, PlyWithColours) {
  write("a.ply",
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n"
        "property list uchar int vertex_indices\nend_header\n"
        "0 0 0 255 0 0\n2 0 0 255 0 0\n2 2 0 255 0 0\n0 2 0 0 0 255\n4 0 1 2 3\n");
  const Scene scene = load("a.ply");
  expect_square(scene, 2);
  const Mesh& mesh = scene.meshes.at(0);
  ASSERT_EQ(mesh.colors.size(), mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    EXPECT_EQ(mesh.colors[v].z, mesh.positions[v] == Vec3(0, 2, 0) ? 1 : 0);
}

TEST_F(ImportFormats, StlAsTextAndBinary) {
  write("a.stl",
        "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 3 0 0\nvertex 3 3 0\nendloop\nendfacet\n"
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 3 3 0\nvertex 0 3 0\nendloop\nendfacet\nendsolid a\n");
  expect_square(load("a.stl"), 3);
  std::string binary(80, ' ');
  const auto put = [&](const auto& value) { binary.append(reinterpret_cast<const char*>(&value), sizeof value); };
  put(std::uint32_t{2});
  for (const auto& triangle : {std::array<float, 12>{0, 0, 1, 0, 0, 0, 3, 0, 0, 3, 3, 0},
                               std::array<float, 12>{0, 0, 1, 0, 0, 0, 3, 3, 0, 0, 3, 0}}) {
    put(triangle);
    put(std::uint16_t{0});
  }
  write("b.stl", binary);
  expect_square(load("b.stl"), 3);
}

TEST_F(ImportFormats, Off) {
  write("a.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n");
  expect_square(load("a.off"), 1);
}

const char* const kCollada = R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="meter" meter="1"/><up_axis>Y_UP</up_axis></asset>
<library_cameras><camera id="c"><optics><technique_common><perspective><xfov>60</xfov><aspect_ratio>1</aspect_ratio>
<znear>0.1</znear><zfar>100</zfar></perspective></technique_common></optics></camera></library_cameras>
<library_lights><light id="l"><technique_common><point><color>1 2 3</color></point></technique_common></light>
</library_lights>
<library_effects><effect id="e"><profile_COMMON><technique sid="t"><lambert><diffuse><color>0 1 0 1</color></diffuse>
</lambert></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m" name="green"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="pa" count="12">0 0 0 1 0 0 1 1 0 0 1 0
</float_array><technique_common><accessor source="#pa" count="4" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles material="x" count="2"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2 0 2 3</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s">
<node id="n" name="Plate"><matrix>2 0 0 0 0 2 0 0 0 0 2 0 0 0 0 1</matrix><instance_geometry url="#g"><bind_material>
<technique_common><instance_material symbol="x" target="#m"/></technique_common></bind_material></instance_geometry></node>
<node id="k" name="Eye"><translate>0 0 5</translate><instance_camera url="#c"/></node>
<node id="i" name="Lamp"><translate>1 2 3</translate><instance_light url="#l"/></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";

TEST_F(ImportFormats, ColladaWithCameraAndLight) {
  write("a.dae", kCollada);
  const Scene scene = load("a.dae");
  expect_square(scene, 2);
  EXPECT_EQ(scene.materials.at(scene.meshes.at(0).triangle_materials.at(0).value).base_color, Vec4(0, 1, 0, 1));
  ASSERT_EQ(scene.cameras.size(), 1u);
  EXPECT_FALSE(scene.added.camera);
  EXPECT_EQ(scene.cameras[0].position, Vec3(0, 0, 5));
  EXPECT_EQ(scene.cameras[0].back, Vec3(0, 0, 1));
  // Assimp 5.2 loses the angle of COLLADA's cameras.
  EXPECT_GT(scene.cameras[0].yfov, 0.5f);
  if (scene.cameras[0].yfov == Camera{}.yfov)
    EXPECT_THAT(warnings_, testing::Contains(HasSubstr("the angle of view of the camera \"k\" cannot be read")));
  else
    EXPECT_NEAR(scene.cameras[0].yfov, 60 * 3.14159265 / 180, 1e-4);
  ASSERT_EQ(scene.lights.size(), 1u);
  EXPECT_EQ(scene.lights[0].position, Vec3(1, 2, 3));
  EXPECT_EQ(scene.lights[0].intensity, Vec3(1, 2, 3));
  std::vector<std::string> names;
  for (const NamedNode& node : scene.nodes) names.push_back(node.name);
  EXPECT_THAT(names, testing::Contains("n")) << "Assimp names COLLADA's nodes by their ids";
}

const char* const kFbx = R"(; FBX 7.4.0 project file
FBXHeaderExtension: { FBXHeaderVersion: 1003
 FBXVersion: 7400 }
GlobalSettings: { Version: 1000 }
Objects: {
 Geometry: 10, "Geometry::Square", "Mesh" {
  Vertices: *12 { a: 0,0,0,1,0,0,1,1,0,0,1,0 }
  PolygonVertexIndex: *4 { a: 0,1,2,-4 }
  GeometryVersion: 124
  LayerElementMaterial: 0 { Version: 101
   Name: ""
   MappingInformationType: "AllSame"
   ReferenceInformationType: "IndexToDirect"
   Materials: *1 { a: 0 } }
  Layer: 0 { Version: 100
   LayerElement: { Type: "LayerElementMaterial"
    TypedIndex: 0 } }
 }
 Model: 20, "Model::Board", "Mesh" { Version: 232 }
 Material: 30, "Material::blue", "" { Version: 102
  ShadingModel: "lambert"
  Properties70: { P: "DiffuseColor", "Color", "", "A",0,0,1 } }
}
Connections: {
 C: "OO",20,0
 C: "OO",10,20
 C: "OO",30,20
}
)";

TEST_F(ImportFormats, Fbx) {
  write("a.fbx", kFbx);
  const Scene scene = load("a.fbx");
  expect_square(scene, 1);
  EXPECT_EQ(scene.materials.at(scene.meshes.at(0).triangle_materials.at(0).value).base_color, Vec4(0, 0, 1, 1));
}

TEST_F(ImportFormats, PartsOfANodeAreOneMesh) {
  write("a.obj", "mtllib a.mtl\no Two\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl one\nf 1 2 3\nusemtl two\nf 1 3 4\n");
  write("a.mtl", "newmtl one\nKd 1 0 0\nnewmtl two\nKd 0 1 0\n");
  const Scene scene = load("a.obj");
  expect_square(scene, 1);
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_NE(scene.meshes[0].triangle_materials[0], scene.meshes[0].triangle_materials[1]);
}

TEST_F(ImportFormats, WhatIsNoSceneIsRefused) {
  write("a.obj", "v 0 0 0\n");
  EXPECT_THAT(error_of("a.obj"), testing::AnyOf(HasSubstr("shows no triangles"), HasSubstr("cannot be read: Assimp:")));
  write("a.xyz", "nothing that anyone reads");
  EXPECT_THAT(error_of("a.xyz"), HasSubstr("cannot be read: Assimp:"));
  EXPECT_EQ(error_of("none.obj"), "no such file");
}

TEST_F(ImportFormats, APlyThatAnnouncesMoreThanItHoldsIsRefusedAtOnce) {
  const std::string whole =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  const auto with = [&](const std::string& old, const std::string& other) {
    std::string text = whole;
    write("a.ply", text.replace(text.find(old), old.size(), other));
    return error_of("a.ply");
  };
  EXPECT_EQ(with("x", "x"), "loaded");
  EXPECT_EQ(with("vertex 3", "vertex 000003"), "loaded");
  EXPECT_EQ(with("end_header", "end"), "the header does not end: there is no end_header");
  EXPECT_EQ(with("vertex 3", "vertex 4000000000"),
            "line 3: the header announces 4000000000 elements \"vertex\", and the file has 189 bytes");
  EXPECT_THAT(with("face 1", "face 99999999999999999999999"), HasSubstr("line 7: the header announces 9999"));
}

TEST_F(ImportFormats, TheFilesOfAModelAreTold) {
  write("wood.png", "x");
  write("a.obj", kObj);
  write("a.mtl", "newmtl red\nmap_Kd wood.png\nmap_Ke none.png\n");
  std::vector<std::string> names;
  for (const std::filesystem::path& file : importer_.files_of(folder_ / "a.obj")) names.push_back(file.filename());
  EXPECT_THAT(names, ElementsAre("a.obj", "a.mtl", "wood.png", "none.png"));
}

TEST_F(ImportFormats, GltfIsToldFromOthers) {
  write("a.json", "  {\"asset\": {}}");
  write("a.obj", kObj);
  write("b.glb", "anything");
  EXPECT_TRUE(is_gltf(folder_ / "a.json"));
  EXPECT_TRUE(is_gltf(folder_ / "b.glb"));
  EXPECT_FALSE(is_gltf(folder_ / "a.obj"));
}

}  // namespace
}  // namespace carousel::scene::import_formats_test
