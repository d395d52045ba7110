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

// What bench_fewer_tests measures: the same rays on one thread, with a method that promises fewer tests and without.

/// One way to trace rays.
struct TestVariant {
  std::string method;   ///< cull_planes, bundles
  std::string setting;  ///< of the method, as a table names it
  /// Writes as many hits as there are rays.
  std::function<void(const RaySet&, HitList&, IntersectionCounts&)> trace;
};

struct VariantSpeed {
  std::string method, setting;
  IntersectionCounts tests;
  Spread nanoseconds_per_ray;  ///< CPU time
  Spread ratio;                ///< of the time of the same round's first variant
};

/// One set of rays in one scene.
struct FewerTestsResult {
  std::string scene, rays;
  std::uint64_t count = 0;
  std::vector<VariantSpeed> variants;
};

/// Traces `rays` with every variant, all of one method, in turn, `repetitions` times, each round begun with another
/// one. Throws std::runtime_error when a hit is not that of the first variant, to the bit.
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
