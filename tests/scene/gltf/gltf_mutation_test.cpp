// A file with any contents either loads or leads to a SceneError: random changes of bytes and of JSON values.
#include <iostream>

#include "scene/builtin/hash_random.h"
#include "tests/scene/gltf/guarded_load.h"
#include "tests/scene/gltf/packed_model.h"
#include "tests/scene/gltf/rich_model.h"
#include "tests/support/random_runs.h"

namespace carousel::scene {
namespace {

using Json = nlohmann::json;

struct Model {
  const char* name;
  GltfBuilder file;
  int mutants;  // mutants of each kind; larger files take longer
};

std::vector<Model> models() {
  return {{"every feature", every_feature(), 4000},
          {"every extension", every_extension(), 1000},
          {"rich model", rich_model().packed(), 500},
          {"sample", sample_model().packed(), 1000}};
}

/// Makes and loads mutants of a model. Seeds count on from CAROUSEL_SEED.
void expect_loaded_or_refused(const Model& model, const std::function<Scene(std::uint64_t seed)>& load) {
  const auto count = static_cast<std::size_t>(scaled(model.mutants));
  std::size_t loaded = 0;
  const auto outcomes = load_guarded(count, [&](std::size_t i) { return load(run_seed() + i); });
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_NE(outcomes[i].end, LoadOutcome::End::kFault)
        << model.name << ", CAROUSEL_SEED=" << run_seed() + i << ": " << outcomes[i];
    loaded += outcomes[i].end == LoadOutcome::End::kLoaded;
  }
  EXPECT_GT(loaded, count / 200) << "the mutants test nothing but the JSON parser";
  std::cout << count << " mutants of " << model.name << ", " << loaded << " loaded\n";
}

TEST(GltfMutation, TheUnchangedFilesLoad) {
  for (const Model& model : models()) {
    const std::vector<std::byte> bytes = model.file.glb();
    const Scene scene = load_gltf_from_memory(bytes, model.name);
    EXPECT_EQ(model.file.load().instanced_triangle_count(), scene.instanced_triangle_count());
    EXPECT_GT(scene.images.size(), 0u);
  }
}

TEST(GltfMutation, ChangedBytesLoadOrAreRefused) {
  for (const Model& model : models()) {
    const std::vector<std::byte> good = model.file.glb();
    expect_loaded_or_refused(model, [&](std::uint64_t seed) {
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
      return load_gltf_from_memory(bytes, "mutant");
    });
  }
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

Json changed(const Json& good, std::uint64_t seed) {
  HashRandom random(seed, 8);
  Json mutant = good;
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
  return mutant;
}

TEST(GltfMutation, ChangedJsonLoadsOrIsRefused) {
  for (const Model& model : models()) {
    GltfBuilder good = model.file;
    good.json["buffers"] = Json::array({{{"byteLength", good.binary.size()}}});
    // The bytes of a larger model as text would take too long.
    if (good.binary.size() < 2000) good.json["buffers"] = Json::parse(model.file.text())["buffers"];
    expect_loaded_or_refused(model, [&](std::uint64_t seed) {
      GltfBuilder mutant = good;
      mutant.json = changed(good.json, seed);
      return load_gltf_from_memory(mutant.glb(), "mutant");
    });
  }
}

}  // namespace
}  // namespace carousel::scene
