// The rasteriser's hits against those of rays, and against exact arithmetic where the two differ.
#include "shading/raster/first_hits.h"

#include <array>
#include <cstdint>
#include <deque>
#include <iostream>
#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "accel/builders/build.h"
#include "accel/structure/accel.h"
#include "accel/traverse/exact_reference.h"
#include "accel/traverse/reference_tracer.h"
#include "core/system/executor.h"
#include "ringbus/cycle/cycle_engine.h"
#include "ringbus/verdict/bottleneck_search.h"
#include "scene/builtin/builtin.h"
#include "scene/builtin/mesh_shapes.h"
#include "shading/surface/alpha_test.h"
#include "shading/tracer/path_tracer.h"
#include "tests/ringbus/support/test_machine.h"
#include "tests/support/random_runs.h"

namespace carousel::ringbus {
namespace {

Config picture(std::int64_t width, std::int64_t height, std::int64_t samples) {
  Config config;
  config.image = {width, height, samples, 4, static_cast<std::int64_t>(run_seed())};
  return config;
}

std::vector<Ray> camera_rays(const scene::Scene& scene, const Config& config) {
  const auto width = static_cast<std::uint32_t>(config.image.width),
             height = static_cast<std::uint32_t>(config.image.height);
  const auto samples = static_cast<std::uint32_t>(config.image.samples);
  const shading::CameraRays camera(scene.cameras.at(static_cast<std::size_t>(config.scene.camera)), config.camera,
                                   width, height);
  const shading::Sampler sampler(static_cast<std::uint64_t>(config.image.seed), samples);
  std::vector<Ray> rays;
  for (std::uint32_t pixel = 0; pixel < width * height; ++pixel)
    for (std::uint32_t s = 0; s < samples; ++s)
      rays.push_back(camera.ray(pixel % width, pixel / width, sampler.camera(pixel, s)));
  return rays;
}

bool same(const Hit& a, const Hit& b) {
  return a.instance == b.instance && (!a.valid() || a.primitive == b.primitive);
}

/// Rays and raster name the same first triangle at every sample, except where exact arithmetic finds a tie, or that the
/// rays' single precision was wrong.
void expect_same_first_hits(const scene::Scene& scene, const Config& config, const std::string& name) {
  const accel::Accel accel = accel::build(scene, BvhConfig{}, *make_sequential_executor());
  const accel::ExactReference exact(scene);
  const auto threads = make_jthread_executor(2);
  const shading::FirstHits raster = shading::rasterize_first_hits(scene, config, nullptr, *threads);
  const std::vector<Ray> rays = camera_rays(scene, config);
  RayBatch requests;
  for (const Ray& ray : rays) requests.push_back({ray, {}});
  HitBatch traced;
  IntersectionCounts tests;
  accel::trace_depth_first(accel, requests, traced, tests);
  ASSERT_EQ(raster.hits.size(), traced.size());

  std::size_t hits = 0, ties = 0, rounded = 0;
  for (std::size_t i = 0; i < traced.size(); ++i) {
    const Hit &found = raster.hits[i], &expected = traced[i].hit;
    hits += found.valid();
    if (same(found, expected)) {
      if (!found.valid() || i % 8 != 0) continue;
      const Hit truth = exact.closest(rays[i]).hit;
      EXPECT_NEAR(found.t, truth.t, 4e-7f * truth.t) << name << " sample " << i;
      EXPECT_NEAR(found.u, truth.u, 1e-6f) << name << " sample " << i;
      EXPECT_NEAR(found.v, truth.v, 1e-6f) << name << " sample " << i;
      continue;
    }
    const accel::ExactHit truth = exact.closest(rays[i]);
    if (truth.tie) {
      ++ties;
    } else {
      ++rounded;
      EXPECT_TRUE(same(found, truth.hit))
          << name << " sample " << i << ": raster " << found.instance << ' ' << found.primitive << " t " << found.t
          << ", rays " << expected.instance << ' ' << expected.primitive << " t " << expected.t << ", exactly "
          << truth.hit.instance << ' ' << truth.hit.primitive << " t " << truth.t;
    }
  }
  EXPECT_GT(hits, traced.size() / 10) << name << ": nothing to see";
  EXPECT_LT(ties + rounded, 20 + traced.size() / 500) << name;
  EXPECT_EQ(raster.counts.hits, hits);
  EXPECT_EQ(raster.counts.hits + raster.counts.misses, traced.size());
  std::cout << name << ": " << traced.size() << " samples, " << ties << " exact ties, " << rounded
            << " where rays rounded to another triangle\n";
}

TEST(FirstHits, AreThoseOfRays) {
  for (const auto& [builtin, name] :
       {std::pair(BuiltinScene::kCornell, "cornell"), std::pair(BuiltinScene::kTerrain, "terrain"),
        std::pair(BuiltinScene::kSpheres, "spheres"), std::pair(BuiltinScene::kInstances, "instances"),
        std::pair(BuiltinScene::kSliver, "sliver")}) {
    const scene::Scene scene = builtin_scene(builtin, 20000, 60);
    expect_same_first_hits(scene, picture(96, 70, 3), name);
  }
}

TEST(FirstHits, OfAnOrthographicCamera) {
  scene::Scene scene = builtin_scene(BuiltinScene::kInstances, 5000, 60);
  scene::Camera& camera = scene.cameras[0];
  camera.projection = scene::Camera::Projection::kOrthographic;
  const Vec3 extent = scene.bounds().extent();
  camera.xmag = camera.ymag = 0.3f * std::max({extent.x, extent.y, extent.z});
  expect_same_first_hits(scene, picture(80, 60, 2), "orthographic");
}

// A camera in the middle of things: triangles behind it, across its plane, and in front.
TEST(FirstHits, WithTrianglesAroundTheCamera) {
  if (kThreadSanitizer) GTEST_SKIP() << kOneThread;
  scene::Scene scene = builtin_scene(BuiltinScene::kTerrain, 2000, 60);
  scene::Mesh room;
  add_box(room, Vec3(-20), Vec3(20), MaterialId(0));
  room.normals.clear();
  scene.meshes.push_back(room);
  scene.instances.push_back({MeshId(static_cast<std::uint32_t>(scene.meshes.size() - 1)), {}});
  scene.cameras[0].position = {1, 3, 2};
  for (const float znear : {0.0f, 0.5f}) {
    scene.cameras[0].znear = znear;
    expect_same_first_hits(scene, picture(64, 64, 2), znear > 0 ? "inside, znear" : "inside");
  }
}

// Two meshes in the same place: every sample is a tie, and the smaller instance has it.
TEST(FirstHits, TiesGoToTheSmallestInstance) {
  if (kThreadSanitizer) GTEST_SKIP() << kOneThread;
  scene::Scene scene = builtin_scene(BuiltinScene::kCornell, 36, 60);
  const std::size_t instances = scene.instances.size();
  for (std::size_t i = 0; i < instances; ++i) scene.instances.push_back(scene.instances[i]);
  const auto raster = shading::rasterize_first_hits(scene, picture(40, 40, 2), nullptr, *make_sequential_executor());
  EXPECT_GT(raster.counts.hits, 1000u);
  for (const Hit& hit : raster.hits) {
    if (hit.valid()) {
      EXPECT_LT(hit.instance, instances);
    }
  }
  expect_same_first_hits(scene, picture(40, 40, 2), "doubled");
}

// Cut-outs and veils, spheres among them, sides that are culled: asked, culled and left out as rays do.
TEST(FirstHits, WithWhatLetsRaysThrough) {
  if (kThreadSanitizer) GTEST_SKIP() << kOneThread;
  scene::Scene scene = builtin_scene(BuiltinScene::kInstances, 3000, 60);
  const MaterialId blended(static_cast<std::uint32_t>(scene.materials.size()));
  scene.materials.emplace_back().alpha_mode = scene::AlphaMode::kBlend;
  scene.materials.back().base_color.a = 0.4f;
  for (scene::Mesh& mesh : scene.meshes)
    for (std::size_t t = 0; t < mesh.triangle_count(); t += 2) mesh.triangle_materials[t] = blended;
  const shading::AlphaTest alpha(scene);
  Config config = picture(64, 48, 2);
  accel::Accel accel = accel::build(scene, BvhConfig{}, *make_sequential_executor());
  accel.any_hit = &alpha;
  for (const auto cull : {RayFlags::Cull::kNone, RayFlags::Cull::kBack, RayFlags::Cull::kFront}) {
    config.shading.camera_rays.cull = cull;
    const std::uint8_t flags = cull == RayFlags::Cull::kBack    ? kRayCullBack
                               : cull == RayFlags::Cull::kFront ? kRayCullFront
                                                                : 0;
    const auto raster = shading::rasterize_first_hits(scene, config, &alpha, *make_sequential_executor());
    EXPECT_GT(raster.counts.any_hit_calls, 100u);
    const std::vector<Ray> rays = camera_rays(scene, config);
    RayBatch requests;
    for (const Ray& ray : rays) requests.push_back({ray, {0, RayKind::kCamera, 0, 0, flags}});
    HitBatch traced;
    IntersectionCounts tests;
    accel::trace_depth_first(accel, requests, traced, tests);
    std::size_t different = 0, hits = 0;
    for (std::size_t i = 0; i < traced.size(); ++i) {
      different += !same(raster.hits[i], traced[i].hit);
      hits += traced[i].hit.valid();
    }
    EXPECT_GT(hits, traced.size() / 10);
    EXPECT_LE(different, traced.size() / 1000);  // a rounded edge here and there
  }
}

// Vertices on pixel corners and rays through shared edges: every sample meets one of the triangles.
TEST(FirstHits, LeaveNoGaps) {
  if (kThreadSanitizer) GTEST_SKIP() << kOneThread;
  scene::Scene scene = builtin_scene(BuiltinScene::kSpheres, 20000, 60);
  scene.meshes.resize(1);
  scene.instances.resize(1);
  scene.meshes[0] = {};
  scene.instances[0] = {MeshId(0), {}};
  add_icosphere(scene.meshes[0], Vec3(0), 1, 4, MaterialId(0));
  scene.cameras[0].position = Vec3(0);  // in the centre of a closed ball
  const auto raster = shading::rasterize_first_hits(scene, picture(128, 128, 4), nullptr, *make_sequential_executor());
  EXPECT_EQ(raster.counts.misses, 0u);
}

TEST(FirstHits, SpheresAreLeftToRays) {
  if (kThreadSanitizer) GTEST_SKIP() << kOneThread;
  scene::Scene scene = builtin_scene(BuiltinScene::kCornell, 36, 60);
  const auto before = shading::rasterize_first_hits(scene, picture(32, 32, 1), nullptr, *make_sequential_executor());
  EXPECT_EQ(before.counts.left_to_rays, 0u);
  scene::Mesh ball;
  const scene::Camera& camera = scene.cameras[0];
  ball.spheres.push_back({camera.position - 2.0f * camera.back, 0.2f, MaterialId(0)});
  scene.meshes.push_back(ball);
  scene.instances.push_back({MeshId(static_cast<std::uint32_t>(scene.meshes.size() - 1)), {}});
  const auto after = shading::rasterize_first_hits(scene, picture(32, 32, 1), nullptr, *make_sequential_executor());
  EXPECT_GT(after.counts.left_to_rays, 10u);
  EXPECT_LT(after.counts.left_to_rays, 1024u);
  EXPECT_EQ(after.at(16 * 32 + 16, 0), nullptr);
  EXPECT_NE(after.at(0, 0), nullptr);
}

// The whole frame: no camera ray, each path once, nearly the same picture, and the same one however rays are handed
// over.
TEST(FirstHits, PathsStartAtThem) {
  if (kThreadSanitizer) GTEST_SKIP() << kOneThread;
  const scene::Scene scene = builtin_scene(BuiltinScene::kCornell, 36, 60);
  const Config config = picture(24, 20, 8);
  const accel::Accel accel = accel::build(scene, BvhConfig{}, *make_sequential_executor());
  const auto raster = shading::rasterize_first_hits(scene, config, nullptr, *make_sequential_executor());
  shading::PathTracer by_rays(scene, config, 1000, 1);
  accel::run_reference(accel, by_rays);
  std::string digest;
  for (const std::size_t batch : {1, 2, 7, 4096}) {
    for (const std::size_t paths : {1, 1000}) {
      shading::PathTracer tracer(scene, config, paths, 1);
      tracer.set_first_hits(&raster);
      accel::run_reference(accel, tracer, batch);
      const auto counts = tracer.counts();
      EXPECT_EQ(counts.emitted[0], 0u);
      EXPECT_EQ(counts.paths, 24u * 20 * 8);
      EXPECT_EQ(counts.emitted, counts.completed);
      if (digest.empty()) digest = tracer.image_digest();
      EXPECT_EQ(tracer.image_digest(), digest) << batch << " rays at a time";
      const std::vector<float> a = by_rays.linear_rgb(), b = tracer.linear_rgb();
      double difference = 0, sum = 0;
      for (std::size_t i = 0; i < a.size(); ++i) {
        difference += std::abs(a[i] - b[i]);
        sum += a[i];
      }
      EXPECT_LT(difference, 0.02 * sum);
    }
  }
}

TEST(FirstHits, EnginesAgree) {
  const scene::Scene scene = builtin_scene(BuiltinScene::kTerrain, 500, 60);
  Config config = picture(16, 12, 2);
  config.primary = Primary::kRaster;
  const auto raster = shading::rasterize_first_hits(scene, config, nullptr, *make_sequential_executor());
  const accel::Accel accel = accel::build(scene, config.bvh, *make_sequential_executor());
  shading::PathTracer reference(scene, config, 1000, 1);
  reference.set_first_hits(&raster);
  accel::run_reference(accel, reference);
  for (const std::int64_t workers : {1, 3}) {
    config.shading.workers = workers;
    config.topology.resources = 3;
    config.rays.slots_per_resource = 5;
    shading::PathTracer tracer(scene, config, 15, static_cast<std::size_t>(workers));
    tracer.set_first_hits(&raster);
    run_native(config, accel, 10, tracer, on_threads(2));
    EXPECT_EQ(tracer.hits_digest().hex(), reference.hits_digest().hex());
    EXPECT_EQ(tracer.image_digest(), reference.image_digest());
    config.engine.kind = EngineKind::kCycle;
    std::uint64_t cycles = 0;
    for (const std::size_t threads : {1, 2}) {
      shading::PathTracer simulated(scene, config, 15, static_cast<std::size_t>(workers));
      simulated.set_first_hits(&raster);
      const RunResult result = run_cycle(config, accel, 10, simulated, on_threads(threads));
      EXPECT_EQ(simulated.hits_digest().hex(), reference.hits_digest().hex());
      EXPECT_EQ(simulated.image_digest(), reference.image_digest());
      EXPECT_EQ(result.rays_completed, simulated.counts().emitted[1] + simulated.counts().emitted[2]);
      if (cycles == 0) cycles = result.cycle->cycles;
      EXPECT_EQ(result.cycle->cycles, cycles);
    }
    config.engine.kind = EngineKind::kNative;
  }
}

TEST(FirstHits, TheBottleneckIsFoundWithoutCameraRays) {
  if (kThreadSanitizer) GTEST_SKIP() << kOneThread;
  const scene::Scene scene = builtin_scene(BuiltinScene::kCornell, 36, 60);
  constexpr std::uint64_t kPaths = 80 * 56, kRun = 16;
  Config config = picture(80, 56, 1);
  config.engine.kind = EngineKind::kCycle;
  config.topology.resources = 3;
  config.rays.slots_per_resource = 20;
  config.shading.workers = 1;
  config.shading.cycles_per_shade = 400;
  const auto raster = shading::rasterize_first_hits(scene, config, nullptr, *make_sequential_executor());
  const accel::Accel accel = accel::build(scene, config.bvh, *make_sequential_executor());
  std::deque<shading::PathSample> samples;
  const auto frame = [&](const Config& machine, std::uint64_t paths, std::uint64_t = 0, std::uint64_t = 0) {
    auto tracer = std::make_unique<shading::PathTracer>(scene, machine, 60, 1);
    tracer->set_first_hits(&raster);
    if (paths < kPaths) {
      std::vector<shading::PathSample::Run> runs;
      for (std::uint64_t i = 0; i < paths / kRun; ++i)
        runs.push_back({i * (kPaths / kRun) / (paths / kRun) * kRun, kRun});
      tracer->set_sample(&samples.emplace_back(std::move(runs)));
    }
    return tracer;
  };
  const auto tracer = frame(config, kPaths);
  const RunResult run = run_cycle(config, accel, 10, *tracer, on_threads(1));
  const Bottleneck found = find_bottleneck(config, accel, 10, frame, {run, kPaths}, on_threads(1));
  ASSERT_FALSE(found.gains.empty());
  EXPECT_EQ(found.gains.front().name, "shading");
}

// A pilot begins only some of the paths, with rays held back.
TEST(FirstHits, APilotBeginsOnlyItsPaths) {
  if (kThreadSanitizer) GTEST_SKIP() << kOneThread;
  const scene::Scene scene = builtin_scene(BuiltinScene::kCornell, 36, 60);
  const Config config = picture(40, 24, 2);
  const auto raster = shading::rasterize_first_hits(scene, config, nullptr, *make_sequential_executor());
  const shading::PathSample sample({{128, 64}, {640, 128}});
  const accel::Accel accel = accel::build(scene, config.bvh, *make_sequential_executor());
  for (const bool rasterised : {false, true}) {
    shading::PathTracer tracer(scene, config, 60, static_cast<std::size_t>(shader_workers(config)));
    if (rasterised) tracer.set_first_hits(&raster);
    tracer.set_sample(&sample);
    run_native(config, accel, 10, tracer, on_threads(1));
    EXPECT_EQ(tracer.counts().paths, 192u);
  }
}

}  // namespace
}  // namespace carousel::ringbus
