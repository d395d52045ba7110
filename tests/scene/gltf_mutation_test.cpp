// Whatever bytes a file holds, it either loads or ends in a SceneError.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "scene/hash_random.h"
#include "tests/scene/gltf_builder.h"

namespace carousel::scene {
namespace {

using Json = nlohmann::json;

/// A file that uses every feature of the importer.
GltfBuilder everything() {
  GltfBuilder b = GltfBuilder::square();
  b.json["extensionsUsed"] = {"KHR_mesh_quantization", "EXT_mesh_gpu_instancing", "KHR_lights_punctual",
                              "VENDOR_x"};
  b.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  std::vector<unsigned char> png;
  OIIO::Filesystem::IOVecOutput writer(png);
  auto output = OIIO::ImageOutput::create("png");
  output->set_ioproxy(&writer);
  output->open("x.png", OIIO::ImageSpec(4, 4, 3, OIIO::TypeDesc::UINT8));
  output->write_image(OIIO::TypeDesc::UINT8, std::vector<unsigned char>(48, 99).data());
  output->close();
  b.push("images", {{"bufferView", b.view(png)}, {"mimeType", "image/png"}});
  b.push("samplers", {{"wrapS", 33071}});
  b.push("textures", {{"source", 0}, {"sampler", 0}});
  b.push("materials",
         {{"pbrMetallicRoughness",
           {{"baseColorTexture",
             {{"index", 0},
              {"extensions", {{"KHR_texture_transform", {{"offset", {0.5, 1}}, {"texCoord", 0}}}}}}},
            {"metallicFactor", 0.5}}},
          {"emissiveFactor", {1, 1, 1}},
          {"alphaMode", "BLEND"},
          {"extensions",
           {{"KHR_materials_emissive_strength", {{"emissiveStrength", 3}}},
            {"VENDOR_x", {{"deep", {{"er", {1, 2}}}}}}}}});
  Json& primitive = b.json["meshes"][0]["primitives"][0];
  primitive["material"] = 0;
  primitive["attributes"]["TEXCOORD_0"] =
      b.accessor(b.view(std::vector<std::uint16_t>(8, 1000)), 5123, 4, "VEC2", true);
  primitive["attributes"]["COLOR_0"] =
      b.accessor(b.view(std::vector<std::uint8_t>(16, 200)), 5121, 4, "VEC4", true);
  const int sparse_indices = b.view(std::vector<std::uint8_t>{1, 3}),
            sparse_values = b.view(std::vector<float>(6, 2));
  b.json["accessors"][0]["sparse"] = {{"count", 2},
                                      {"indices", {{"bufferView", sparse_indices}, {"componentType", 5121}}},
                                      {"values", {{"bufferView", sparse_values}}}};
  const int small =
      b.accessor(b.view(std::vector<std::int16_t>{0, 0, 0, 0, 9, 0, 0, 0, 0, 9, 0, 0}, 8), 5122, 3, "VEC3");
  b.mesh({{"POSITION", small}}, -1, {{"mode", 5}});
  const int translations = b.floats({1, 0, 0, 2, 0, 0}, "VEC3", 3);
  b.json["nodes"][1]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"TRANSLATION", translations}};
  b.json["extensions"]["KHR_lights_punctual"]["lights"] =
      Json::array({{{"type", "spot"}, {"spot", {{"outerConeAngle", 0.5}}}}, {{"type", "point"}}});
  b.node({{"rotation", {0, 0, 0, 1}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  b.push("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}});
  const int inner =
      b.push("nodes", {{"camera", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 5, 5, 1}}});
  b.node({{"children", {inner}}, {"scale", {-1, 2, 1}}});
  b.push("animations",
         {{"channels", Json::array({{{"sampler", 0}, {"target", {{"node", 0}, {"path", "scale"}}}}})},
          {"samplers", Json::array({{{"input", 0}, {"output", 0}}})}});
  b.json["scene"] = 0;
  return b;
}

/// True when it loaded. Anything but a SceneError escapes and fails the test.
bool loads(std::span<const std::byte> bytes) {
  try {
    const Scene scene = load_gltf_from_memory(bytes, "mutant");
    for (const Mesh& mesh : scene.meshes) {
      for (const std::uint32_t i : mesh.indices) EXPECT_LT(i, mesh.positions.size());
      EXPECT_EQ(mesh.triangle_materials.size(), mesh.triangle_count());
    }
    return true;
  } catch (const SceneError& e) {
    EXPECT_FALSE(e.message().empty());
    return false;
  }
}

TEST(GltfMutation, TheUnchangedFileLoads) {
  EXPECT_TRUE(loads(everything().glb()));
  const std::string text = everything().text();
  EXPECT_TRUE(loads(std::as_bytes(std::span(text))));
}

TEST(GltfMutation, ChangedBytesLoadOrAreRefused) {
  const std::vector<std::byte> good = everything().glb();
  int loaded = 0;
  for (std::uint64_t seed = 0; seed < 6000; ++seed) {
    SCOPED_TRACE(seed);
    HashRandom random(seed, 7);
    std::vector<std::byte> bytes = good;
    for (std::uint32_t n = 1 + random.below(4); n > 0; --n) {
      const std::size_t at = random.below(static_cast<std::uint32_t>(bytes.size()));
      switch (random.below(4)) {
        case 0:
          bytes[at] ^= static_cast<std::byte>(1u << random.below(8));
          break;
        case 1:
          bytes[at] = static_cast<std::byte>(random.below(256));
          break;
        case 2:
          bytes[at] = static_cast<std::byte>('0' + random.below(10));
          break;
        default:
          bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(at));
          break;
      }
    }
    loaded += loads(bytes) ? 1 : 0;
  }
  EXPECT_GT(loaded, 100);  // otherwise the mutants test nothing but the JSON parser
}

void collect(Json& value, std::vector<Json*>& all) {
  all.push_back(&value);
  if (value.is_structured()) {
    for (Json& child : value) collect(child, all);
  }
}

Json random_value(HashRandom& random, const std::vector<Json*>& all) {
  static const Json odd[] = {nullptr,
                             true,
                             "",
                             "data:;base64,AAAA",
                             "../x",
                             -1,
                             0,
                             1,
                             2,
                             3,
                             4,
                             5,
                             255,
                             5121,
                             5123,
                             5125,
                             5126,
                             65535,
                             2147483647,
                             2147483648.0,
                             4294967295.0,
                             9007199254740992.0,
                             1.8e19,
                             1e300,
                             -0.0,
                             0.5,
                             1e-300,
                             Json::array(),
                             Json::object(),
                             Json::array({0, 0}),
                             Json::array({1, 1, 1}),
                             "VEC4",
                             "MASK"};
  if (random.below(3) == 0) return *all[random.below(static_cast<std::uint32_t>(all.size()))];
  return odd[random.below(static_cast<std::uint32_t>(std::size(odd)))];
}

TEST(GltfMutation, ChangedJsonLoadsOrIsRefused) {
  GltfBuilder good = everything();
  good.json["buffers"] =
      Json::array({{{"byteLength", good.binary.size()},
                    {"uri", "data:application/octet-stream;base64," + GltfBuilder::base64(good.binary)}}});
  int loaded = 0;
  for (std::uint64_t seed = 0; seed < 6000; ++seed) {
    SCOPED_TRACE(seed);
    HashRandom random(seed, 8);
    Json mutant = good.json;
    for (std::uint32_t n = 1 + random.below(3); n > 0; --n) {
      std::vector<Json*> all;
      collect(mutant, all);
      Json& target = *all[1 + random.below(static_cast<std::uint32_t>(all.size() - 1))];
      if (target.is_structured() && !target.empty() && random.below(2) == 0) {
        const auto child = std::next(target.begin(), random.below(static_cast<std::uint32_t>(target.size())));
        target.erase(child);
      } else {
        Json value = random_value(random, all);  // a copy first: it may hold the target
        target = std::move(value);
      }
    }
    const std::string text = mutant.dump();
    loaded += loads(std::as_bytes(std::span(text))) ? 1 : 0;
  }
  EXPECT_GT(loaded, 100);
}

}  // namespace
}  // namespace carousel::scene
