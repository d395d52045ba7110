#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "accel/structure/accel.h"
#include "core/config/config.h"
#include "core/types/workload.h"
#include "ringbus/results/run_result.h"

namespace carousel::ringbus {

/// A class of the machine's parts, relaxed: with twice as many of them, or half their latency.
struct WhatIf {
  std::string name;    ///< as in the report: box_tests, link_bandwidth, ...
  std::string action;  ///< the key that was doubled or halved
  std::function<void(Config&)> apply;
};
/// The what-ifs of the classes that the configured machine with such a scene has: a row for each kind of test unit
/// (core/types/unit_kind.h), then the table of other parts.
std::vector<WhatIf> what_ifs(const Config& config, const accel::Accel& accel);

/// The effect of one what-if on the throughput.
struct Gain {
  std::string name, action;
  double rays_per_kilocycle = 0;
  double gain = 0;  ///< over the machine as configured, as a fraction of its throughput
};

/// The bottleneck of a machine, found by simulating it with each class relaxed in turn.
struct Bottleneck {
  double rays_per_kilocycle = 0;  ///< of the machine as configured, over the same rays
  double noise = 0;               ///< difference between the two halves of its steady state, as a fraction
  std::uint64_t paths = 0;        ///< first rays simulated each time
  std::vector<Gain> gains;        ///< greatest first
};

/// Makes the workload of one simulation, with the same rays each time.
using WorkloadFactory = std::function<std::unique_ptr<Workload>(const Config&)>;

/// Simulates the machine and each relaxed one on the first `paths` rays of the workload, on the cycle engine.
/// Rates are of the steady state, without fill and drain. Throws as run_cycle.
Bottleneck find_bottleneck(const Config& config, const accel::Accel& accel, float scene_size,
                           const WorkloadFactory& make_workload, std::uint64_t paths, const RunOptions& options);

/// Enough paths for a verdict: even twice the slots reach their steady state, and caches are warm. A path is some two
/// or three rays.
std::uint64_t pilot_paths(const Config& config);

/// Rays per kilocycle between fill and drain, or of the whole run when that was too short.
double steady_rate(const cycle::CycleResult& result, std::uint64_t rays);

}  // namespace carousel::ringbus
