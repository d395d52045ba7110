// Tests of the guard itself: it must notice every kind of fault.
#include "tests/scene/gltf/guarded_load.h"

#include <csignal>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/system/error.h"
#include "scene/builtin/builtin.h"

namespace carousel::scene {
namespace {

using End = LoadOutcome::End;

Scene good() {
  SceneConfig config;
  config.builtin = BuiltinScene::kCornell;
  return make_builtin(config);
}

TEST(GuardedLoad, SeesFaultsOfEveryKindAndGoesOn) {
  const std::vector<std::function<Scene()>> loads{
      good,
      []() -> Scene { throw SceneError("file", "/nodes/0", "broken \xff"); },
      []() -> Scene { throw std::runtime_error("not a SceneError"); },
      []() -> Scene {
        raise(SIGKILL);
        return good();
      },
      []() -> Scene {
        for (;;) pause();
      },
      [] {
        if (!kMemoryIsGuarded) throw std::bad_alloc();
        const std::vector<char> greed(std::size_t{1} << 30);
        return good();
      },
      [] {
        Scene scene = good();
        scene.meshes[0].indices[4] = 1'000'000;
        return scene;
      },
      good};
  const std::vector<LoadOutcome> outcomes = load_guarded(
      loads.size(), [&](std::size_t i) { return loads[i](); }, 3);
  const std::vector<LoadOutcome> expected{{End::kLoaded, "", ""},
                                          {End::kRefused, "/nodes/0", "broken ?"},
                                          {End::kFault, "", "another exception: not a SceneError"},
                                          {End::kFault, "", "killed: Killed"},
                                          {End::kFault, "", "it takes too long"},
                                          {End::kFault, "", "another exception: std::bad_alloc"},
                                          {End::kFault, "", "an index is beyond the positions"},
                                          {End::kLoaded, "", ""}};
  ASSERT_EQ(outcomes.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(outcomes[i], expected[i]) << i;
}

}  // namespace
}  // namespace carousel::scene
