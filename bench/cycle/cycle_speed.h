#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "accel/structure/accel.h"
#include "bench/common/ray_sets.h"
#include "bench/cycle/cycle_results.h"
#include "core/config/config.h"

namespace carousel::bench {

/// A simulated network whose speed is measured.
struct TrafficCase {
  std::string name;
  Config config;
};
/// 16 resources with uniform traffic at 0.1, as BookSim2's peer number, and variations.
std::vector<TrafficCase> traffic_cases(std::int64_t packets);

TrafficSpeed measure_traffic(const TrafficCase& one, int repetitions);

/// A simulated machine whose speed is measured.
struct RayCase {
  std::string name;
  Config config;
  std::size_t threads = 1;
};
std::vector<RayCase> ray_cases();

/// Primary rays, and a bounce from each of their hits.
RaySet primary_and_bounce(const scene::Scene& scene, const accel::Accel& accel, std::uint32_t image_side);

/// Runs the machine on the rays, and compares their hits with the depth-first tracer's. Throws std::runtime_error
/// for a wrong hit.
RaySpeed measure_rays(const RayCase& one, const accel::Accel& accel, float scene_size, const RaySet& rays,
                      int repetitions);

}  // namespace carousel::bench
