#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/common/results.h"
#include "bench/common/stopwatch.h"

namespace carousel::bench {

// The results of bench_cycle.

/// Other simulators, measured once on a similar machine; they are not run here.
struct Peers {
  /// BookSim2 (github.com/booksim/booksim2), a configuration with 2 virtual channels: flit-hops per CPU-second,
  /// 16-node torus k = 16, n = 1, uniform traffic at 0.1.
  static constexpr double kBookSimFlitHops = 0.457e6;
  /// Arches, which models whole RISC-V cores, every unit every cycle: rays per second of one thread, 16 tester groups.
  static constexpr double kArchesRays = 2673;
};

/// Traffic on a network alone.
struct TrafficSpeed {
  std::string name;
  std::uint64_t resources = 0, flit_hops = 0, cycles = 0;
  Spread flit_hops_per_cpu_second;
};

/// Rays through a whole machine.
struct RaySpeed {
  std::string name;
  std::uint64_t resources = 0, threads = 1, rays = 0, cycles = 0, hops = 0;
  Spread rays_per_cpu_second, hops_per_cpu_second, rays_per_wall_second;
};

/// Requests to the memory alone.
struct MemorySpeed {
  std::string name;
  std::uint64_t requests = 0, cycles = 0;
  Spread requests_per_cpu_second;
};

struct CycleBenchResult {
  MachineInfo machine;
  int repetitions = 0;
  std::vector<TrafficSpeed> traffic;
  std::vector<RaySpeed> rays;
  std::vector<MemorySpeed> memory;
};

std::string to_json_text(const CycleBenchResult& result);
/// A readable table with the ratios to the other simulators.
std::string cycle_tables(const CycleBenchResult& result);

}  // namespace carousel::bench
