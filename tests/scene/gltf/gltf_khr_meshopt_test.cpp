// KHR_meshopt_compression: a file of meshoptimizer 1.0.1 whose values are known by formula, streams of the older name,
// and streams that are cut or changed.
#include <algorithm>
#include <fstream>
#include <iterator>

#include "scene/gltf/buffers/buffers.h"
#include "scene/gltf/buffers/meshopt_attributes.h"
#include "tests/scene/gltf/packed_model.h"

namespace carousel::scene {
namespace {

using Json = nlohmann::json;

constexpr const char* kSample = CAROUSEL_SOURCE_DIR "/tests/data/compressed/KhrMeshoptV1.gltf";

/// A grid of 21 by 13 vertices. Positions went through no filter, colours through COLOR with 8 bits, and in the second
/// mesh with 12; 273 vertices are a whole block of the codec and a part of one.
TEST(GltfKhrMeshopt, ReadsVersionOneOfAttributesAndTheFilterOfColours) {
  constexpr std::size_t kColumns = 21, kRows = 13;
  std::vector<std::string> warnings;
  const Scene scene = load_gltf(kSample, [&](const std::string& w) { warnings.push_back(w); });
  EXPECT_EQ(warnings, std::vector<std::string>{});
  ASSERT_EQ(scene.meshes.size(), 2u);
  for (std::size_t m = 0; m < 2; ++m) {
    const Mesh& mesh = scene.meshes[m];
    ASSERT_EQ(mesh.positions.size(), kColumns * kRows);
    ASSERT_EQ(mesh.colors.size(), kColumns * kRows);
    ASSERT_EQ(mesh.triangle_count(), 2 * (kColumns - 1) * (kRows - 1));
    // Luma, chroma and alpha of K bits: alpha has one bit less, and each of the others is rounded once.
    const double step = m == 0 ? 2.5 / 255 : 2.5 / 4095;
    for (std::size_t j = 0; j < kRows; ++j) {
      for (std::size_t i = 0; i < kColumns; ++i) {
        const std::size_t v = j * kColumns + i;
        const auto x = static_cast<float>(i), y = static_cast<float>(j);
        EXPECT_EQ(mesh.positions[v], Vec3(x / 8, y / 8, static_cast<float>(i * j % 7) / 32));
        const Vec4 wanted = Vec4(12 * x, 20 * y, 7 * (x + y), 255 - 3 * x) / 255.0f;
        for (int c = 0; c < 4; ++c) EXPECT_NEAR(mesh.colors[v][c], wanted[c], step) << "vertex " << v << ", " << c;
        if (m == 0) {
          EXPECT_NEAR(mesh.uv0[v].x, x / (kColumns - 1), 1.0 / 65535);
          EXPECT_NEAR(mesh.uv0[v].y, y / (kRows - 1), 1.0 / 65535);
        }
      }
    }
    const std::vector<std::uint32_t> first(mesh.indices.begin(), mesh.indices.begin() + 6);
    for (const std::uint32_t index : first) EXPECT_TRUE(index <= 1 || index == 21 || index == 22) << index;
  }
}

/// The square's positions again, compressed, in view 2; returns the view's extensions.
Json& compressed_square(GltfBuilder& b) {
  b = GltfBuilder::square();
  const std::vector<float> positions{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  b.mesh({{"POSITION", b.accessor(meshopt_view(b, bytes_of(positions), 4, 12, "ATTRIBUTES"), 5126, 4, "VEC3")}}, 1);
  return b.json["bufferViews"][2]["extensions"];
}

TEST(GltfKhrMeshopt, ReadsStreamsOfTheOlderNameAndNotBothNamesAtOnce) {
  GltfBuilder b;
  Json& extensions = compressed_square(b);
  const Json stream = extensions["EXT_meshopt_compression"];
  extensions = {{"KHR_meshopt_compression", stream}};
  b.json["extensionsRequired"] = {"KHR_meshopt_compression"};
  const Scene scene = b.load();
  EXPECT_EQ(scene.meshes[1].positions, scene.meshes[0].positions);
  extensions["EXT_meshopt_compression"] = stream;
  expect_refused(b, "/bufferViews/2/extensions/KHR_meshopt_compression", "both names");
}

TEST(GltfKhrMeshopt, FilterOfColoursIsCheckedAndNewInThisName) {
  GltfBuilder b;
  Json& extensions = compressed_square(b);
  extensions["EXT_meshopt_compression"]["filter"] = "COLOR";
  expect_refused(b, "/bufferViews/2/extensions/EXT_meshopt_compression/filter", "expected one of");
  extensions = {{"KHR_meshopt_compression", extensions["EXT_meshopt_compression"]}};
  expect_refused(b, "/bufferViews/2/extensions/KHR_meshopt_compression/filter", "does not go with a byteStride of 12");
}

/// The bytes of a view of the sample, as the file holds them.
std::vector<unsigned char> stream_of(const Json& json, std::size_t view) {
  const std::string uri = json["buffers"][0]["uri"];
  const auto bytes = decode_base64(std::string_view(uri).substr(uri.find(',') + 1), 1 << 20);
  const Json& at = json["bufferViews"][view]["extensions"]["KHR_meshopt_compression"];
  const auto begin = bytes->begin() + at["byteOffset"].get<std::ptrdiff_t>();
  return {begin, begin + at["byteLength"].get<std::ptrdiff_t>()};
}

TEST(GltfKhrMeshopt, StreamsThatAreCutOrLongerAreRefused) {
  std::ifstream in(kSample);
  const Json json = Json::parse(in);
  const std::vector<unsigned char> good = stream_of(json, 0);
  std::vector<unsigned char> out(273 * 12);
  ASSERT_TRUE(decode_attributes_v1(out, 12, good));
  for (std::size_t size = 0; size < good.size(); ++size)
    EXPECT_FALSE(decode_attributes_v1(out, 12, std::span(good).first(size))) << size;
  std::vector<unsigned char> longer = good;
  longer.insert(longer.begin() + 1, 0);
  EXPECT_FALSE(decode_attributes_v1(out, 12, longer));
  // The last bytes are the modes of the three channels.
  for (const unsigned char mode : {0x03, 0x10, 0x11, 0x0f}) {
    std::vector<unsigned char> bad = good;
    bad.back() = mode;
    EXPECT_FALSE(decode_attributes_v1(out, 12, bad)) << int{mode};
  }
  // Other changes give other numbers or a refusal, and nothing else.
  std::size_t refused = 0;
  for (std::size_t i = 0; i < good.size(); ++i) {
    std::vector<unsigned char> bad = good;
    bad[i] ^= static_cast<unsigned char>(1u << (i % 8));
    refused += decode_attributes_v1(out, 12, bad) ? 0u : 1u;
  }
  EXPECT_GT(refused, 0u);
}

}  // namespace
}  // namespace carousel::scene
