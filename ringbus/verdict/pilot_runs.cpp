#include "ringbus/verdict/pilot_runs.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/config/own_sections.h"
#include "core/system/executor.h"
#include "ringbus/cycle/cycle_engine.h"
#include "ringbus/verdict/steady_state.h"

namespace carousel::ringbus {

std::uint64_t slots_of(const Config& config) {
  return static_cast<std::uint64_t>(all_slots(config));
}

std::uint64_t pilot_paths(const Config& config, std::uint64_t paths, std::uint64_t rays, std::uint64_t wanted,
                          PilotSize least) {
  // Three times the rays that fill the machine, or twice.
  constexpr std::uint64_t kMostFills = 64, kMostRays = 80'000;
  const std::uint64_t fill = fill_rays(slots_of(config)), most = std::max(kMostRays, kMostFills * fill),
                      rays_at_least = least == PilotSize::kFull ? std::max<std::uint64_t>(1000, 3 * fill)
                                                                : std::max<std::uint64_t>(600, 2 * fill);
  const double rays_each =
      static_cast<double>(std::max(rays, paths)) / static_cast<double>(std::max<std::uint64_t>(1, paths));
  return std::min(paths, static_cast<std::uint64_t>(
                             std::ceil(static_cast<double>(std::clamp(wanted, rays_at_least, most)) / rays_each)));
}

Config with_other_seed(const Config& machine, std::uint64_t k) {
  Config out = machine;
  const auto seed = static_cast<std::uint64_t>(machine.image.seed);
  out.image.seed = static_cast<std::int64_t>((seed + k * 0x9e3779b97f4a7c15ull) >> 1);
  return out;
}

void PilotRuns::begin(const char* stage, std::size_t machines, std::uint64_t paths) {
  paths_ = paths;
  beginning_ = {1, 0};
  state_ = {stage, 0, machines, 0, run_.result.rays_completed * paths / std::max<std::uint64_t>(1, run_.paths)};
}

void PilotRuns::begin(std::size_t machines, const FrameBeginning& beginning) {
  begin(beginning.part < 1 ? "the frame's beginning" : "whole frame", machines, run_.paths);
  beginning_ = beginning;
  if (beginning.part < 1) state_.rays = beginning.rays;
}

RunResult PilotRuns::simulate(const Config& machine, std::size_t threads) {
  const std::unique_ptr<Workload> pilot = make_pilot_(machine, paths_, draw_);
  RunOptions options = options_;
  options.threads = threads;
  if (beginning_.part < 1) options.enough = std::max<std::uint64_t>(1, beginning_.rays);
  // Each first miss of the frame's run would otherwise be one of the pilot, which has fewer rays to share it.
  options.warm = {&run_.result.cycle->recent_lines, 1 - static_cast<double>(paths_) / static_cast<double>(run_.paths),
                  run_.warm, &run_.result.cycle->buffered, &run_.result.cycle->own_recent};
  std::uint64_t shown = 0;
  options.progress = [&](std::uint64_t completed) {
    const std::lock_guard lock(mutex_);
    state_.under_way += completed - shown;
    state_.completed += completed - shown;
    shown = completed;
    if (observe_) observe_(state_);
  };
  options.progress(0);
  RunResult result = run_cycle(machine, accel_, scene_size_, *pilot, options);
  const std::lock_guard lock(mutex_);
  complete_ &= result.complete || !options.stop.stop_requested();
  simulated_rays_ += result.rays_completed;
  state_.under_way -= shown;
  ++state_.done;
  return result;
}

std::vector<RunResult> PilotRuns::simulate(const std::vector<const Config*>& machines) {
  std::vector<RunResult> results(machines.size());
  if (machines.empty() || !complete_) return results;
  const std::size_t at_once = std::min(machines.size(), std::max<std::size_t>(1, options_.threads));
  std::atomic<bool> stopped{false};
  make_executor(at_once)->parallel_for(machines.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end && !stopped; ++i) {
      // Without this the others would simulate on when one has failed.
      try {
        results[i] = simulate(*machines[i], std::max<std::size_t>(1, options_.threads / at_once));
      } catch (...) {
        stopped = true;
        throw;
      }
      if (!results[i].complete && options_.stop.stop_requested()) stopped = true;
    }
  });
  for (const RunResult& result : results)
    taken_ += std::max(beginning_.part < 1 ? beginning_.part : 0,
                       static_cast<double>(result.rays_completed) / static_cast<double>(run_.result.rays_completed));
  return results;
}

}  // namespace carousel::ringbus
