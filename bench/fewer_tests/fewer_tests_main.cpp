// bench_fewer_tests: measures the cost and savings in software of methods that promise fewer tests, on the same rays.
#include <algorithm>
#include <cstdio>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "accel/builders/build.h"
#include "accel/planes/cull_planes.h"
#include "accel/traverse/reference_tracer.h"
#include "bench/common/machine_info.h"
#include "bench/common/marked_file.h"
#include "bench/common/ring_runner.h"
#include "bench/common/scenes.h"
#include "bench/fewer_tests/fewer_tests.h"
#include "core/system/atomic_file.h"
#include "core/system/executor.h"

namespace carousel::bench {

namespace {

struct FewerTestsOptions {
  bool quick = false;
  int repetitions = 7;
  std::int64_t triangles = 100'000;
  std::string json;
  std::vector<std::string> markdown;
};

/// Settings of planes for leaves; the first has none.
std::vector<TestVariant> plane_variants(const scene::Scene& scene) {
  std::vector<TestVariant> variants;
  for (const std::int64_t count : {0, 1, 2, 4, 8}) {
    CullPlanesConfig planes;
    planes.count = count;
    const auto accel = std::make_shared<const accel::Accel>(accel::build(scene, {}, *make_tbb_executor(1), {}, planes));
    variants.push_back({"cull_planes", fmt::format("{} plane{}", count, count == 1 ? "" : "s"),
                        [accel](const RaySet& rays, HitList& hits, IntersectionCounts& counts) {
                          HitBatch found;
                          for (const RayBatch& batch : rays.batches) {
                            found.clear();
                            accel::trace_depth_first_interleaved(*accel, batch, found, counts);
                            for (const RayResult& result : found) hits[result.tag.path] = result.hit;
                          }
                        }});
  }
  return variants;
}

/// Settings of the native ring on one resource, which crosses subtrees in one visit: first without bundles, then by
/// their size.
std::vector<TestVariant> bundle_variants(const scene::Scene& scene) {
  std::vector<TestVariant> variants;
  const RingSettings settings;
  BvhConfig bvh;
  bvh.treelet_triangles = settings.treelet_triangles;
  const auto accel = std::make_shared<const accel::Accel>(accel::build(scene, bvh, *make_tbb_executor(1)));
  const Vec3 extent = scene.bounds().extent();
  const float scene_size = glm::length(extent);
  for (const std::int64_t size : {0, 4, 8, 16, 32}) {
    RingForm form;
    form.statistics = true;
    form.bundles.size = size;
    variants.push_back({"bundles", size == 0 ? "no bundles" : fmt::format("of {}", size),
                        [=](const RaySet& rays, HitList& hits, IntersectionCounts& counts) {
                          const RingRun run = run_ring(*accel, scene_size, settings, form, rays, 1, hits);
                          for (const ringbus::ResourceStatistics& one : run.result.resources) counts += one.tests;
                        }});
  }
  return variants;
}

void run(const FewerTestsOptions& o) {
  FewerTestsBench bench;
  bench.machine = machine_info();
  bench.repetitions = o.quick ? 1 : o.repetitions;
  for (const char* name : {"terrain", "spheres", "sliver"}) {
    const SceneChoice choice{name, o.quick ? 5'000 : o.triangles, {}};
    const scene::Scene scene = make_scene(choice);
    const std::vector<TestVariant> methods[] = {plane_variants(scene), bundle_variants(scene)};
    for (const RaySet& rays :
         make_ray_sets(scene, accel::build(scene, {}, *make_tbb_executor(1)), o.quick ? 64 : 512, 1)) {
      if (rays.name.find("shuffled") != std::string::npos) continue;
      fmt::print(stderr, "{}, {}\n", choice.name(), rays.name);
      for (const std::vector<TestVariant>& variants : methods)
        bench.results.push_back(measure_variants(choice.name(), rays, variants, bench.repetitions));
    }
  }
  const std::string planes = fewer_tests_table(bench, "cull_planes"), bundles = fewer_tests_table(bench, "bundles");
  fmt::print("{}\n{}", planes, bundles);
  if (!o.json.empty()) write_file(o.json, to_json_text(bench));
  if (!o.markdown.empty())
    replace_marked(o.markdown, {{"planes in software", planes}, {"bundles in software", bundles}});
}

}  // namespace

}  // namespace carousel::bench

int main(int argc, char** argv) {
  carousel::bench::FewerTestsOptions o;
  CLI::App app("Software speed of methods that promise fewer tests, on the same rays", "bench_fewer_tests");
  app.add_flag("--quick", o.quick, "a smoke test: few triangles, few rays, one repetition");
  app.add_option("--repetitions", o.repetitions, "rounds of all variants; tables show the median, least and greatest")
      ->check(CLI::Range(1, 100));
  app.add_option("--triangles", o.triangles, "approximate number of triangles of each scene");
  app.add_option("--json", o.json, "file for the results");
  app.add_option("--markdown", o.markdown, "write the tables between the markers of these documents");
  CLI11_PARSE(app, argc, argv);
  try {
    carousel::bench::run(o);
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_fewer_tests: {}\n", error.what());
    return 1;
  }
}
