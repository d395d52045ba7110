#include "shading/tracer/path_tracer.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "tests/shading/path/brute_force_tracer.h"
#include "tests/shading/path/small_scenes.h"
#include "tests/shading/path/threaded_frame.h"

namespace carousel::shading {
namespace {

Config tiny_image() {
  Config config;
  config.image = {21, 21, 8, 6, 7};  // tiles cut at the right and below
  return config;
}

struct Outcome {
  std::string image;
  HitsDigest hits;
  PathTracer::Counts counts;
};

Outcome outcome(const PathTracer& tracer) {
  return {tracer.image_digest(), tracer.hits_digest(), tracer.counts()};
}

void expect_same(const Outcome& a, const Outcome& b) {
  EXPECT_EQ(a.image, b.image);
  EXPECT_EQ(a.hits.hex(), b.hits.hex());
  EXPECT_EQ(a.counts.emitted, b.counts.emitted);
  EXPECT_EQ(a.counts.completed, b.counts.completed);
  EXPECT_EQ(a.counts.paths, b.counts.paths);
}

TEST(PathTracer, DoesNotDependOnBatchesPathsInFlightOrderOrWorkers) {
  const scene::Scene scene = mixed_scene();
  const BruteForceTracer tracer(scene);
  const Config config = tiny_image();
  PathTracer reference(scene, config, 100000, 1);
  run_frame(reference, tracer, 1u << 20);
  const Outcome expected = outcome(reference);
  EXPECT_EQ(expected.counts.paths, 21u * 21 * 8);
  EXPECT_EQ(expected.counts.emitted[0], 21u * 21 * 8);
  EXPECT_GT(expected.counts.emitted[1], 1000u);
  EXPECT_GT(expected.counts.emitted[2], 1000u);
  EXPECT_EQ(expected.counts.emitted, expected.counts.completed);
  EXPECT_EQ(expected.counts.saturated, 0u);

  for (const auto& [paths, batch] : {std::pair{1, 1}, {1, 64}, {7, 3}, {1000, 17}}) {
    PathTracer one(scene, config, std::size_t(paths), 1);
    run_frame(one, tracer, std::size_t(batch));
    expect_same(outcome(one), expected);
  }
  for (const auto& [workers, paths, batch] : {std::tuple{1, 50, 9}, {2, 300, 40}, {4, 3, 5}, {5, 1000, 64}}) {
    PathTracer many(scene, config, std::size_t(paths), std::size_t(workers));
    run_unruly_frame(many, tracer, std::size_t(workers), std::size_t(batch), 99);
    expect_same(outcome(many), expected);
  }
}

TEST(PathTracer, EveryRayHasItsOwnName) {
  class Names : public RayRecorder {
   public:
    void record(WorkerId, std::uint32_t pixel, std::uint32_t sample, const RayResult& r) override {
      const bool fresh = seen_.emplace(pixel, sample, int(r.tag.kind), r.tag.bounce, r.tag.index).second;
      EXPECT_TRUE(fresh);
    }
    std::size_t count() const { return seen_.size(); }

   private:
    std::set<std::tuple<std::uint32_t, std::uint32_t, int, int, int>> seen_;
  } names;
  const scene::Scene scene = mixed_scene();
  PathTracer tracer(scene, tiny_image(), 64, 1);
  tracer.set_recorder(&names);
  run_frame(tracer, BruteForceTracer(scene), 50);
  const auto completed = tracer.counts().completed;
  EXPECT_EQ(names.count(), completed[0] + completed[1] + completed[2]);
}

TEST(PathTracer, GeneratesNothingButIsNotFinishedWhileNoStateIsFree) {
  const scene::Scene scene = mixed_scene();
  PathTracer tracer(scene, tiny_image(), 4, 1);
  RayBatch rays;
  Workload::Generated generated = tracer.generate(WorkerId(0), 100, rays);
  EXPECT_EQ(generated.rays, 4u);
  EXPECT_FALSE(generated.finished);
  generated = tracer.generate(WorkerId(0), 100, rays);
  EXPECT_EQ(generated.rays, 0u);
  EXPECT_FALSE(generated.finished);
  EXPECT_EQ(rays.size(), 4u);
}

TEST(PathTracer, DepthLimitsTheSurfacesOfAPath) {
  const scene::Scene scene = mixed_scene();
  const BruteForceTracer tracer(scene);
  Config config = tiny_image();
  config.image.max_depth = 1;
  PathTracer direct(scene, config, 100, 1);
  run_frame(direct, tracer, 100);
  EXPECT_EQ(direct.counts().emitted[1], 0u);
  EXPECT_GT(direct.counts().emitted[2], 0u);
}

TEST(PathTracer, SkyFillsWhatNothingHides) {
  scene::Scene scene = empty_scene();
  add_material(scene, matte({1, 1, 1}));
  scene.sky.radiance = {0.25f, 0.5f, 2.0f};
  PathTracer tracer(scene, tiny_image(), 64, 1);
  run_frame(tracer, BruteForceTracer(scene), 32);
  const std::vector<float> rgb = tracer.linear_rgb();
  for (std::size_t i = 0; i < rgb.size(); i += 3) {
    EXPECT_EQ(rgb[i], 0.25f);
    EXPECT_EQ(rgb[i + 1], 0.5f);
    EXPECT_EQ(rgb[i + 2], 2.0f);
  }
}

TEST(PathTracer, AWhiteSurfaceDisappearsInAWhiteWorld) {
  for (const float metallic : {0.0f, 0.5f, 1.0f}) {
    for (const float roughness : {0.1f, 0.5f, 1.0f}) {
      scene::Scene scene = empty_scene();
      scene::Material white = matte({1, 1, 1});
      white.metallic = metallic;
      white.roughness = roughness;
      const std::uint32_t m = add_material(scene, white);
      add_quad(scene, {-9, 0, 9}, {9, 0, 9}, {9, 0, -9}, {-9, 0, -9}, m);
      scene.sky.radiance = Vec3{1};
      scene.cameras[0] = looking_down(5, 1);
      Config config;
      config.image = {16, 16, 16, 2, 1};
      PathTracer tracer(scene, config, 1000, 1);
      run_frame(tracer, BruteForceTracer(scene), 100);
      const std::vector<float> rgb = tracer.linear_rgb();
      double mean = 0;
      for (const float c : rgb) mean += c / double(rgb.size());
      EXPECT_NEAR(mean, 1.0, 0.01) << metallic << " " << roughness;
    }
  }
}

TEST(PathTracer, UnlitSurfacesShowTheirColourAndEndThePath) {
  scene::Scene scene = empty_scene();
  scene::Material flat = matte({0.5f, 0.25f, 0.125f});
  flat.unlit = true;
  const std::uint32_t m = add_material(scene, flat);
  add_quad(scene, {-9, 0, 9}, {9, 0, 9}, {9, 0, -9}, {-9, 0, -9}, m);
  scene.sky.radiance = Vec3{7};
  scene.cameras[0] = looking_down(5, 1);
  PathTracer tracer(scene, tiny_image(), 64, 1);
  run_frame(tracer, BruteForceTracer(scene), 32);
  const std::vector<float> rgb = tracer.linear_rgb();
  EXPECT_EQ(rgb[0], 0.5f);
  EXPECT_EQ(rgb[1], 0.25f);
  EXPECT_EQ(rgb[2], 0.125f);
  EXPECT_EQ(tracer.counts().emitted[1] + tracer.counts().emitted[2], 0u);
}

TEST(PathTracer, RaysThatLeaveASurfaceDoNotMeetItAgain) {
  // A convex body far away from the origin, black, under a sky: any bounce ray that hits anything hits the
  // triangle it came from, or a neighbour across an edge.
  scene::Scene scene = empty_scene();
  const std::uint32_t m = add_material(scene, matte({0.9f, 0.9f, 0.9f}));
  const Vec3 far{1000, -2000, 3000};
  add_mesh(scene, {{-1, -1, -1}, {1, -1, -1}, {0, 1, -1}, {0, 0, 1}}, {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3}, m,
           {Mat3(0.8f, 0.6f, 0, -0.6f, 0.8f, 0, 0, 0, 1), far});
  scene.cameras[0].position = far + Vec3{0, 0, 4};
  scene.sky.radiance = Vec3{1};
  class BounceHits : public RayRecorder {
   public:
    void record(WorkerId, std::uint32_t, std::uint32_t, const RayResult& r) override {
      if (r.tag.kind != RayKind::kBounce) return;
      ++rays;
      hits += r.hit.valid() ? 1 : 0;
    }
    int rays = 0, hits = 0;
  } bounces;
  Config config;
  config.image = {32, 32, 16, 2, 3};
  PathTracer tracer(scene, config, 100, 1);
  tracer.set_recorder(&bounces);
  run_frame(tracer, BruteForceTracer(scene), 100);
  EXPECT_GT(bounces.rays, 1000);
  EXPECT_EQ(bounces.hits, 0);
}

}  // namespace
}  // namespace carousel::shading
