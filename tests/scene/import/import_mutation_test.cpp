// Damaged files of other formats load or are refused; the module's process may break, and the program goes on.
#include <fstream>
#include <iostream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/module/module.h"
#include "scene/builtin/hash_random.h"
#include "scene/import/import_file.h"
#include "tests/scene/gltf/guarded_load.h"
#include "tests/scene/import/moving_files.h"
#include "tests/support/random_runs.h"

namespace carousel::scene::import_mutation_test {
namespace {

struct Sample {
  const char* name;
  std::string text;
};

const Sample kSamples[] = {
    {"a.obj",
     "mtllib a.mtl\no A\nv 0 0 0\nv 1 0 0 0.5 0.5 0.5\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 1\nvn 0 0 1\ng one two\nusemtl "
     "m\n"
     "f 1/1/1 2/2/1 3/1/1 4/2/1\ns 1\nf -4//1 -3//1 -2//1\nl 1 2\np 3\n# end\n"},
    {"a.ply",
     "ply\nformat ascii 1.0\ncomment x\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
     "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 2\n"
     "property list uchar int vertex_indices\nend_header\n0 0 0 1 2 3\n1 0 0 255 0 0\n1 1 0 9 9 9\n0 1 0 7 7 7\n"
     "3 0 1 2\n3 0 2 3\n"},
    {"a.stl",
     "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 3 0 0\nvertex 3 3 0\nendloop\nendfacet\nendsolid "
     "a\n"},
    {"a.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n"},
    {"a.dae", arm_collada()},
    {"a.fbx", kMovingFbx}};

/// Changes, removes, doubles or inserts some characters, or makes a number large or negative.
std::string mutant(std::string text, std::uint64_t seed) {
  HashRandom random(seed, 13);
  const auto below = [&](std::size_t n) { return random.below(static_cast<std::uint32_t>(n)); };
  for (std::uint32_t n = 1 + random.below(5); n > 0 && !text.empty(); --n) {
    const std::size_t at = below(text.size());
    switch (random.below(6)) {
      case 0:
        text[at] = static_cast<char>(random.below(256));
        break;
      case 1:
        text.erase(at, 1 + below(8));
        break;
      case 2:
        text.insert(at, text.substr(below(text.size()), below(20)));
        break;
      case 3:
        text.insert(at, random.below(2) == 0 ? "4000000000" : "-99999");
        break;
      case 4:
        text[at] = static_cast<char>('0' + random.below(10));
        break;
      default:
        text.resize(at);
        break;
    }
  }
  return text;
}

TEST(ImportMutation, DamagedTextsLoadOrAreRefused) {
  if (!std::filesystem::exists(module_folder() / "scenes.so")) GTEST_SKIP() << "built without libassimp-dev";
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("carousel-mutants-" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  std::size_t loaded_of_all = 0;
  for (const Sample& sample : kSamples) {
    const auto count = static_cast<std::size_t>(scaled(30));
    SceneImporter importer;
    const auto outcomes = load_guarded(
        count,
        [&](std::size_t i) {
          std::ofstream(folder / sample.name, std::ios::binary) << mutant(sample.text, run_seed() + i);
          return importer.load(folder / sample.name, {}, {}, PoseChoice{0.5f, std::nullopt});
        },
        30);
    std::size_t loaded = 0, broken = 0;
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_NE(outcomes[i].end, LoadOutcome::End::kFault)
          << sample.name << ", CAROUSEL_SEED=" << run_seed() + i << ": " << outcomes[i];
      loaded += outcomes[i].end == LoadOutcome::End::kLoaded;
      broken += outcomes[i].message.find("broke down") != std::string::npos;
    }
    loaded_of_all += loaded;
    std::cout << count << " mutants of " << sample.name << ": " << loaded << " loaded, the library broke over "
              << broken << "\n";
  }
  EXPECT_GT(loaded_of_all, 0u) << "no mutant is sound enough to be read";
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace carousel::scene::import_mutation_test
