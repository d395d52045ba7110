#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/numeric/log2_histogram.h"
#include "core/types/workload.h"
#include "ringbus/cycle/shading/shading_pool.h"
#include "ringbus/cycle/shading/shading_settings.h"
#include "ringbus/protocol/machine.h"
#include "ringbus/results/cycle_result.h"
#include "ringbus/results/observation.h"
#include "ringbus/results/recording.h"
#include "ringbus/results/trace.h"
#include "ringbus/time/agent.h"

namespace carousel::ringbus::cycle {

/// Ray control and shading: the pools of workers, most often one, which take their camera rays from one workload. In a
/// cycle in which anything happens at a pool all pools do a step, in their order.
class ShadingAgent final : public Agent {
 public:
  /// A pool to be: of Machine::pools the one of its number, or all of the machine's workers.
  struct Pool {
    ShadingSettings settings;
    std::vector<SidePorts> clients;  ///< by resource, without channels for those of other pools
  };
  /// Keeps references to the machine and the workload.
  ShadingAgent(Machine& machine, Workload& workload, const Observation& observed, std::vector<Pool> pools);
  ShadingAgent(const ShadingAgent&) = delete;  // its pools refer to it
  ShadingAgent& operator=(const ShadingAgent&) = delete;

  /// From now on data of rays and paths is in memory. With one pool.
  void keep_in_memory(std::unique_ptr<RayData> data) { pools_.front()->keep_in_memory(std::move(data)); }
  /// Null if there is none.
  const RayData* ray_data() const { return pools_.front()->ray_data(); }

  Cycle next() const override;
  bool polled() const override { return false; }
  void notify(Cycle at) override;
  void run(Cycle end) override;
  Cycle next_after_run() const override { return next_; }
  std::string describe() const override;

  const std::vector<std::unique_ptr<ShadingPool>>& pools() const { return pools_; }
  /// No further ray comes that no other ray causes.
  bool all_begun() const { return camera_.finished; }
  bool done() const;
  /// Since the start, for the progress bar; from the agent's thread.
  std::uint64_t emitted() const;
  std::uint64_t completed() const;
  /// The last cycle in which it did anything.
  Cycle last_event() const { return now_; }
  /// Worker-cycles in which a worker could do nothing else, as ShadeWorkers has them.
  Cycle busy() const;
  /// The work of all rays that began to be shaded.
  ShadingCounts counts() const;
  /// How long rays were in slots, from being given one until their hit came to shading.
  Log2Histogram residence() const;
  const Trace& trace() const { return trace_; }
  /// The last reading of counters over time.
  void close(Cycle end);
  /// From now on the life of a ray is noted, or the time of all rays accounted for.
  void record(const Recording& recording);
  /// With one pool, as resources of several do not stop.
  const ResourceLoss& loss() const { return pools_.front()->loss(); }

 private:
  void step(Cycle now);

  Trace trace_;
  CameraRays::Source camera_;
  std::vector<std::unique_ptr<ShadingPool>> pools_;
  bool started_ = false;
  Cycle now_ = 0;
  Cycle next_ = 0;  // next(), at the end of the last run()
};

}  // namespace carousel::ringbus::cycle
