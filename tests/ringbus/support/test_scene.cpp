#include "tests/ringbus/support/test_scene.h"

#include <cmath>

#include <fmt/format.h>

#include "accel/builders/build.h"
#include "accel/traverse/reference_tracer.h"
#include "core/config/config.h"
#include "core/system/executor.h"
#include "core/types/enum_names.h"
#include "scene/builtin/builtin.h"
#include "tests/support/random_runs.h"

namespace carousel::ringbus {

namespace {

std::string levels(const AccuracyConfig& a) {
  return fmt::format("{} {} {}", enum_name(a.triangle), enum_name(a.box), enum_name(a.transform));
}

std::string structure(const BvhConfig& b, const CullPlanesConfig& p) {
  return fmt::format("{} {} {} {} {} {} {} {} {} treelets {} planes {} {} {} {} {} {}", b.width, b.leaf_triangles,
                     enum_name(b.storage), enum_name(b.elements), b.mixed_triangles, b.top_triangles, b.levels,
                     enum_name(b.builder), b.duplicates, b.treelets.bytes, p.count, enum_name(p.nodes),
                     enum_name(p.fit), p.shared_normals, enum_name(p.order), enum_name(p.levels));
}

}  // namespace

scene::Scene builtin_scene(BuiltinScene builtin, std::int64_t triangles, std::int64_t instances, std::int64_t levels) {
  SceneConfig config;
  config.levels = levels;
  config.builtin = builtin;
  config.triangles = triangles;
  config.instances = instances;
  return scene::make_builtin(config);
}

const accel::Accel& TestScene::accel(const BvhConfig& bvh, const CullPlanesConfig& planes,
                                     const AccuracyConfig& accuracy) {
  auto& built = accels_[structure(bvh, planes) + levels(accuracy)];
  if (!built) {
    built = std::make_unique<accel::Accel>(accel::build(scene_, bvh, *make_sequential_executor(), accuracy, planes));
    built->any_hit = any_hit_;
  }
  return *built;
}

ScatterWorkload TestScene::workload() const {
  return ScatterWorkload(bounds_, paths_, bounces_, 6 + run_seed(), away_, any_hit_ != nullptr);
}

std::unique_ptr<Workload> TestScene::new_workload() const {
  return std::make_unique<ScatterWorkload>(bounds_, paths_, bounces_, 6 + run_seed(), away_, any_hit_ != nullptr);
}

float TestScene::size() const {
  const Vec3 e = bounds_.extent();
  return std::sqrt(e.x * e.x + e.y * e.y + e.z * e.z);
}

const TestScene::Reference& TestScene::reference(const AccuracyConfig& accuracy) {
  const auto [found, is_new] = references_.try_emplace(levels(accuracy));
  if (is_new) {
    ScatterWorkload reference = workload();
    accel::run_reference(accel(BvhConfig{}, {}, accuracy), reference);
    found->second = {reference.digest(), reference.rays()};
  }
  return found->second;
}

}  // namespace carousel::ringbus
