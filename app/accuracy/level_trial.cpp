#include "app/accuracy/level_trial.h"

#include <algorithm>
#include <ctime>

#include "accel/build/build.h"
#include "app/accuracy/exact_answers.h"
#include "app/run/ray_list_workload.h"
#include "core/config/validate.h"
#include "core/system/executor.h"
#include "report/text/ratio.h"
#include "ringbus/cycle/cycle_engine.h"
#include "ringbus/protocol/deadlock.h"

namespace carousel::app {

namespace {

/// CPU time of this thread: wall time, without the time that other programs took.
double thread_nanoseconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e9 * static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec);
}

}  // namespace

const accel::Accel& LevelledAccel::at(const AccuracyConfig& levels) {
  const auto [place, missing] = built_.try_emplace(levels.transform);
  if (missing) place->second = accel::build(scene_, bvh_, *make_sequential_executor(), levels);
  place->second.accuracy = levels;
  return place->second;
}

std::vector<report::Spread> time_levels(LevelledAccel& accel, const std::vector<AccuracyConfig>& levels,
                                        const RayBatch& rays, int repetitions, const std::function<bool()>& stopped) {
  std::vector<std::vector<double>> times(levels.size());
  for (std::size_t round = 0; round < static_cast<std::size_t>(repetitions) && !stopped(); ++round) {
    for (std::size_t i = 0; i < levels.size(); ++i) {
      const std::size_t level = (i + round) % levels.size();
      const accel::Accel& structure = accel.at(levels[level]);
      const double start = thread_nanoseconds();
      trace(structure, rays);
      times[level].push_back(report::ratio(thread_nanoseconds() - start, static_cast<double>(rays.size())));
    }
  }
  std::vector<report::Spread> out;
  for (std::vector<double>& t : times) {
    std::sort(t.begin(), t.end());
    out.push_back(t.empty() ? report::Spread{} : report::Spread{t[t.size() / 2], t.front(), t.back()});
  }
  return out;
}

std::optional<report::ModelledCost> modelled_cost(const Config& config, const accel::Accel& accel, float scene_size,
                                                  const RayBatch& rays) {
  Config machine = config;
  machine.engine.kind = EngineKind::kCycle;
  machine.accuracy = accel.accuracy;
  if (!validate_config(machine, {}, {}).empty() || !ringbus::check_storage(machine, accel).empty()) return std::nullopt;
  RayListWorkload workload(rays, static_cast<std::size_t>(shader_workers(machine)));
  const ringbus::RunResult result = ringbus::run_cycle(machine, accel, scene_size, workload, {});
  std::uint64_t busy = 0;
  for (const ringbus::cycle::TileResult& tile : result.cycle->tiles)
    for (const UnitKind kind : {UnitKind::kBox, UnitKind::kTriangle, UnitKind::kTransform})
      busy += tile.units[kind].busy;
  return report::ModelledCost{report::ratio(result.cycle->cycles, rays.size()), report::ratio(busy, rays.size())};
}

}  // namespace carousel::app
