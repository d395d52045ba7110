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

/// A class of the machine's parts, and how a machine looks that has twice as much of it (or half the latency).
struct WhatIf {
  std::string name;    ///< as in the report: box_tests, link_bandwidth, ...
  std::string action;  ///< what was doubled or halved, with the key
  std::function<void(Config&)> apply;
};
/// Those that can make a difference to the configured machine with such a scene.
std::vector<WhatIf> what_ifs(const Config& config, const accel::Accel& accel);

/// What lifting one class does to the throughput.
struct Gain {
  std::string name, action;
  double rays_per_kilocycle = 0;
  double gain = 0;  ///< over the machine as it is, as a fraction of its throughput
};

/// What limits a machine, found by simulating it with each class lifted in turn.
struct Bottleneck {
  double rays_per_kilocycle = 0;  ///< of the machine as it is, over the same rays
  double noise = 0;               ///< by how much two halves of its steady state differ, as a fraction
  std::uint64_t paths = 0;        ///< first rays simulated each time
  std::vector<Gain> gains;        ///< greatest first
};

/// Makes the workload of one simulation. Called for each; must give the same rays each time.
using WorkloadFactory = std::function<std::unique_ptr<Workload>(const Config&)>;

/// Simulates the machine and each lifted one on the first `paths` rays of the workload, on the cycle engine.
/// Rates are of the steady state, without fill and drain. Throws as run_cycle.
Bottleneck find_bottleneck(const Config& config, const accel::Accel& accel, float scene_size,
                           const WorkloadFactory& make_workload, std::uint64_t paths, const RunOptions& options);

/// Enough paths to tell: the slots turn over so often that even twice of them reach their steady state, and caches are
/// warm. A path is some two or three rays.
std::uint64_t pilot_paths(const Config& config);

/// Rays per kilocycle between fill and drain; of the whole run when that was too short to tell.
double steady_rate(const cycle::CycleResult& result, std::uint64_t rays);

}  // namespace carousel::ringbus
