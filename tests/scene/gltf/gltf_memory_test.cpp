// The memory of the import, and nothing else, bounds the contents that a file announces: the densest honest files are
// read, however few bytes they have, and files that announce more than the memory are refused before they get it.
#include <algorithm>
#include <chrono>
#include <fstream>
#include <iterator>

#include <glm/geometric.hpp>
#include <webp/encode.h>

#include "scene/gltf/bounded_import.h"
#include "scene/gltf/buffers/meshopt_attributes.h"
#include "scene/images/image_decode.h"
#include "tests/scene/gltf/encode_image.h"
#include "tests/scene/gltf/guarded_load.h"
#include "tests/scene/gltf/packed_model.h"

namespace carousel::scene {
namespace {

using Json = nlohmann::json;
using Bytes = std::vector<unsigned char>;

constexpr std::uint64_t kMib = 1 << 20;

/// A picture of one colour, and how it is decoded: all pixels equal the first, and there are at least `density` a byte.
void expect_dense(const Bytes& encoded, unsigned side, double density, const char* name) {
  SCOPED_TRACE(name);
  MemoryBudget memory(256 * kMib);
  const Image image = decode_image(encoded, memory);
  EXPECT_EQ(image.width, side);
  EXPECT_EQ(image.height, side);
  EXPECT_EQ(memory.left(), 256 * kMib - std::uint64_t{4} * side * side) << "the picture stays, the work is given back";
  EXPECT_GT(double(side) * side / static_cast<double>(encoded.size()), density) << encoded.size() << " bytes";
  const std::vector<std::uint8_t> first(image.rgba.begin(), image.rgba.begin() + 4);
  std::vector<std::uint8_t> last(image.rgba.end() - 4, image.rgba.end());
  for (int c = 0; c < 4; ++c) EXPECT_NEAR(first[std::size_t(c)], last[std::size_t(c)], 2);
}

/// A black PNG of one bit a pixel.
Bytes black_png(unsigned side) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  Bytes out;
  png_set_write_fn(
      png, &out,
      [](png_structp p, png_bytep data, std::size_t size) {
        auto& to = *static_cast<Bytes*>(png_get_io_ptr(p));
        to.insert(to.end(), data, data + size);
      },
      nullptr);
  png_set_IHDR(png, info, side, side, 1, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_set_compression_level(png, 9);
  png_write_info(png, info);
  Bytes row(side / 8);
  for (unsigned y = 0; y < side; ++y) png_write_row(png, row.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return out;
}

Bytes grey_jpeg(int side, int flags) {
  tjhandle encoder = tjInitCompress();
  unsigned char* out = nullptr;
  unsigned long size = 0;
  const Bytes pixels(static_cast<std::size_t>(side) * static_cast<std::size_t>(side), 128);
  EXPECT_EQ(tjCompress2(encoder, pixels.data(), side, 0, side, TJPF_GRAY, &out, &size, TJSAMP_GRAY, 50, flags), 0);
  Bytes bytes(out, out + size);
  tjFree(out);
  tjDestroy(encoder);
  return bytes;
}

Bytes lossy_webp(int side) {
  const Bytes pixels(3 * static_cast<std::size_t>(side) * static_cast<std::size_t>(side), 128);
  std::uint8_t* out = nullptr;
  const std::size_t size = WebPEncodeRGB(pixels.data(), side, side, 3 * side, 10, &out);
  Bytes bytes(out, out + size);
  WebPFree(out);
  return bytes;
}

TEST(ImportMemory, DensestPicturesAreRead) {
  expect_dense(black_png(2048), 2048, 6000, "PNG");
  expect_dense(grey_jpeg(1024, 0), 1024, 80, "JPEG");
  expect_dense(grey_jpeg(1024, TJFLAG_PROGRESSIVE), 1024, 200, "progressive JPEG");
  expect_dense(webp(1024, 1024, Bytes(4 << 20, 200)), 1024, 8300, "lossless WebP");
  expect_dense(lossy_webp(1024), 1024, 400, "lossy WebP");
}

/// Zero by the number: an accessor without a view, alone or with one value of its own.
// Others reported this kind of fault: three.js 24838.
TEST(ImportMemory, ZerosThatTheFileDoesNotStoreAreRead) {
  constexpr std::size_t kCount = 300'000;
  GltfBuilder b;
  b.mesh({{"POSITION", b.accessor(-1, 5126, kCount, "VEC3")}, {"NORMAL", b.accessor(-1, 5126, kCount, "VEC3")}});
  const int indices = b.view(std::vector<std::uint32_t>{299'999}), values = b.view(std::vector<float>{5, 6, 7});
  b.json["accessors"][0]["sparse"] = {{"count", 1},
                                      {"indices", {{"bufferView", indices}, {"componentType", 5125}}},
                                      {"values", {{"bufferView", values}}}};
  const Scene scene = b.load();
  ASSERT_EQ(scene.meshes[0].positions.size(), kCount);
  EXPECT_EQ(scene.meshes[0].positions[0], Vec3(0));
  EXPECT_EQ(scene.meshes[0].positions.back(), Vec3(5, 6, 7));
}

/// A regular grid of 381 by 127 squares: Draco's prediction leaves next to nothing of it.
TEST(ImportMemory, FlatGridOfDracoIsRead) {
  constexpr std::size_t kColumns = 381, kRows = 127;
  std::ifstream in(CAROUSEL_SOURCE_DIR "/tests/data/compressed/grid_381x127.drc", std::ios::binary);
  const std::vector<char> stream(std::istreambuf_iterator<char>(in), {});
  EXPECT_GT(2 * kColumns * kRows, 4096 + 64 * stream.size()) << "no denser than guards by ratio allowed";
  GltfBuilder b;
  const int view = b.view(stream);
  const int positions = b.accessor(-1, 5126, (kColumns + 1) * (kRows + 1), "VEC3");
  const int indices = b.accessor(-1, 5125, 6 * kColumns * kRows, "SCALAR");
  b.mesh({{"POSITION", positions}}, indices,
         {{"extensions", {{"KHR_draco_mesh_compression", {{"bufferView", view}, {"attributes", {{"POSITION", 0}}}}}}}});
  const Mesh mesh = b.load().meshes[0];
  EXPECT_EQ(mesh.triangle_count(), 2 * kColumns * kRows);
  double area = 0;
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3)
    area += 0.5 * glm::length(glm::cross(mesh.positions[mesh.indices[t + 1]] - mesh.positions[mesh.indices[t]],
                                         mesh.positions[mesh.indices[t + 2]] - mesh.positions[mesh.indices[t]]));
  EXPECT_NEAR(area, kColumns * kRows, 1);
}

/// A stream of version 1 whose deltas are all zero: a byte for 256 elements of four bytes.
TEST(ImportMemory, ViewsOfMeshoptThatAreAllZeroAreRead) {
  constexpr std::size_t kCount = 76'800, kStride = 12, kBlocks = kCount / 256;
  Bytes packed{0xa1};
  packed.insert(packed.end(), kBlocks * kStride / 4, 0xaa);
  packed.insert(packed.end(), 24, 0);
  EXPECT_GT(kCount * kStride, 900 * packed.size());
  GltfBuilder b;
  const int source = b.view(packed);
  const Json at = b.json["bufferViews"][static_cast<std::size_t>(source)];
  b.json["bufferViews"] = Json::array();
  b.push("bufferViews", {{"buffer", 1},
                         {"byteLength", kCount * kStride},
                         {"extensions",
                          {{"KHR_meshopt_compression",
                            {{"buffer", 0},
                             {"byteOffset", at["byteOffset"]},
                             {"byteLength", packed.size()},
                             {"byteStride", kStride},
                             {"count", kCount},
                             {"mode", "ATTRIBUTES"}}}}}});
  b.json["buffers"] = Json::array({{{"byteLength", b.binary.size()}}, {{"byteLength", kCount * kStride}}});
  b.mesh({{"POSITION", b.accessor(0, 5126, kCount, "VEC3")}});
  const auto file = b.glb();
  EXPECT_EQ(load_gltf_from_memory(file, "zero.glb").meshes[0].positions.size(), kCount);
}

/// Sets the size in the header of a picture.
Bytes with_size(Bytes bytes, std::size_t at, const Bytes& size) {
  std::ranges::copy(size, bytes.begin() + std::ptrdiff_t(at));
  return bytes;
}

GltfBuilder pictured(const Bytes& bytes) {
  GltfBuilder b = GltfBuilder::square();
  b.push("images", {{"bufferView", b.view(bytes)}});
  b.push("textures", {{"source", 0}});
  b.push("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  return b;
}

struct Bomb {
  const char* name;
  std::string path;
  GltfBuilder file;
};

std::vector<Bomb> bombs() {
  std::vector<Bomb> out;
  const auto add = [&](const char* name, const std::string& path, GltfBuilder file) {
    out.push_back({name, path, std::move(file)});
  };
  const std::string position = "/meshes/0/primitives/0/attributes/POSITION";
  GltfBuilder zeros = GltfBuilder::square();
  zeros.json["accessors"][0].erase("bufferView");
  zeros.json["accessors"][0]["count"] = 4'000'000'000u;
  add("zeros", position, zeros);
  const int indices = zeros.view(std::vector<std::uint8_t>{2}), values = zeros.view(std::vector<float>{5, 6, 7});
  zeros.json["accessors"][0]["sparse"] = {{"count", 1},
                                          {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                                          {"values", {{"bufferView", values}}}};
  add("sparse zeros", position, zeros);
  GltfBuilder many = GltfBuilder::square();
  const int places = many.accessor(-1, 5126, 4'000'000'000u, "VEC3");
  many.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"TRANSLATION", places}};
  add("instances", "/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes", many);
  const Bytes jpeg = grey_jpeg(16, 0);
  const Bytes head{0xff, 0xc0};
  const auto frame = std::search(jpeg.begin(), jpeg.end(), std::begin(head), std::end(head)) - jpeg.begin();
  add("JPEG", "/images/0", pictured(with_size(jpeg, std::size_t(frame) + 5, {0xff, 0x00, 0xff, 0x00})));
  // VP8L: 14 bits of width and of height, each less one, after the signature.
  add("WebP", "/images/0", pictured(with_size(webp(16, 16, Bytes(1024, 9)), 21, {0xff, 0xff, 0xff, 0x0f})));
  GltfBuilder stream;
  Mesh ball;
  ball.positions = {Vec3(0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  ball.normals.assign(3, Vec3(0, 0, 1));
  ball.indices = {0, 1, 2};
  draco_mesh(stream, ball, true);
  // Byte 11 is the kind of traversal, then the number of vertices as a varint.
  for (std::size_t i = 12; i < 15; ++i) stream.binary[i] = std::byte{0xff};
  stream.binary[15] = std::byte{0x7f};
  add("Draco", "/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression", stream);
  GltfBuilder copies;
  const int shared = copies.accessor(-1, 5126, 65535, "VEC3");
  for (int i = 0; i < 400; ++i) copies.mesh({{"POSITION", shared}});
  add("copies", "/meshes/", copies);
  return out;
}

TEST(ImportMemory, BombsAreRefusedByTheMemoryTheyWouldTake) {
  const std::vector<Bomb> all = bombs();
  const auto start = std::chrono::steady_clock::now();
  const auto outcomes = load_guarded(
      all.size(), [&](std::size_t i) { return load_gltf_within(64 * kMib, all[i].file.glb(), "bomb.glb"); }, 5);
  for (std::size_t i = 0; i < all.size(); ++i) {
    SCOPED_TRACE(all[i].name);
    EXPECT_EQ(outcomes[i].end, LoadOutcome::End::kRefused) << outcomes[i];
    EXPECT_TRUE(outcomes[i].path.starts_with(all[i].path)) << outcomes[i];
    EXPECT_NE(outcomes[i].message.find("MiB of memory; "), std::string::npos) << outcomes[i];
    EXPECT_NE(outcomes[i].message.find("of 64 MiB are left (engine.memory_limit_mib)"), std::string::npos)
        << outcomes[i];
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
}

// One file is a bomb to one budget and ordinary to another.
TEST(ImportMemory, OrdinaryFileNeedsItsMemoryAndNoMore) {
  GltfBuilder b;
  b.mesh({{"POSITION", b.accessor(-1, 5126, 300'000, "VEC3")}});
  const auto file = b.glb();
  EXPECT_EQ(load_gltf_within(32 * kMib, file, "x.glb").meshes[0].positions.size(), 300'000u);
  expect_scene_error([&] { load_gltf_within(4 * kMib, file, "x.glb"); }, "/meshes/0/primitives/0/attributes/POSITION",
                     "accessor 0 asks for 300000 elements and stores 0, and needs 7 MiB of memory");
}

TEST(MemoryBudget, LoansComeBackAndWhatIsTakenStays) {
  MemoryBudget memory(100);
  {
    MemoryBudget::Loan first = memory.lend(60);
    EXPECT_EQ(memory.left(), 40u);
    EXPECT_THROW(memory.take(41), std::length_error);
    first = memory.lend(40);  // the old loan ends after the new one has begun
    EXPECT_EQ(memory.left(), 60u);
  }
  EXPECT_EQ(memory.left(), 100u);
  memory.take(30);
  EXPECT_EQ(memory.left(), 70u);
  EXPECT_THROW(static_cast<void>(memory.lend(~std::uint64_t{0})), std::length_error);
}

}  // namespace
}  // namespace carousel::scene
