#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "bench/common/ray_sets.h"
#include "bench/common/results.h"
#include "bench/common/stopwatch.h"
#include "core/config/config.h"
#include "core/statistics/intersection_counts.h"
#include "core/types/workload.h"

namespace carousel::bench {

// Measurements of bench_fewer_tests: the same rays on one thread, with and without a method that promises fewer tests.

/// One way to trace rays.
struct TestVariant {
  std::string method;   ///< cull_planes, bundles
  std::string setting;  ///< name of the method's setting in the table
  /// Writes as many hits as there are rays.
  std::function<void(const RaySet&, HitList&, IntersectionCounts&)> trace;
};

struct VariantSpeed {
  std::string method, setting;
  IntersectionCounts tests;
  Spread nanoseconds_per_ray;  ///< CPU time
  Spread ratio;                ///< to the time of the same round's first variant
};

/// One set of rays in one scene.
struct FewerTestsResult {
  std::string scene, rays;
  std::uint64_t count = 0;
  std::vector<VariantSpeed> variants;
};

/// Traces `rays` with every variant of one method in turn, `repetitions` times; each round starts with another variant.
/// Throws std::runtime_error if a hit differs from that of the first variant in any bit.
FewerTestsResult measure_variants(const std::string& scene, const RaySet& rays,
                                  const std::vector<TestVariant>& variants, int repetitions);

struct FewerTestsBench {
  MachineInfo machine;
  int repetitions = 0;
  std::vector<FewerTestsResult> results;
};

std::string to_json_text(const FewerTestsBench& bench);
/// One table a method: a line for each scene and set of rays, a column for each setting.
std::string fewer_tests_table(const FewerTestsBench& bench, const std::string& method);

}  // namespace carousel::bench
