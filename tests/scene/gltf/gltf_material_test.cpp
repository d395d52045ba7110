#include <cstdio>

#include "scene/images/image_decode.h"
#include "tests/scene/gltf/encode_image.h"
#include "tests/scene/gltf/gltf_builder.h"

namespace carousel::scene {
namespace {

using Json = nlohmann::json;

/// A square whose base colour texture is the image in buffer view `view`.
GltfBuilder textured(const std::vector<unsigned char>& image) {
  GltfBuilder b = GltfBuilder::square();
  const int view = b.view(image);
  b.push("images", {{"bufferView", view}, {"mimeType", "image/png"}, {"name", "picture"}});
  b.push("textures", {{"source", 0}});
  b.push("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  return b;
}

Image picture_of(const std::vector<unsigned char>& bytes) {
  MemoryBudget memory(64 << 20);
  return decode_image(bytes, memory);
}

TEST(ImageDecode, PngKeepsBytesAndDoesNotPremultiply) {
  const Image image = picture_of(encode_png(2, 1, 4, {200, 100, 50, 0, 10, 20, 30, 128}));
  EXPECT_EQ(image.width, 2u);
  EXPECT_EQ(image.rgba, (std::vector<std::uint8_t>{200, 100, 50, 0, 10, 20, 30, 128}));
}

TEST(ImageDecode, GreyAndGreyAlphaAndRgbAreWidened) {
  EXPECT_EQ(picture_of(encode_png(1, 1, 1, {7})).rgba, (std::vector<std::uint8_t>{7, 7, 7, 255}));
  EXPECT_EQ(picture_of(encode_png(1, 1, 2, {7, 9})).rgba, (std::vector<std::uint8_t>{7, 7, 7, 9}));
  EXPECT_EQ(picture_of(encode_png(1, 1, 3, {1, 2, 3})).rgba, (std::vector<std::uint8_t>{1, 2, 3, 255}));
}

TEST(ImageDecode, JpegIsRead) {
  const Image image = picture_of(encode_jpeg(16, 16, std::vector<unsigned char>(16 * 16 * 3, 128)));
  EXPECT_EQ(image.width, 16u);
  EXPECT_NEAR(image.rgba[0], 128, 2);
}

// Others reported this kind of fault: rerun 10766, glTF 1561.
TEST(ImageDecode, JpegOfFourInksBecomesRgb) {
  std::vector<unsigned char> inks;
  for (int i = 0; i < 16 * 16; ++i) inks.insert(inks.end(), {255, 128, 0, 128});  // inverted: 255 is no ink
  const Image image = picture_of(encode_jpeg(16, 16, inks, TJPF_CMYK));
  EXPECT_NEAR(image.rgba[0], 128, 2);
  EXPECT_NEAR(image.rgba[1], 64, 2);
  EXPECT_NEAR(image.rgba[2], 0, 2);
  EXPECT_EQ(image.rgba[3], 255);
}

/// A PNG with rows of `bytes` as they stand, and what libpng is asked for before it writes them.
template <class Prepare>
std::vector<unsigned char> raw_png(int width, int depth, int colour, const std::vector<unsigned char>& row,
                                   const Prepare& prepare) {
  std::vector<unsigned char> out;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &out,
      [](png_structp p, png_bytep data, std::size_t size) {
        auto& to = *static_cast<std::vector<unsigned char>*>(png_get_io_ptr(p));
        to.insert(to.end(), data, data + size);
      },
      nullptr);
  png_set_IHDR(png, info, static_cast<png_uint_32>(width), 1, depth, colour, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  prepare(png, info);
  png_write_info(png, info);
  png_write_row(png, row.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return out;
}

// Others reported this kind of fault: rerun 10766, glTF 1561.
TEST(ImageDecode, PngOfEveryDepthIsWidened) {
  // 16 bits are rounded: 0x80ff / 257 = 128.49. The file's curve, here linear, is not applied.
  EXPECT_EQ(picture_of(raw_png(1, 16, PNG_COLOR_TYPE_RGB, {0x80, 0xff, 0x00, 0x7f, 0xff, 0xff},
                               [](png_structp png, png_infop info) { png_set_gAMA(png, info, 1.0); }))
                .rgba,
            (std::vector<std::uint8_t>{128, 0, 255, 255}));
  // Four pixels of two bits.
  EXPECT_EQ(picture_of(raw_png(4, 2, PNG_COLOR_TYPE_GRAY, {0b00011011}, [](png_structp, png_infop) {})).rgba,
            (std::vector<std::uint8_t>{0, 0, 0, 255, 85, 85, 85, 255, 170, 170, 170, 255, 255, 255, 255, 255}));
  // A palette of which the second colour is half transparent.
  EXPECT_EQ(picture_of(raw_png(2, 8, PNG_COLOR_TYPE_PALETTE, {0, 1},
                               [](png_structp png, png_infop info) {
                                 const png_color colours[] = {{1, 2, 3}, {4, 5, 6}};
                                 const png_byte alpha[] = {255, 128};
                                 png_set_PLTE(png, info, colours, 2);
                                 png_set_tRNS(png, info, alpha, 2, nullptr);
                               }))
                .rgba,
            (std::vector<std::uint8_t>{1, 2, 3, 255, 4, 5, 6, 128}));
}

std::string reason_for_refusing(const std::vector<unsigned char>& bytes) {
  try {
    picture_of(bytes);
  } catch (const std::exception& e) {
    return e.what();
  }
  return "decoded";
}

TEST(ImageDecode, EveryTruncationIsRefused) {
  std::vector<unsigned char> bytes = encode_png(16, 16, 3, std::vector<unsigned char>(16 * 16 * 3, 77));
  EXPECT_EQ(reason_for_refusing(bytes), "decoded");
  for (std::size_t size = bytes.size() - 1; size > 8; --size) {
    bytes.resize(size);
    EXPECT_EQ(reason_for_refusing(bytes), "broken: the data ends early") << size;
  }
}

TEST(ImageDecode, WrongChecksumsAndForeignDataAreRefused) {
  std::vector<unsigned char> bytes = encode_png(1, 1, 1, {7});
  bytes[20] ^= 1;
  EXPECT_EQ(reason_for_refusing(bytes), "broken: a checksum does not match");
  EXPECT_EQ(reason_for_refusing(std::vector<unsigned char>(100, 'x')), "neither PNG nor JPEG nor WebP");
  EXPECT_EQ(reason_for_refusing({}), "neither PNG nor JPEG nor WebP");
}

TEST(ImageDecode, BrokenJpegIsRefusedOrDecodedInPart) {
  std::vector<unsigned char> bytes = encode_jpeg(16, 16, std::vector<unsigned char>(16 * 16 * 3, 128));
  bytes.resize(40);
  EXPECT_EQ(reason_for_refusing(bytes).substr(0, 6), "broken");
}

TEST(ImageDecode, SizesThatTheMemoryDoesNotHoldAreRefused) {
  // Width and height of IHDR set to 7937, with the checksum that belongs to them.
  std::vector<unsigned char> bytes = encode_png(1, 1, 1, {7});
  bytes[18] = bytes[22] = 0x1f;
  std::uint32_t crc = 0xffffffffu;
  for (std::size_t i = 12; i < 29; ++i) {
    crc ^= bytes[i];
    for (int k = 0; k < 8; ++k) crc = crc & 1 ? 0xedb88320u ^ (crc >> 1) : crc >> 1;
  }
  for (std::size_t i = 0; i < 4; ++i) bytes[29 + i] = static_cast<unsigned char>(~crc >> (24 - 8 * i));
  EXPECT_EQ(reason_for_refusing(bytes),
            "of 7937 x 7937 pixels needs 481 MiB of memory; 64 of 64 MiB are left (engine.memory_limit_mib)");
}

TEST(GltfTexture, EmbeddedImageIsDecoded) {
  const Scene scene = textured(encode_png(1, 2, 3, {1, 2, 3, 4, 5, 6})).load();
  ASSERT_EQ(scene.images.size(), 1u);
  EXPECT_EQ(scene.images[0].height, 2u);
  EXPECT_EQ(scene.images[0].rgba, (std::vector<std::uint8_t>{1, 2, 3, 255, 4, 5, 6, 255}));
  EXPECT_EQ(scene.images[0].name, "picture");
  EXPECT_EQ(scene.materials[0].base_color_texture.value().texture, TextureId(0));
}

TEST(GltfTexture, ImageInADataUriIsDecoded) {
  GltfBuilder b = textured({1});
  const std::vector<unsigned char> png = encode_png(1, 1, 3, {9, 8, 7});
  const auto* first = reinterpret_cast<const std::byte*>(png.data());
  b.json["images"][0] = {{"uri", "data:image/png;base64," + GltfBuilder::base64({first, first + png.size()})}};
  EXPECT_EQ(b.load().images.at(0).rgba, (std::vector<std::uint8_t>{9, 8, 7, 255}));
}

TEST(GltfTexture, BrokenImageIsNamed) {
  expect_refused(textured(std::vector<unsigned char>(64, 'x')), "/images/0", "the image is neither PNG nor JPEG");
  std::vector<unsigned char> cut = encode_png(64, 64, 3, std::vector<unsigned char>(64 * 64 * 3, 77));
  cut.resize(cut.size() / 2);
  expect_refused(textured(cut), "/images/0", "the image is broken");
}

TEST(GltfTexture, ImageNobodyUsesIsNotDecoded) {
  GltfBuilder b = textured(std::vector<unsigned char>(64, 'x'));
  b.json["materials"][0] = Json::object();
  EXPECT_TRUE(b.load().images.empty());
}

TEST(GltfTexture, OnlyImagesThatAreWantedAreDecoded) {
  GltfBuilder b = textured(encode_png(1, 2, 3, {1, 2, 3, 4, 5, 6}));
  b.push("images", {{"uri", "nowhere.png"}, {"name", "missing"}});
  b.push("images", {{"bufferView", b.view(std::vector<unsigned char>(64, 'x'))}, {"mimeType", "image/png"}});
  b.push("textures", {{"source", 1}});
  b.push("textures", {{"source", 2}});
  b.json["materials"][0]["normalTexture"] = {{"index", 1}};
  b.json["materials"][0]["pbrMetallicRoughness"]["metallicRoughnessTexture"] = {{"index", 2}};
  const auto decoded = [&](const ImageChoice& choice) {
    std::string names;
    for (const Image& image : load_gltf_from_memory(b.glb(), "scene.glb", {}, choice).images)
      if (!image.rgba.empty()) names += image.name + " ";
    return names;
  };
  bool triangles = false;
  EXPECT_EQ(decoded([&](const Scene& scene) {
              triangles = scene.unique_triangle_count() > 0;
              std::vector<bool> wanted;
              for (const Image& image : scene.images) wanted.push_back(image.name == "picture");
              return wanted;
            }),
            "picture ");
  EXPECT_TRUE(triangles);  // meshes are loaded before the choice of images
  EXPECT_EQ(decoded([](const Scene& scene) { return std::vector<bool>(scene.images.size(), false); }), "");
  EXPECT_THROW(b.load(), SceneError);  // all images are wanted, and two cannot be read
}

TEST(GltfTexture, ImageNeedsExactlyOneSource) {
  GltfBuilder b = textured({1});
  b.json["images"][0]["uri"] = "a.png";
  expect_refused(b, "/images/0", "exactly one of uri and bufferView");
  b.json["images"][0] = Json::object();
  expect_refused(b, "/images/0", "exactly one of uri and bufferView");
}

TEST(GltfTexture, SamplerTransformAndUvSet) {
  GltfBuilder b = textured(encode_png(1, 1, 3, {9, 8, 7}));
  b.push("samplers", {{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}});
  b.json["textures"][0]["sampler"] = 0;
  b.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {
      {"index", 0},
      {"texCoord", 3},
      {"extensions",
       {{"KHR_texture_transform",
         {{"offset", {0.25, 3000000000.0}}, {"scale", {2, 3}}, {"rotation", 1}, {"texCoord", 1}}}}}};
  const Scene scene = b.load();
  const TextureUse use = scene.materials[0].base_color_texture.value();
  EXPECT_EQ(use.uv_set, 1);
  EXPECT_EQ(use.offset, Vec2(0.25f, 3e9f));
  EXPECT_EQ(use.scale, Vec2(2, 3));
  EXPECT_EQ(use.rotation, 1);
  EXPECT_EQ(scene.textures[0].wrap_u, Wrap::kClamp);
  EXPECT_EQ(scene.textures[0].wrap_v, Wrap::kMirror);
  EXPECT_FALSE(scene.textures[0].linear_filter);
}

TEST(GltfTexture, UsesThatCannotBeReadAreDroppedWithOneWarning) {
  GltfBuilder b = textured(encode_png(1, 1, 3, {9, 8, 7}));
  b.push("textures", Json::object());
  b.json["materials"][0]["normalTexture"] = {{"index", 1}};
  b.json["materials"][0]["emissiveTexture"] = {{"index", 0}, {"texCoord", 2}};
  b.json["materials"][0]["emissiveFactor"] = {1, 1, 1};
  std::vector<std::string> warnings;
  const Scene scene = b.load([&](const std::string& w) { warnings.push_back(w); });
  EXPECT_FALSE(scene.materials[0].normal_texture);
  EXPECT_FALSE(scene.materials[0].emissive_texture);
  EXPECT_EQ(warnings,
            std::vector<std::string>{"test.gltf: texture uses ignored: 1 with a texture coordinate set beyond 1, "
                                     "1 without a PNG, JPEG or WebP source"});
}

TEST(GltfMaterial, FactorsFlagsAndExtensions) {
  GltfBuilder b = GltfBuilder::square();
  b.push("materials",
         {{"name", "lamp"},
          {"pbrMetallicRoughness",
           {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}}, {"metallicFactor", 0.5}, {"roughnessFactor", 0.25}}},
          {"emissiveFactor", {1, 0.5, 0}},
          {"alphaMode", "MASK"},
          {"alphaCutoff", 0.75},
          {"doubleSided", true},
          {"extensions",
           {{"KHR_materials_emissive_strength", {{"emissiveStrength", 8}}}, {"KHR_materials_unlit", Json::object()}}}});
  const Scene scene = b.load();
  const Material& m = scene.materials.at(0);
  EXPECT_EQ(m.name, "lamp");
  EXPECT_EQ(m.base_color, Vec4(0.1f, 0.2f, 0.3f, 0.4f));
  EXPECT_EQ(m.metallic, 0.5f);
  EXPECT_EQ(m.roughness, 0.25f);
  EXPECT_EQ(m.emissive, Vec3(8, 4, 0));
  EXPECT_EQ(m.alpha_mode, AlphaMode::kMask);
  EXPECT_EQ(m.alpha_cutoff, 0.75f);
  EXPECT_TRUE(m.double_sided);
  EXPECT_TRUE(m.unlit);
  const Material& fallback = scene.materials.back();
  EXPECT_EQ(fallback.base_color, Vec4(1));
  EXPECT_EQ(fallback.metallic, 1);
  EXPECT_EQ(fallback.alpha_mode, AlphaMode::kOpaque);
}

}  // namespace
}  // namespace carousel::scene
