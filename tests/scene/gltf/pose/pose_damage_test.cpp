// Damaged files that move: each fault is named with its place, and no file whatsoever crashes the importer.
#include <functional>
#include <iostream>

#include "scene/builtin/hash_random.h"
#include "scene/gltf/bounded_import.h"
#include "tests/scene/gltf/guarded_load.h"
#include "tests/scene/gltf/pose/moving_models.h"
#include "tests/support/random_runs.h"

namespace carousel::scene::pose_damage_test {
namespace {

using Json = GltfBuilder::Json;

void expect_refused_at_a_moment(const GltfBuilder& good, const std::function<void(GltfBuilder&)>& damage,
                                const std::string& path, const std::string& message) {
  SCOPED_TRACE(path);
  GltfBuilder bad = good;
  damage(bad);
  expect_scene_error([&] { load_at(bad, 0.5f); }, path, message);
  EXPECT_NO_THROW(bad.load()) << "the base pose needs none of it";
}

TEST(PoseDamage, FaultsOfAnimationsAreNamed) {
  const auto refused = [](const std::function<void(GltfBuilder&)>& damage, const std::string& path,
                          const std::string& message) {
    expect_refused_at_a_moment(two_bone_arm(), damage, path, message);
  };
  const std::string at = "/animations/0";
  refused([](GltfBuilder& b) { b.json["animations"][0]["samplers"][0]["interpolation"] = "BEZIER"; },
          at + "/samplers/0/interpolation", "expected one of LINEAR STEP CUBICSPLINE, found \"BEZIER\"");
  refused([](GltfBuilder& b) { b.json["animations"][0]["channels"][0]["sampler"] = 7; }, at + "/channels/0/sampler",
          "expected an index into this animation's samplers, which has 1 entries, found 7");
  refused([](GltfBuilder& b) { b.json["animations"][0]["channels"][0]["target"]["path"] = "colour"; },
          at + "/channels/0/target/path", "expected one of translation rotation scale weights, found \"colour\"");
  refused([](GltfBuilder& b) { b.json["animations"][0]["channels"][0]["target"]["node"] = 9; },
          at + "/channels/0/target/node", "expected an index into /nodes, which has 3 entries, found 9");
  refused([](GltfBuilder& b) { b.json["animations"][0]["channels"][0]["target"]["path"] = "weights"; },
          at + "/channels/0/target", "node 2 has no mesh with morph targets");
  refused([](GltfBuilder& b) { b.json["animations"][0]["channels"][0]["target"]["path"] = "scale"; },
          at + "/samplers/0/output", "expected VEC3 elements");
  refused([](GltfBuilder& b) { b.json["animations"][0]["samplers"][0]["interpolation"] = "CUBICSPLINE"; },
          at + "/samplers/0/output", "has 2 elements; the 2 times of this sampler need 6");
  refused(
      [](GltfBuilder& b) {
        b.json["animations"][0]["samplers"][0]["input"] = b.floats({1, 1}, "SCALAR", 1);
      },
      at + "/samplers/0/input", "element 1 of accessor 8 is not greater than the one before");
  refused(
      [](GltfBuilder& b) {
        b.json["animations"][0]["samplers"][0]["output"] = b.floats({0, 0, 0, 1, 0, 0, 0, 0}, "VEC4", 4);
      },
      at + "/samplers/0/output", "the quaternion of element 1 of accessor 8 has length zero");
  refused(
      [](GltfBuilder& b) {
        b.json["nodes"][2] = {{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 1}}};
      },
      at + "/channels/0/target", "node 2 has a matrix, which cannot be animated");
  refused(
      [](GltfBuilder& b) {
        auto& channels = b.json["animations"][0]["channels"];
        channels.push_back(Json(channels[0]));
      },
      at + "/channels/1/target", "another channel of this animation moves the same");
}

TEST(PoseDamage, FaultsOfSkinsAreNamed) {
  const auto refused = [](const std::function<void(GltfBuilder&)>& damage, const std::string& path,
                          const std::string& message) {
    expect_refused_at_a_moment(two_bone_arm(), damage, path, message);
  };
  const std::string at = "/meshes/0/primitives/0/attributes";
  refused([](GltfBuilder& b) { b.json["meshes"][0]["primitives"][0]["attributes"].erase("WEIGHTS_0"); },
          at + "/WEIGHTS_0", "missing, though the node of the mesh has a skin");
  refused([](GltfBuilder& b) { b.json["skins"][0]["joints"] = Json::array({1}); }, at + "/JOINTS_0",
          "joint 1 of vertex 2 is beyond the 1 joints of skin 0");
  refused([](GltfBuilder& b) { b.json["skins"][0]["joints"] = Json::array(); }, "/skins/0/joints",
          "expected at least one joint");
  refused(
      [](GltfBuilder& b) {
        b.json["skins"][0]["joints"] = {1, 5};
      },
      "/skins/0/joints/1", "expected an index into /nodes, which has 3 entries, found 5");
  refused(
      [](GltfBuilder& b) {
        b.json["skins"][0]["joints"] = {1, 2, 0};
      },
      "/skins/0/inverseBindMatrices", "has 2 elements, the skin has 3 joints");
  refused([](GltfBuilder& b) { b.json["skins"][0]["inverseBindMatrices"] = 0; }, "/skins/0/inverseBindMatrices",
          "expected MAT4 elements");
  refused(
      [](GltfBuilder& b) {
        b.json["nodes"][1]["scale"] = {3e38, 3e38, 3e38};
        b.json["nodes"][2]["scale"] = {9, 9, 9};
      },
      at, "the pose moves vertex 3 farther than single precision reaches");
}

TEST(PoseDamage, FaultsOfMorphTargetsAreNamed) {
  const auto refused = [](const std::function<void(GltfBuilder&)>& damage, const std::string& path,
                          const std::string& message) {
    expect_refused_at_a_moment(morphed_square(), damage, path, message);
  };
  const std::string at = "/meshes/0/primitives/0/targets";
  refused([](GltfBuilder& b) { b.json["meshes"][0]["primitives"][0]["targets"][0]["POSITION"] = 1; },
          at + "/0/POSITION", "expected VEC3 elements");
  refused([](GltfBuilder& b) { b.json["meshes"][0]["primitives"][0]["targets"] = 5; }, at,
          "expected an array, found 5");
  refused(
      [](GltfBuilder& b) {
        b.json["meshes"][0]["primitives"][0]["targets"][0]["POSITION"] = b.floats({0, 0, 0}, "VEC3", 3);
      },
      at + "/0/POSITION", "has 1 elements, POSITION has 4");
  refused(
      [](GltfBuilder& b) {
        auto& primitives = b.json["meshes"][0]["primitives"];
        primitives.push_back(Json(primitives[0]));
        primitives[1].erase("targets");
      },
      "/meshes/0/primitives/1/targets", "expected 2 morph targets, as the first primitive has, found 0");
  refused(
      [](GltfBuilder& b) {
        b.json.erase("animations");
        b.json["nodes"][0]["weights"] = Json::array({1});
      },
      "/nodes/0/weights", "expected 2 weights, one a morph target, found 1");
}

TEST(PoseDamage, AFaultyAnimationThatIsNotChosenIsAWarning) {
  GltfBuilder b = two_bone_arm();
  animate(b, 1, "translation", {0}, {1, 0, 0}, "VEC3", 3, "LINEAR", "good");
  b.json["animations"][0]["samplers"][0]["interpolation"] = "BEZIER";
  std::vector<std::string> warnings;
  EXPECT_EQ(load_at(b, 0, "good", [&](const std::string& w) { warnings.push_back(w); }).meshes[0].positions[0],
            Vec3(0.8f, 0, 0));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("/animations/0/samplers/0/interpolation"), std::string::npos);
}

