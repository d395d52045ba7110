#include "ringbus/verdict/pilot_runs.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <deque>
#include <utility>

#include "core/config/own_sections.h"
#include "core/system/executor.h"
#include "ringbus/verdict/progress_blocks.h"
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
  constexpr double kOften = 1.5;
  paths_ = paths;
  drains_ = paths >= run_.paths || static_cast<double>(paths) >= kOften * static_cast<double>(slots_);
  rays_ = paths < run_.paths ? run_.result.rays_completed * paths / run_.paths : kAllRays;
  state_ = {stage, 0, machines, 0, run_.result.rays_completed * paths / std::max<std::uint64_t>(1, run_.paths)};
}

void PilotRuns::begin_frame(std::uint64_t rays) {
  begin("frame", 1, run_.paths);
  state_.rays = rays;
}

void PilotRuns::prepare(Simulation& simulation, const Config& machine, std::size_t threads) {
  simulation.workload = make_pilot_(machine, paths_, drains_ ? 0 : slots_, draw_);
  RunOptions& options = simulation.options = options_;
  options.threads = threads;
  // Each first miss of the frame's run would otherwise be one of the pilot, which has fewer rays to share it.
  options.warm = {&run_.result.cycle->recent_lines, 1 - static_cast<double>(paths_) / static_cast<double>(run_.paths),
                  run_.warm, &run_.result.cycle->buffered, &run_.result.cycle->own_recent};
  options.progress = [this, &simulation](std::uint64_t completed) {
    const std::lock_guard lock(mutex_);
    state_.under_way += completed - simulation.shown;
    state_.completed += completed - simulation.shown;
    simulation.shown = completed;
    if (observe_) observe_(state_);
  };
  options.progress(0);
  simulation.run = begin_cycle(machine, accel_, scene_size_, *simulation.workload, options);
}

RunResult PilotRuns::simulate(const Config& machine, std::size_t threads) {
  Simulation simulation;
  prepare(simulation, machine, threads);
  const bool ended = simulation.run->run_until(drains_ ? kAllRays : rays_);
  RunResult result = simulation.run->result();
  const std::lock_guard lock(mutex_);
  complete_ &= ended || !options_.stop.stop_requested();
  simulated_rays_ += result.rays_completed;
  state_.under_way -= simulation.shown;
  ++state_.done;
  return result;
}

cycle::CycleResult PilotRuns::go_on(const Config& machine, const FrameBeginning& beginning) {
  Simulation& simulation = of_frame_[&machine];
  if (simulation.run == nullptr) prepare(simulation, machine, std::max<std::size_t>(1, options_.threads));
  const std::uint64_t before = simulation.shown;
  const bool ended =
      simulation.run->run_until(beginning.part < 1 ? std::max<std::uint64_t>(1, beginning.rays) : kAllRays);
  complete_ &= ended || !options_.stop.stop_requested();
  cycle::CycleResult out;
  out.progress = simulation.run->progress();
  std::uint64_t completed = out.progress.empty() ? 0 : out.progress.back().completed;
  if (ended) {
    RunResult all = simulation.run->result();
    completed = all.rays_completed;
    out = std::move(*all.cycle);
    simulation.run.reset();
    simulation.workload.reset();
  }
  const double taken =
      std::max(beginning.part, static_cast<double>(completed) / static_cast<double>(run_.result.rays_completed));
  simulation.options.progress(completed);
  taken_ += taken - std::exchange(simulation.taken, taken);
  simulated_rays_ += completed - before;
  state_.under_way = 0;
  ++state_.done;
  return out;
}

std::vector<RunResult> PilotRuns::simulate_to_the_end(const std::vector<const Config*>& machines) {
  const bool drained = std::exchange(drains_, true);
  std::vector<RunResult> results = simulate(machines);
  drains_ = drained;
  return results;
}

double PilotRuns::cycles(const cycle::CycleResult& pilot) const {
  return drains_ ? static_cast<double>(pilot.cycles) : at_count(pilot, rays_, cycle_of);
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
    taken_ += static_cast<double>(result.rays_completed) / static_cast<double>(run_.result.rays_completed);
  return results;
}

std::vector<double> cycles_of_seeds(PilotRuns& pilots, const Config& machine, std::uint64_t seeds,
                                    const BasePilot& first, std::uint64_t paths) {
  const bool again = paths != first.paths;
  pilots.begin("other seeds", seeds + (again ? 1 : 0), paths);
  pilots.take(first.draw);
  std::deque<Config> others;
  std::vector<const Config*> machines;
  if (again) machines.push_back(&machine);
  for (std::uint64_t k = 1; k <= seeds; ++k) machines.push_back(&others.emplace_back(with_other_seed(machine, k)));
  std::vector<double> cycles;
  if (!again) cycles.push_back(first.cycles);
  for (const RunResult& result : pilots.simulate(machines))
    if (pilots.complete()) cycles.push_back(pilots.cycles(*result.cycle));
  return cycles;
}

}  // namespace carousel::ringbus
