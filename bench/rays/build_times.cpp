#include "bench/rays/build_times.h"

#include <algorithm>

#include "accel/builders/build.h"
#include "core/system/executor.h"

namespace carousel::bench {

namespace {

constexpr double kLongBuildSeconds = 3;

struct Built {
  double seconds = 0;
  std::size_t bytes = 0;
};

Built build_ours(const scene::Scene& scene, const BvhConfig& bvh, int threads) {
  const auto executor = make_tbb_executor(static_cast<std::size_t>(threads));
  const Stopwatch stopwatch;
  const accel::Accel accel = accel::build(scene, bvh, *executor);
  return {stopwatch.elapsed().wall, accel.size_bytes()};
}

Built build_embree(const scene::Scene& scene, const Field& field, EmbreeQuality quality, int threads) {
  const EmbreePeer peer(
      scene, {.robust = false, .quality = quality, .frequency_level = field.frequency_level, .build_threads = threads});
  return {peer.build_seconds(), peer.size_bytes()};
}

}  // namespace

std::vector<BuildResult> build_times(const scene::Scene& scene, const BvhConfig& bvh, const Field& field,
                                     const std::vector<int>& threads, int repetitions) {
  struct Builder {
    const char* name;
    std::function<Built(int)> build;
    int threads;
    std::vector<double> mtris;
    std::size_t bytes;
    bool longsome;
  };
  const double million_triangles = 1e-6 * static_cast<double>(scene.unique_triangle_count());
  std::vector<Builder> builders;
  for (const int t : threads) {
    builders.push_back({"carousel", [&](int n) { return build_ours(scene, bvh, n); }, t, {}, 0, false});
    builders.push_back({"Embree, medium quality",
                        [&](int n) { return build_embree(scene, field, EmbreeQuality::kMedium, n); },
                        t,
                        {},
                        0,
                        false});
    builders.push_back({"Embree, high quality",
                        [&](int n) { return build_embree(scene, field, EmbreeQuality::kHigh, n); },
                        t,
                        {},
                        0,
                        false});
  }
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    for (Builder& builder : builders) {
      if (builder.longsome) continue;
      const Built built = builder.build(builder.threads);
      builder.mtris.push_back(million_triangles / built.seconds);
      builder.bytes = built.bytes;
      builder.longsome = built.seconds > kLongBuildSeconds;
    }
  }
  std::vector<BuildResult> results;
  for (const Builder& builder : builders)
    results.push_back({builder.name, builder.threads, spread_of(builder.mtris),
                       1e-6 * static_cast<double>(builder.bytes) / million_triangles});
  return results;
}

double to_first_packet(const scene::Scene& scene, const BvhConfig& bvh, const RingSettings& ring, int threads,
                       int repetitions) {
  RaySet one{.name = "one"};
  one.push_back(Ray{});
  HitList hits(1);
  std::vector<double> seconds;
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    const auto executor = make_tbb_executor(static_cast<std::size_t>(threads));
    const Stopwatch stopwatch;
    const accel::Accel accel = accel::build(scene, bvh, *executor);
    const double built = stopwatch.elapsed().wall;
    const RingForm form{.traversal = Traversal::kTreelet, .home = Home::kIssuer, .resources = threads};
    const RingRun run = run_ring(accel, scene_size(scene), ring, form, one, threads, hits);
    seconds.push_back(built + run.to_first_packet_seconds);
    if (built > kLongBuildSeconds) break;
  }
  return spread_of(seconds).median;
}

}  // namespace carousel::bench