TEST(PoseDamage, WhatAPoseNeedsIsAskedOfTheBudget) {
  GltfBuilder b = two_bone_arm();
  const int zeros = b.accessor(-1, 5126, 100'000'000, "MAT4");
  b.json["skins"][0]["inverseBindMatrices"] = zeros;
  const std::string text = b.text();
  expect_scene_error(
      [&] { load_gltf_within(64 << 20, std::as_bytes(std::span(text)), "test.gltf", {}, {}, PoseChoice{}); },
      "/skins/0/inverseBindMatrices", "asks for 100000000 elements");
}

void collect(Json& value, std::vector<Json*>& all) {
  all.push_back(&value);
  if (value.is_structured())
    for (Json& child : value) collect(child, all);
}

TEST(PoseDamage, MutantsLoadOrAreRefused) {
  GltfBuilder morphed = morphed_square();
  morphed.json["nodes"][0]["weights"] = {0.5, 0.25};
  for (const GltfBuilder& good : {two_bone_arm(), morphed}) {
    const auto count = static_cast<std::size_t>(scaled(1500));
    const auto outcomes = load_guarded(count, [&](std::size_t i) {
      HashRandom random(run_seed() + i, 7);
      GltfBuilder mutant = good;
      mutant.json["buffers"] = Json::array({{{"byteLength", good.binary.size()}}});
      for (std::uint32_t n = 1 + random.below(3); n > 0; --n) {
        if (random.below(3) == 0) {
          mutant.binary[random.below(static_cast<std::uint32_t>(mutant.binary.size()))] =
              static_cast<std::byte>(random.below(256));
          continue;
        }
        std::vector<Json*> all;
        collect(mutant.json, all);
        Json& value = *all[random.below(static_cast<std::uint32_t>(all.size()))];
        const Json choices[] = {0,       1,          -1, 7, 5126, 1e39, "rotation", Json::array(), Json::object(),
                                nullptr, 4000000000u};
        value = choices[random.below(11)];
        if (!mutant.json.is_object()) mutant.json = good.json;
      }
      return load_gltf_from_memory(mutant.glb(), "mutant", {}, {}, PoseChoice{0.3f, std::nullopt});
    });
    std::size_t loaded = 0;
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_NE(outcomes[i].end, LoadOutcome::End::kFault) << "CAROUSEL_SEED=" << run_seed() + i << ": " << outcomes[i];
      loaded += outcomes[i].end == LoadOutcome::End::kLoaded;
    }
    EXPECT_GT(loaded, count / 50);
    std::cout << count << " mutants, " << loaded << " loaded\n";
  }
}

}  // namespace
}  // namespace carousel::scene::pose_damage_test
