// Kinds of fault that other importers had, each with the answer by the specification.
#include <cmath>
#include <filesystem>
#include <fstream>

#include <glm/geometric.hpp>
#include <unistd.h>

#include "tests/scene/gltf/gltf_builder.h"

namespace carousel::scene {
namespace {

using Json = nlohmann::json;

/// The square with red, green, blue and white corners of full alpha, which every encoding of COLOR_0 holds exactly.
// Others reported this kind of fault: UniVRM 2031, qmuntal/gltf 98.
TEST(GltfCases, SixEncodingsOfColourAreOneColour) {
  struct Encoding {
    int component;
    const char* type;
  };
  const std::vector<Vec4> wanted{{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}, {1, 1, 1, 1}};
  for (const auto& [component, type] :
       {Encoding{5126, "VEC3"}, {5126, "VEC4"}, {5121, "VEC3"}, {5121, "VEC4"}, {5123, "VEC3"}, {5123, "VEC4"}}) {
    SCOPED_TRACE(std::to_string(component) + " " + type);
    const int width = type[3] - '0';
    GltfBuilder b = GltfBuilder::square();
    std::vector<unsigned char> bytes;
    const auto put = [&](auto value) {
      const auto* first = reinterpret_cast<const unsigned char*>(&value);
      bytes.insert(bytes.end(), first, first + sizeof value);
    };
    for (const Vec4& color : wanted) {
      for (int c = 0; c < width; ++c) {
        if (component == 5126) put(color[c]);
        if (component == 5121) put(static_cast<std::uint8_t>(color[c] * 255));
        if (component == 5123) put(static_cast<std::uint16_t>(color[c] * 65535));
      }
      while (bytes.size() % 4 != 0) bytes.push_back(0);  // elements begin at multiples of 4
    }
    const int stride = static_cast<int>(bytes.size() / 4);
    b.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] =
        b.accessor(b.view(bytes, stride), component, 4, type, component != 5126);
    EXPECT_EQ(b.load().meshes[0].colors, wanted);
  }
}

/// A strip or fan of n vertices has n - 2 triangles, none if there are fewer than three, and the winding of its first.
// Others reported this kind of fault: godot 91593, assimp 6746.
TEST(GltfCases, StripsAndFansOfAnyLength) {
  for (const int mode : {5, 6}) {
    for (std::uint16_t n = 0; n < 8; ++n) {
      SCOPED_TRACE("mode " + std::to_string(mode) + ", " + std::to_string(n) + " indices");
      GltfBuilder b = GltfBuilder::square();
      const bool strip = mode == 5;
      std::vector<float> positions;
      for (std::uint16_t i = 0; i < 8; ++i) {
        const double turn = 0.3 * i;  // the fan turns about its first vertex
        const float x = strip ? float(i / 2) : i == 0 ? 0 : float(std::cos(turn));
        const float y = strip ? float(i % 2) : i == 0 ? 0 : float(std::sin(turn));
        positions.insert(positions.end(), {x, y, 0});
      }
      std::vector<std::uint16_t> order(n);
      for (std::uint16_t i = 0; i < n; ++i) order[i] = i;
      if (n == 0) continue;  // an accessor has one element at least
      const int p = b.floats(positions, "VEC3", 3);
      const int indices = b.accessor(b.view(order), 5123, n, "SCALAR");
      b.json["meshes"][0]["primitives"].push_back(
          {{"attributes", {{"POSITION", p}}}, {"indices", indices}, {"mode", mode}});
      const Mesh mesh = b.load().meshes[0];
      ASSERT_EQ(mesh.triangle_count(), 2u + (n > 2 ? n - 2u : 0u));
      for (std::size_t t = 6; t < mesh.indices.size(); t += 3) {
        const Vec3 a = mesh.positions[mesh.indices[t]], c = mesh.positions[mesh.indices[t + 1]],
                   d = mesh.positions[mesh.indices[t + 2]];
        const float z = glm::cross(c - a, d - a).z;
        EXPECT_TRUE(strip ? z < 0 : z > 0) << "triangle " << t / 3;
      }
    }
  }
}

/// Strips that are joined by repeated indices: the triangles between them have no area, the others keep their winding.
// Others reported this kind of fault: godot 91593, assimp 6746.
TEST(GltfCases, StitchedStripsKeepTheirWinding) {
  GltfBuilder b;
  const int p = b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 5, 0, 0, 6, 0, 0, 5, 1, 0, 6, 1, 0}, "VEC3", 3);
  const int indices = b.accessor(b.view(std::vector<std::uint16_t>{0, 1, 2, 3, 3, 4, 4, 5, 6, 7}), 5123, 10, "SCALAR");
  b.mesh({{"POSITION", p}}, indices, {{"mode", 5}});
  const Mesh mesh = b.load().meshes[0];
  ASSERT_EQ(mesh.triangle_count(), 8u);
  float area = 0;
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
    const Vec3 a = mesh.positions[mesh.indices[t]], c = mesh.positions[mesh.indices[t + 1]],
               d = mesh.positions[mesh.indices[t + 2]];
    const float z = glm::cross(c - a, d - a).z;
    EXPECT_GE(z, 0) << "triangle " << t / 3;
    area += 0.5f * z;
  }
  EXPECT_EQ(area, 2);  // two unit squares
}

