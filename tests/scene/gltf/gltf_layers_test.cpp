#include "tests/scene/gltf/packed_model.h"

namespace carousel::scene {
namespace {

using Json = nlohmann::json;

TEST(GltfLayers, EveryFieldIsRead) {
  const Scene scene = every_extension().load();
  const Material& m = scene.materials.at(0);
  EXPECT_EQ(m.ior, 1.4f);
  EXPECT_EQ(m.transmission.weight, 0.5f);
  EXPECT_TRUE(m.transmission.texture);
  EXPECT_EQ(m.volume.thickness, 2);
  EXPECT_TRUE(m.volume.thickness_texture);
  EXPECT_EQ(m.volume.attenuation_distance, 3);
  EXPECT_EQ(m.volume.attenuation_color, Vec3(0.5f, 0.25f, 1));
  EXPECT_EQ(m.specular.weight, 0.75f);
  EXPECT_EQ(m.specular.color, Vec3(2, 0.5f, 0));
  EXPECT_TRUE(m.specular.texture && m.specular.color_texture);
  EXPECT_EQ(m.clearcoat.weight, 0.25f);
  EXPECT_EQ(m.clearcoat.roughness, 0.125f);
  EXPECT_EQ(m.clearcoat.normal_scale, 0.5f);
  EXPECT_TRUE(m.clearcoat.texture && m.clearcoat.roughness_texture && m.clearcoat.normal_texture);
  EXPECT_EQ(m.sheen.color, Vec3(0.5f, 0, 0.25f));
  EXPECT_EQ(m.sheen.roughness, 0.625f);
  EXPECT_TRUE(m.sheen.color_texture && m.sheen.roughness_texture);
  EXPECT_EQ(m.iridescence.weight, 0.875f);
  EXPECT_EQ(m.iridescence.ior, 1.75f);
  EXPECT_EQ(m.iridescence.thickness_min, 50);
  EXPECT_EQ(m.iridescence.thickness_max, 500);
  EXPECT_TRUE(m.iridescence.texture && m.iridescence.thickness_texture);
  EXPECT_EQ(m.anisotropy.strength, 0.375f);
  EXPECT_EQ(m.anisotropy.rotation, -1.5f);
  EXPECT_TRUE(m.anisotropy.texture);
  EXPECT_EQ(scene.images.size(), 1u);
  EXPECT_EQ(scene.images[0].rgba[5], 77);
}

Material material(const char* extension, const Json& values) {
  GltfBuilder b = GltfBuilder::square();
  b.push("materials", {{"extensions", {{extension, values}}}});
  return b.load().materials.at(0);
}

TEST(GltfLayers, AnEmptyExtensionSaysItsDefaults) {
  EXPECT_EQ(material("KHR_materials_transmission", Json::object()).transmission.weight, 0);
  EXPECT_EQ(material("KHR_materials_specular", Json::object()).specular.weight, 1);
  EXPECT_EQ(material("KHR_materials_ior", Json::object()).ior, 1.5f);
  const Material::Volume volume = material("KHR_materials_volume", Json::object()).volume;
  EXPECT_EQ(volume.thickness, 0);
  EXPECT_EQ(volume.attenuation_distance, std::numeric_limits<float>::infinity());
  const auto iridescence = material("KHR_materials_iridescence", {{"iridescenceFactor", 1}}).iridescence;
  EXPECT_EQ(iridescence.ior, 1.3f);
  EXPECT_EQ(iridescence.thickness_min, 100);
  EXPECT_EQ(iridescence.thickness_max, 400);
}

// The ranges are those of the extensions' schemas.
TEST(GltfLayers, FactorsAreMovedIntoTheirRanges) {
  EXPECT_EQ(material("KHR_materials_ior", {{"ior", 0}}).ior, 0);
  EXPECT_EQ(material("KHR_materials_ior", {{"ior", 0.5}}).ior, 1);
  EXPECT_EQ(material("KHR_materials_ior", {{"ior", -2}}).ior, 1);
  EXPECT_EQ(material("KHR_materials_transmission", {{"transmissionFactor", 3}}).transmission.weight, 1);
  const auto volume =
      material("KHR_materials_volume",
               {{"thicknessFactor", -1}, {"attenuationDistance", -1}, {"attenuationColor", {-1, 2, 0.5}}})
          .volume;
  EXPECT_EQ(volume.thickness, 0);
  EXPECT_GT(volume.attenuation_distance, 0);
  EXPECT_EQ(volume.attenuation_color, Vec3(0, 1, 0.5f));
  const auto specular =
      material("KHR_materials_specular", {{"specularFactor", 7}, {"specularColorFactor", {-1, 9, 1}}}).specular;
  EXPECT_EQ(specular.weight, 1);
  EXPECT_EQ(specular.color, Vec3(0, 9, 1));
  const auto coat =
      material("KHR_materials_clearcoat", {{"clearcoatFactor", 2}, {"clearcoatRoughnessFactor", -1}}).clearcoat;
  EXPECT_EQ(coat.weight, 1);
  EXPECT_EQ(coat.roughness, 0);
  const auto sheen =
      material("KHR_materials_sheen", {{"sheenColorFactor", {2, -1, 0.5}}, {"sheenRoughnessFactor", 2}}).sheen;
  EXPECT_EQ(sheen.color, Vec3(1, 0, 0.5f));
  EXPECT_EQ(sheen.roughness, 1);
  const auto iridescence =
      material("KHR_materials_iridescence",
               {{"iridescenceFactor", 2}, {"iridescenceIor", 0.5}, {"iridescenceThicknessMinimum", -5}})
          .iridescence;
  EXPECT_EQ(iridescence.weight, 1);
  EXPECT_EQ(iridescence.ior, 1);
  EXPECT_EQ(iridescence.thickness_min, 0);
  EXPECT_EQ(material("KHR_materials_anisotropy", {{"anisotropyStrength", 2}}).anisotropy.strength, 1);
}

// A layer of weight 0 is not read: neither its other values nor its images, which are broken here.
TEST(GltfLayers, LayersOfNoWeightAreNotThere) {
  GltfBuilder b = every_extension();
  b.json["textures"][0] = {{"source", b.push("images", {{"bufferView", b.view(std::vector<char>(64, 'x'))}})}};
  EXPECT_THROW(b.load(), SceneError);
  Json& extensions = b.json["materials"][0]["extensions"];
  extensions["KHR_materials_transmission"]["transmissionFactor"] = 0;
  extensions["KHR_materials_volume"]["thicknessFactor"] = 0;
  extensions.erase("KHR_materials_specular");
  extensions["KHR_materials_clearcoat"]["clearcoatFactor"] = 0;
  extensions["KHR_materials_sheen"]["sheenColorFactor"] = {0, 0, 0};
  extensions["KHR_materials_iridescence"]["iridescenceFactor"] = 0;
  extensions["KHR_materials_anisotropy"]["anisotropyStrength"] = 0;
  b.json["materials"][0]["emissiveTexture"] = {{"index", 0}};
  const Scene scene = b.load();
  EXPECT_TRUE(scene.images.empty());
  EXPECT_EQ(scene.materials[0].clearcoat.roughness, 0);
  EXPECT_EQ(scene.materials[0].iridescence.ior, 1.3f);
}

TEST(GltfLayers, TextureTransformAndSecondSetOnEverySlot) {
  GltfBuilder b = every_extension();
  const Json info = {
      {"index", 0},
      {"texCoord", 1},
      {"extensions", {{"KHR_texture_transform", {{"offset", {3, 4}}, {"scale", {5, 6}}, {"rotation", 7}}}}}};
  Json& material = b.json["materials"][0];
  for (auto& [name, extension] : material["extensions"].items()) {
    for (auto& [key, value] : extension.items())
      if (key.ends_with("Texture")) value = info;
  }
  material["emissiveFactor"] = {1, 1, 1};
  for (const char* slot : {"emissiveTexture", "normalTexture"}) material[slot] = info;
  for (const char* slot : {"baseColorTexture", "metallicRoughnessTexture"})
    material["pbrMetallicRoughness"][slot] = info;
  const Material m = b.load().materials.at(0);
  for (const auto& use :
       {m.base_color_texture, m.metallic_roughness_texture, m.emissive_texture, m.normal_texture,
        m.transmission.texture, m.volume.thickness_texture, m.specular.texture, m.specular.color_texture,
        m.clearcoat.texture, m.clearcoat.roughness_texture, m.clearcoat.normal_texture, m.sheen.color_texture,
        m.sheen.roughness_texture, m.iridescence.texture, m.iridescence.thickness_texture, m.anisotropy.texture}) {
    ASSERT_TRUE(use);
    EXPECT_EQ(use->uv_set, 1);
    EXPECT_EQ(use->offset, Vec2(3, 4));
    EXPECT_EQ(use->scale, Vec2(5, 6));
    EXPECT_EQ(use->rotation, 7);
  }
}

TEST(GltfLayers, BasisUniversalIsRefusedByNameWhereItIsNeeded) {
  GltfBuilder b = every_extension();
  b.json["textures"][0] = {{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}};
  expect_refused(b, "/materials/0/extensions/KHR_materials_transmission/transmissionTexture", "KHR_texture_basisu");
  b.json["textures"][0]["source"] = 0;  // the fallback will do
  EXPECT_EQ(b.load().images.size(), 1u);
  b.json["extensionsRequired"] = {"KHR_texture_basisu"};
  expect_refused(b, "/extensionsRequired/0", "requires KHR_texture_basisu");
}

TEST(GltfLayers, WebpStandsBeforeItsFallback) {
  GltfBuilder b = every_extension();
  b.json["textures"][0]["source"] = b.push("images", {{"uri", "nowhere.png"}});
  EXPECT_EQ(b.load().images.at(0).width, 3u);
}

// The colour of texels with alpha 0 is kept, because filters read it.
TEST(GltfLayers, WebpKeepsColourWithoutAlpha) {
  GltfBuilder b = every_extension();
  const std::vector<unsigned char> pixels{200, 100, 50, 0, 10, 20, 30, 128};
  b.json["images"][0]["bufferView"] = b.view(webp(2, 1, pixels));
  EXPECT_EQ(b.load().images.at(0).rgba, pixels);
  b.json["images"][0]["bufferView"] =
      b.view(std::vector<char>{'R', 'I', 'F', 'F', 9, 0, 0, 0, 'W', 'E', 'B', 'P', 'V', 'P', '8', 'L', 0});
  expect_refused(b, "/images/0", "the image is broken");
}

TEST(GltfSphere, NodesWithTheExtraAreInstances) {
  GltfBuilder b = GltfBuilder::square();
  b.push("materials", {{"name", "glass"}});
  const auto sphere = [](double radius) { return Json{{"carousel_sphere", {{"radius", radius}, {"material", 0}}}}; };
  const int child = b.push("nodes", {{"extras", sphere(2)}, {"scale", {1, 3, 1}}});
  b.node({{"extras", sphere(2)}, {"translation", {10, 0, 0}}, {"children", {child}}});
  b.node({{"extras", {{"carousel_sphere", {{"radius", 0.5}}}}}});
  b.node({{"extras", "somebody else's"}});
  const Scene scene = b.load();
  ASSERT_EQ(scene.instances.size(), 4u);
  ASSERT_EQ(scene.meshes.size(), 3u);  // equal spheres are one mesh
  EXPECT_EQ(scene.instances[1].mesh, scene.instances[2].mesh);
  const Mesh& mesh = scene.meshes[scene.instances[1].mesh.value];
  EXPECT_EQ(mesh.triangle_count(), 0u);
  ASSERT_EQ(mesh.spheres.size(), 1u);
  EXPECT_EQ(mesh.spheres[0].radius, 2);
  EXPECT_EQ(mesh.spheres[0].center, Vec3(0));
  EXPECT_EQ(mesh.spheres[0].material, MaterialId(0));
  EXPECT_EQ(scene.instances[2].world_from_model.linear[1].y, 3);
  EXPECT_EQ(scene.meshes[2].spheres[0].material, MaterialId(1));  // glTF's default material
  const Aabb box = scene.bounds();
  EXPECT_EQ(box.hi.x, 12);
  EXPECT_EQ(box.hi.y, 6);
  EXPECT_EQ(box.lo.z, -2);
}

TEST(GltfSphere, BadOnesAreRefused) {
  GltfBuilder b = GltfBuilder::square();
  b.json["nodes"][0]["extras"]["carousel_sphere"]["radius"] = 1;
  expect_refused(b, "/nodes/0/extras/carousel_sphere", "has a mesh already");
  b.json["nodes"][0].erase("mesh");
  EXPECT_EQ(b.load().instances.size(), 1u);  // a scene of a sphere alone
  b.json["nodes"][0]["extras"]["carousel_sphere"]["radius"] = 0;
  expect_refused(b, "/nodes/0/extras/carousel_sphere/radius", "expected a number from");
  b.json["nodes"][0]["extras"]["carousel_sphere"] = {{"radius", 1}, {"material", 0}};
  expect_refused(b, "/nodes/0/extras/carousel_sphere/material", "an index into /materials");
}

}  // namespace
}  // namespace carousel::scene
