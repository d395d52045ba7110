#include "app/accuracy/level_trial.h"

#include <algorithm>

#include "accel/builders/build.h"
#include "accel/planes/cull_planes.h"
#include "app/accuracy/exact_answers.h"
#include "app/accuracy/unit_cost.h"
#include "app/host/cpu_time.h"
#include "app/run/ray_list_workload.h"
#include "core/config/load/validate.h"
#include "core/system/executor.h"
#include "report/text/ratio.h"
#include "ringbus/cycle/cycle_engine.h"
#include "ringbus/cycle/shapes/shape_room.h"
#include "ringbus/protocol/deadlock.h"

namespace carousel::app {

namespace {

/// The box, triangle and other test units of all resources, as the simulated machine used them.
struct UnitUse {
  std::uint64_t busy = 0;  ///< cycles of all banks
  UnitKind busiest = UnitKind::kBox;
  double busiest_fraction = 0;  ///< part of all cycles, in the mean of the resources
};
UnitUse unit_use(const ringbus::cycle::CycleResult& result) {
  PerUnit<std::uint64_t> busy;
  for (const ringbus::cycle::TileResult& tile : result.tiles)
    for (const UnitKindRow& row : kUnitKinds) busy[row.kind] += tile.units[row.kind].busy;
  UnitUse use;
  for (const auto [kind, cycles] : busy) {
    use.busy += cycles;
    if (cycles > busy[use.busiest]) use.busiest = kind;
  }
  use.busiest_fraction = report::ratio(busy[use.busiest], result.cycles * result.tiles.size());
  return use;
}

/// Empty if the cycle engine cannot run the machine.
std::optional<ringbus::RunResult> simulate(Config machine, const accel::Accel& accel, float scene_size,
                                           const RayBatch& rays) {
  machine.engine.kind = EngineKind::kCycle;
  machine.accuracy = accel.accuracy;
  if (accel::is_plain(accel)) machine.cull_planes.count = 0;
  if (!validate_config(machine, {}, {}).empty() || !ringbus::check_storage(machine, accel).empty() ||
      !ringbus::cycle::check_shape_buffer(machine, accel).empty())
    return std::nullopt;
  RayListWorkload workload(rays, static_cast<std::size_t>(shader_workers(machine)));
  return ringbus::run_cycle(machine, accel, scene_size, workload, {});
}

}  // namespace

bool planes_fit(const Config& config, const AccuracyConfig& levels) {
  if (config.cull_planes.count == 0) return false;
  Config level = config;
  level.accuracy = levels;
  return validate_config(level, {}, {.force = true}).empty();
}

const accel::Accel& LevelledAccel::at(const AccuracyConfig& levels, const AnyHit* any_hit) {
  const bool planes = planes_fit(config_, levels);
  const auto [place, missing] = built_.try_emplace({levels.transform, planes});
  if (missing) {
    const auto executor = make_sequential_executor();
    place->second = accel::build(scene_, bvh_, *executor, levels);
    if (planes) accel::add_cull_planes(place->second, scene_, config_.cull_planes, *executor);
  }
  place->second.accuracy = levels;
  if (place->second.has_non_opaque) place->second.any_hit = any_hit != nullptr ? any_hit : any_hit_;
  return place->second;
}

std::vector<report::Spread> time_levels(LevelledAccel& accel, const std::vector<AccuracyConfig>& levels,
                                        const RayBatch& rays, int repetitions, const std::function<bool()>& stopped) {
  std::vector<std::vector<double>> times(levels.size());
  for (std::size_t round = 0; round < static_cast<std::size_t>(repetitions) && !stopped(); ++round) {
    for (std::size_t i = 0; i < levels.size(); ++i) {
      const std::size_t level = (i + round) % levels.size();
      const accel::Accel& structure = accel.at(levels[level]);
      const double start = thread_cpu_seconds();
      trace(structure, rays);
      times[level].push_back(report::ratio(1e9 * (thread_cpu_seconds() - start), static_cast<double>(rays.size())));
    }
  }
  std::vector<report::Spread> out;
  for (std::vector<double>& t : times) out.push_back(report::Spread::of(std::move(t)));
  return out;
}

std::optional<report::ModelledCost> modelled_cost(const Config& machine, const Config& relaxed,
                                                  const accel::Accel& accel, float scene_size,
                                                  const std::vector<RayBatch>& pictures) {
  report::ModelledCost cost;
  report::TesterLimited limited;
  std::uint64_t rays = 0, busy = 0, cycles = 0, limited_cycles = 0;
  double busy_fraction = 0;
  IntersectionCounts tests;
  for (const RayBatch& picture : pictures) {
    const std::optional<ringbus::RunResult> configured = simulate(machine, accel, scene_size, picture);
    if (!configured) return std::nullopt;
    rays += picture.size();
    cycles += configured->cycle->cycles;
    busy += unit_use(*configured->cycle).busy;
    cost.by_seed.push_back(report::ratio(configured->cycle->cycles, picture.size()));
    for (const ringbus::ResourceStatistics& resource : configured->resources) tests += resource.tests;
    const std::optional<ringbus::RunResult> free = simulate(relaxed, accel, scene_size, picture);
    if (!free) continue;
    const UnitUse use = unit_use(*free->cycle);
    limited_cycles += free->cycle->cycles;
    limited.by_seed.push_back(report::ratio(free->cycle->cycles, picture.size()));
    limited.busiest = unit_row(use.busiest).name;
    busy_fraction += use.busiest_fraction;
  }
  cost.cycles_per_ray = report::ratio(cycles, rays);
  cost.tester_cycles_per_ray = report::ratio(busy, rays);
  cost.energy_pj_per_ray = report::ratio(test_energy_pj(tests, accel.accuracy), static_cast<double>(rays));
  cost.exact_volumes_per_ray = report::ratio(tests.exact_volumes, rays);
  cost.bundle_tests_per_ray = report::ratio(tests.bundle, rays);
  cost.plane_tests_per_ray = report::ratio(tests.plane, rays);
  if (limited.by_seed.size() == pictures.size()) {
    limited.cycles_per_ray = report::ratio(limited_cycles, rays);
    limited.busy_fraction = busy_fraction / static_cast<double>(pictures.size());
    cost.tester_limited = limited;
  }
  return cost;
}

}  // namespace carousel::app
