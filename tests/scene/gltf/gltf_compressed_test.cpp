// Compressed geometry: files of other programs are compared with their known contents, and streams of the libraries'
// own encoders with the encoders' input.
#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>

#include "scene/builtin/mesh_shapes.h"
#include "tests/scene/gltf/guarded_load.h"
#include "tests/scene/gltf/packed_model.h"

namespace carousel::scene {
namespace {

using Json = nlohmann::json;
using End = LoadOutcome::End;

Scene load_sample(const char* name, const WarningSink& warn = {}) {
  return load_gltf(std::string(CAROUSEL_SOURCE_DIR "/tests/data/compressed/") + name, warn);
}

/// Corners of all triangles in world space, rounded to 1/100: the same for any order of triangles and corners.
std::vector<std::array<int, 3>> corners(const Scene& scene, std::size_t instance) {
  std::vector<std::array<int, 3>> out;
  const Affine& m = scene.instances[instance].world_from_model;
  const Mesh& mesh = scene.meshes[scene.instances[instance].mesh.value];
  for (const std::uint32_t i : mesh.indices) {
    const Vec3 p = m.linear * mesh.positions[i] + m.translation;
    out.push_back({static_cast<int>(std::lround(100 * p.x)), static_cast<int>(std::lround(100 * p.y)),
                   static_cast<int>(std::lround(100 * p.z))});
  }
  std::ranges::sort(out);
  return out;
}

/// Every triangle of a closed convex body faces away from `center`, and so does its vertices' normal.
void expect_outward(const Scene& scene, std::size_t instance, const Vec3& center) {
  const Mesh& mesh = scene.meshes[scene.instances[instance].mesh.value];
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
    const Vec3 a = mesh.positions[mesh.indices[t]], b = mesh.positions[mesh.indices[t + 1]],
               c = mesh.positions[mesh.indices[t + 2]];
    EXPECT_GT(glm::dot(glm::cross(b - a, c - a), a - center), 0) << "triangle " << t / 3;
    if (mesh.normals.empty()) continue;
    EXPECT_GT(glm::dot(mesh.normals[mesh.indices[t]], a - center), 0) << "triangle " << t / 3;
  }
}

// A cube of 12 triangles with edges of 1 around the origin, in any compression.
TEST(GltfCompressed, SampleBoxes) {
  struct Sample {
    const char* name;
    Vec3 center;  // centre of the mesh, before the node scales it
  };
  for (const auto& [name, center] : {Sample{"BoxDraco.gltf", Vec3(0)}, Sample{"BoxMeshopt.glb", Vec3(8191.5f)}}) {
    SCOPED_TRACE(name);
    std::vector<std::string> warnings;
    const Scene scene = load_sample(name, [&](const std::string& w) { warnings.push_back(w); });
    EXPECT_EQ(warnings, std::vector<std::string>{});
    ASSERT_EQ(scene.instances.size(), 1u);
    auto all = corners(scene, 0);
    ASSERT_EQ(all.size(), 36u);
    for (const auto& p : all)
      for (const int c : p) EXPECT_EQ(std::abs(c), 50);
    EXPECT_EQ(std::unique(all.begin(), all.end(), std::equal_to<>()) - all.begin(), 8) << "corners";
    expect_outward(scene, 0, center);
  }
}

// The file's own fallback holds the expected result.
TEST(GltfCompressed, MeshoptGivesWhatTheFallbackHolds) {
  const Scene decoded = load_sample("meshopt-fallback.gltf");
  GltfBuilder b;
  const auto content = [](const char* name) {
    std::ifstream in(std::string(CAROUSEL_SOURCE_DIR "/tests/data/compressed/") + name, std::ios::binary);
    return std::vector<char>(std::istreambuf_iterator<char>(in), {});
  };
  const std::vector<char> text = content("meshopt-fallback.gltf"), fallback = content("meshopt-fallback.fallback.bin");
  b.json = Json::parse(text.begin(), text.end());
  for (const char c : fallback) b.binary.push_back(static_cast<std::byte>(c));
  b.json.erase("buffers");
  for (Json& view : b.json["bufferViews"]) {
    view["buffer"] = 0;
    view.erase("extensions");
  }
  const Scene plain = b.load();
  ASSERT_EQ(decoded.meshes.size(), 2u);
  for (std::size_t m = 0; m < 2; ++m) {
    EXPECT_EQ(decoded.meshes[m].positions, plain.meshes[m].positions);
    EXPECT_EQ(decoded.meshes[m].indices.size(), plain.meshes[m].indices.size());
    EXPECT_EQ(corners(decoded, m), corners(plain, m));
  }
  // This fallback holds normals as the octahedral filter has them: Z. Cigolle et al., A Survey of Efficient
  // Representations for Independent Unit Vectors, JCGT 2014.
  const auto* packed = reinterpret_cast<const signed char*>(fallback.data()) + 400;
  for (std::size_t m = 0; m < 2; ++m) {
    for (const Vec3& normal : decoded.meshes[m].normals) {
      Vec3 n(packed[0], packed[1], packed[2] - std::abs(packed[0]) - std::abs(packed[1]));
      if (n.z < 0) {
        const Vec2 folded(packed[2] - std::abs(n.y), packed[2] - std::abs(n.x));
        n.x = n.x < 0 ? -folded.x : folded.x;
        n.y = n.y < 0 ? -folded.y : folded.y;
      }
      EXPECT_LT(glm::length(glm::normalize(n) - normal), 0.01f);
      packed += 4;
    }
  }
}

TEST(GltfCompressed, DracoWithBoundsInTheFile) {
  const Scene scene = load_sample("DracoSparseMesh.gltf");
  ASSERT_EQ(scene.unique_triangle_count(), 102u);
  const Mesh& mesh = scene.meshes[0];
  EXPECT_EQ(mesh.positions.size(), 62u);
  EXPECT_EQ(mesh.uv0.size(), 62u);
  const Aabb box = scene.bounds();
  // min and max of accessor 1; quantised to 2^-11 of the extent or finer.
  EXPECT_NEAR(box.lo.x, -0.0396516, 2e-5);
  EXPECT_NEAR(box.hi.y, 0.0891258, 2e-5);
  EXPECT_NEAR(box.hi.z, 0.0316506, 2e-5);
  for (const Vec3& n : mesh.normals) EXPECT_NEAR(glm::length(n), 1, 1e-5);
}

TEST(GltfCompressed, WhatWentInComesOut) {
  const Scene scene = every_extension().load();
  Mesh big, small;
  add_icosphere(big, Vec3(1, 2, 3), 2, 1, MaterialId(0));
  add_icosphere(small, Vec3(0), 1, 1, MaterialId(0));
  const auto expected = [](const Mesh& mesh) {
    Scene alone;
    alone.meshes.push_back(mesh);
    alone.instances.push_back({MeshId(0), {}});
    return corners(alone, 0);
  };
  // Instances: the square, Draco twice, meshopt with filters, meshopt exact twice, a sphere.
  ASSERT_EQ(scene.instances.size(), 7u);
  const auto near = [](const auto& found, const auto& wanted) {
    ASSERT_EQ(found.size(), wanted.size());
    for (const auto& p : wanted) {
      EXPECT_TRUE(std::ranges::any_of(found, [&](const auto& q) {
        return std::abs(p[0] - q[0]) <= 1 && std::abs(p[1] - q[1]) <= 1 && std::abs(p[2] - q[2]) <= 1;
      }));
    }
  };
  near(corners(scene, 1), expected(big));
  near(corners(scene, 2), expected(big));
  near(corners(scene, 3), expected(small));
  expect_outward(scene, 1, Vec3(1, 2, 3));
  expect_outward(scene, 2, Vec3(1, 2, 3));
  expect_outward(scene, 3, Vec3(0));
  EXPECT_EQ(scene.meshes[scene.instances[4].mesh.value].positions, small.positions);
  EXPECT_EQ(scene.meshes[scene.instances[4].mesh.value].indices, small.indices);
  // Rotations went through the quaternion filter: (0, 0, 0.6, 0.8) turns x to (0.28, 0.96, 0).
  EXPECT_NEAR(scene.instances[4].world_from_model.linear[0].x, 0.28, 1e-3);
  EXPECT_NEAR(scene.instances[4].world_from_model.linear[0].y, 0.96, 1e-3);
}

void expect_meshopt_refused(const char* key, const Json& value, const std::string& where, const std::string& message) {
  GltfBuilder b = GltfBuilder::square();
  const std::vector<float> positions{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  meshopt_view(b, bytes_of(positions), 4, 12, "ATTRIBUTES");
  EXPECT_NO_THROW(b.load());
  b.json["bufferViews"][2]["extensions"]["EXT_meshopt_compression"][key] = value;
  expect_refused(b, "/bufferViews/2/extensions/EXT_meshopt_compression" + where, message);
}

TEST(GltfCompressed, MeshoptParametersAreChecked) {
  expect_meshopt_refused("byteStride", 10, "/byteStride", "expected a multiple of 4");
  expect_meshopt_refused("mode", "TRIANGLES", "/byteStride", "expected 2 or 4");
  expect_meshopt_refused("mode", "LINES", "/mode", "expected one of");
  expect_meshopt_refused("filter", "QUATERNION", "/filter", "does not go with a byteStride of 12");
  expect_meshopt_refused("count", 5, "/count", "are not the buffer view's 48");
  expect_meshopt_refused("count", 768614336404564654.0, "/count", "expected an integer");
  expect_meshopt_refused("byteLength", 4, "", "broken or ends early");
  expect_meshopt_refused("byteLength", 4000000, "", "lie outside buffer 0");
  expect_meshopt_refused("byteOffset", 0, "", "broken or ends early");
  expect_meshopt_refused("buffer", 7, "/buffer", "an index into /buffers");
}

TEST(GltfCompressed, MeshoptCountsAreJudgedBeforeAnythingIsAllocated) {
  GltfBuilder b = GltfBuilder::square();
  meshopt_view(b, bytes_of(std::vector<float>(12)), 4, 12, "ATTRIBUTES");
  b.json["buffers"] =
      Json::array({{{"byteLength", b.binary.size()}},
                   {{"byteLength", 12e12}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}});
  Json& view = b.json["bufferViews"][2];
  view["buffer"] = 1;
  view["byteOffset"] = 0;
  view["byteLength"] = 12e12;
  view["extensions"]["EXT_meshopt_compression"]["count"] = 1e12;
  expect_scene_error([&] { load_gltf_from_memory(b.glb(), "x.glb"); },
                     "/bufferViews/2/extensions/EXT_meshopt_compression/count",
                     "1000000000000 elements: the view needs");
}

/// The first Draco primitive of a file with one, after a change.
void expect_draco_refused(const std::function<void(GltfBuilder&, Json& primitive)>& change, const std::string& where,
                          const std::string& message) {
  GltfBuilder b;
  Mesh ball;
  add_icosphere(ball, Vec3(0), 1, 1, MaterialId(0));
  draco_mesh(b, ball, true);
  EXPECT_NO_THROW(b.load());
  change(b, b.json["meshes"][0]["primitives"][0]);
  expect_refused(b, "/meshes/0/primitives/0" + where, message);
}

TEST(GltfCompressed, DracoStreamsAndAccessorsMustAgree) {
  const std::string extension = "/extensions/KHR_draco_mesh_compression";
  expect_draco_refused([](GltfBuilder& b, Json&) { b.json["accessors"][0]["count"] = 43; },
                       extension + "/attributes/POSITION", "has 43 elements, the compressed data 42");
  expect_draco_refused([](GltfBuilder& b, Json&) { b.json["accessors"][2]["count"] = 237; }, "/indices",
                       "has 237 elements, the compressed data 240");
  expect_draco_refused([](GltfBuilder& b, Json&) { b.json["accessors"][1]["type"] = "VEC4"; },
                       extension + "/attributes/NORMAL", "has 4 components, the compressed data 3");
  expect_draco_refused([](GltfBuilder& b, Json&) { b.json["accessors"][2]["componentType"] = 5126; }, "/indices",
                       "the component type is not allowed");
  expect_draco_refused(
      [&](GltfBuilder&, Json& p) { p["extensions"]["KHR_draco_mesh_compression"]["attributes"]["NORMAL"] = 9; },
      extension + "/attributes/NORMAL", "has no attribute 9");
  expect_draco_refused(
      [&](GltfBuilder&, Json& p) { p["extensions"]["KHR_draco_mesh_compression"]["attributes"]["COLOR_0"] = 1; },
      extension + "/attributes/COLOR_0", "the primitive has no such attribute");
  expect_draco_refused([](GltfBuilder&, Json& p) { p.erase("indices"); }, "/indices", "missing");
  expect_draco_refused([](GltfBuilder&, Json& p) { p["mode"] = 5; }, "/mode", "expected triangles");
  expect_draco_refused([](GltfBuilder& b, Json&) { b.json["bufferViews"][0]["byteLength"] = 60; }, extension,
                       "is broken");
  expect_draco_refused([](GltfBuilder& b, Json&) { b.binary[5] = std::byte{1}; }, extension,
                       "not a mesh of Draco bitstream 2.2");
  // Byte 11 is the kind of traversal, then the number of vertices as a varint.
  expect_draco_refused(
      [](GltfBuilder& b, Json&) {
        for (std::size_t i = 12; i < 15; ++i) b.binary[i] = std::byte{0xff};
        b.binary[15] = std::byte{0x7f};
      },
      extension, "announces");
}

// Some writers name one accessor for the same kind of data in several streams. Each primitive reads its own stream.
TEST(GltfCompressed, AccessorOfTwoStreamsReadsTheRightOne) {
  GltfBuilder b;
  Mesh ball, far;
  add_icosphere(ball, Vec3(0), 1, 1, MaterialId(0));
  add_icosphere(far, Vec3(100, 0, 0), 1, 1, MaterialId(0));
  draco_mesh(b, ball, false);
  draco_mesh(b, far, false);
  const Scene expected = b.load();
  for (const char* name : {"POSITION", "NORMAL"})
    b.json["meshes"][1]["primitives"][0]["attributes"][name] = b.json["meshes"][0]["primitives"][0]["attributes"][name];
  const Scene shared = b.load();
  for (std::size_t m = 0; m < 2; ++m) {
    EXPECT_EQ(shared.meshes[m].positions, expected.meshes[m].positions);
    EXPECT_EQ(shared.meshes[m].normals, expected.meshes[m].normals);
  }
}

// If a file has both, the plain data is read and the stream is not read at all.
TEST(GltfCompressed, FallbackOfDracoIsUsed) {
  GltfBuilder b = GltfBuilder::square();
  const int view = b.view(std::vector<char>(100, 'x'));
  b.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", view}, {"attributes", {{"POSITION", 0}}}};
  EXPECT_EQ(b.load().meshes[0].positions.size(), 4u);
}

// Compressed bytes are the input of two external decoders. Truncated or changed anywhere, they lead to a scene or to a
// SceneError.
TEST(GltfCompressed, BrokenStreamsLoadOrAreRefused) {
  const GltfBuilder good = every_extension();
  struct Range {
    std::size_t first, size;
  };
  std::vector<Range> ranges;
  for (const Json& view : good.json["bufferViews"]) {
    const Json::json_pointer meshopt("/extensions/EXT_meshopt_compression");
    const Json& at = view.contains(meshopt) ? view.at(meshopt) : view;
    ranges.push_back({at["byteOffset"], at["byteLength"]});
  }
  std::vector<std::pair<std::size_t, unsigned>> changes;
  for (const Range& range : ranges) {
    for (std::size_t i = 0; i < range.size; i += 2) {
      constexpr unsigned kChanges[] = {0x01, 0x80, 0xff};
      changes.emplace_back(range.first + i, kChanges[i / 2 % 3]);
    }
  }
  const auto outcomes = load_guarded(changes.size(), [&](std::size_t i) {
    GltfBuilder bad = good;
    bad.binary[changes[i].first] ^= static_cast<std::byte>(changes[i].second);
    return load_gltf_from_memory(bad.glb(), "bad.glb");
  });
  std::size_t refused = 0;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    EXPECT_NE(outcomes[i].end, End::kFault)
        << "byte " << changes[i].first << " ^ " << changes[i].second << ": " << outcomes[i];
    refused += outcomes[i].end == End::kRefused;
  }
  EXPECT_GT(refused, outcomes.size() / 20);
}

}  // namespace
}  // namespace carousel::scene