// The specification of glTF 2.0, 3.6.2.2.
TEST(GltfCases, LeastSignedIntegersAreMinusOne) {
  GltfBuilder b = GltfBuilder::square();
  b.json["extensionsUsed"] = {"KHR_mesh_quantization"};
  Json& attributes = b.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["POSITION"] =
      b.accessor(b.view(std::vector<std::int8_t>{-128, -127, 127, 0, 0, 0, 0, 0, 127, -1, 1, 0, 64, 2, 3, 0}, 4), 5120,
                 4, "VEC3", true);
  EXPECT_EQ(b.load().meshes[0].positions[0], Vec3(-1, -1, 1));
  EXPECT_EQ(b.load().meshes[0].positions[2], Vec3(1, -1 / 127.0f, 1 / 127.0f));
  attributes["POSITION"] =
      b.accessor(b.view(std::vector<std::int16_t>{-32768, -32767, 32767, 0, 0, 0, 0, 0, 1, 2, 3, 0, 4, 5, 6, 0}, 8),
                 5122, 4, "VEC3", true);
  EXPECT_EQ(b.load().meshes[0].positions[0], Vec3(-1, -1, 1));
}

/// A URI is percent-decoded once; what is no escape stays, and so do plus signs and bytes of UTF-8.
// Others reported this kind of fault: rerun 10766, glTF 1561.
TEST(GltfCases, NamesOfFilesWithOddCharacters) {
  const auto folder = std::filesystem::temp_directory_path() / ("carousel-names-" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  GltfBuilder b = GltfBuilder::square();
  const std::string data(reinterpret_cast<const char*>(b.binary.data()), b.binary.size());
  struct Name {
    const char *uri, *file;
  };
  for (const auto& [uri, file] : {Name{"a b.bin", "a b.bin"},
                                  {"a%20b.bin", "a b.bin"},
                                  {"a+b.bin", "a+b.bin"},
                                  {"a%2520.bin", "a%20.bin"},
                                  {"50%25.bin", "50%.bin"},
                                  {"50%.bin", "50%.bin"},
                                  {"\xc3\xa4.bin", "\xc3\xa4.bin"},
                                  {"%C3%A4.bin", "\xc3\xa4.bin"},
                                  {"./c.bin", "c.bin"}}) {
    SCOPED_TRACE(uri);
    std::ofstream(folder / file, std::ios::binary) << data;
    b.json["buffers"] = Json::array({{{"byteLength", data.size()}, {"uri", uri}}});
    std::ofstream(folder / "x.gltf", std::ios::binary) << b.text();
    EXPECT_EQ(load_gltf(folder / "x.gltf").meshes[0].positions.size(), 4u);
    std::filesystem::remove(folder / file);
    EXPECT_THROW(load_gltf(folder / "x.gltf"), SceneError) << "found another file";
  }
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace carousel::scene
