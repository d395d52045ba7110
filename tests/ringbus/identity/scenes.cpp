#include "tests/ringbus/identity/scenes.h"

#include <glm/geometric.hpp>

namespace carousel::ringbus {

namespace {

constexpr std::uint32_t kScenePaths = 150;
constexpr std::uint8_t kBounces = 3;

/// Every other instance becomes a rotation and a translation, which one level of the transform tells apart.
void remove_some_scales(scene::Scene& scene) {
  for (std::size_t i = 0; i < scene.instances.size(); i += 2) {
    Mat3& linear = scene.instances[i].world_from_model.linear;
    for (int c = 0; c < 3; ++c) linear[c] = Vec3(glm::normalize(DVec3(linear[c])));
  }
}

}  // namespace

TestScene& Scenes::of(const Cell& cell) {
  const BuiltinScene builtin = cell.config.scene.builtin.value_or(BuiltinScene::kCornell);
  std::unique_ptr<TestScene>& made = scenes_[{builtin, cell.config.scene.levels, cell.non_opaque, cell.away}];
  if (!made) {
    scene::Scene scene = cell.non_opaque ? accel::passing_scene(builtin, 20, run_seed(), cell.config.scene.levels)
                                         : builtin_scene(builtin, 600, 300, cell.config.scene.levels);
    if (builtin == BuiltinScene::kInstances) remove_some_scales(scene);
    made = std::make_unique<TestScene>(std::move(scene), kScenePaths, kBounces, cell.away,
                                       cell.non_opaque ? &accept_some_ : nullptr);
  }
  return *made;
}

}  // namespace carousel::ringbus
