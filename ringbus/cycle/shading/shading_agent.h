#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/numeric/log2_histogram.h"
#include "core/types/workload.h"
#include "ringbus/cycle/messages/side_ports.h"
#include "ringbus/cycle/shading/camera_rays.h"
#include "ringbus/cycle/shading/completed_arrivals.h"
#include "ringbus/cycle/shading/open_rays.h"
#include "ringbus/cycle/shading/ray_data.h"
#include "ringbus/cycle/shading/ray_placement.h"
#include "ringbus/cycle/shading/resource_loss.h"
#include "ringbus/cycle/shading/shade_helpers.h"
#include "ringbus/cycle/shading/shade_workers.h"
#include "ringbus/cycle/shading/shading_recorder.h"
#include "ringbus/cycle/shading/shading_samples.h"
#include "ringbus/cycle/shading/shading_settings.h"
#include "ringbus/protocol/machine.h"
#include "ringbus/results/cycle_result.h"
#include "ringbus/results/observation.h"
#include "ringbus/results/recording.h"
#include "ringbus/results/trace.h"
#include "ringbus/time/agent.h"

namespace carousel::ringbus::cycle {

/// Ray control and shading: the order in which their parts do a step. Completed rays arrive, wait for their data if
/// that is in memory, and are shaded by workers, or by resources that have nothing to test (`idle_resources_shade`).
/// The rays that they cause, and camera rays, are given slots and sent to the resources.
class ShadingAgent final : public Agent {
 public:
  /// Keeps references to the machine and the workload. `clients` by resource.
  ShadingAgent(Machine& machine, const ShadingSettings& settings, Workload& workload, const Observation& observed,
               std::vector<SidePorts> clients);
  ShadingAgent(const ShadingAgent&) = delete;  // its parts refer to each other
  ShadingAgent& operator=(const ShadingAgent&) = delete;

  /// From now on data of rays and paths is in memory.
  void keep_in_memory(std::unique_ptr<RayData> data);
  /// Null if there is none.
  const RayData* ray_data() const { return data_.get(); }

  Cycle next() const override;
  bool polled() const override { return false; }
  void notify(Cycle at) override { arrivals_.announce(at); }
  void run(Cycle end) override;
  Cycle next_after_run() const override { return next_; }
  std::string describe() const override;

  /// No further ray comes that no other ray causes.
  bool all_begun() const { return camera_.finished(); }
  bool done() const { return camera_.finished() && open_.none(); }
  /// Since the start, for the progress bar; from the agent's thread.
  std::uint64_t emitted() const { return open_.emitted(); }
  std::uint64_t completed() const { return open_.completed(); }
  /// The last cycle in which it did anything.
  Cycle last_event() const { return now_; }
  /// Worker-cycles in which a worker could do nothing else, as ShadeWorkers has them.
  Cycle busy() const { return workers_.busy(); }
  /// The work of all rays that began to be shaded.
  ShadingCounts counts() const { return workers_.counts(); }
  /// How long rays were in slots, from being given one until their hit came to shading.
  const Log2Histogram& residence() const { return placement_.slots().residence(); }
  const Trace& trace() const { return trace_; }
  /// Its counters over time (shading_samples.h), after close().
  const CounterSamples& samples() const { return samples_.counters(); }
  void close(Cycle end) { samples_.close(end, levels()); }
  /// From now on the life of a ray is noted, or the time of all rays accounted for.
  void record(const Recording& recording) { recorder_.record(recording); }
  const ResourceLoss& loss() const { return loss_; }

 private:
  Cycle next_but_completed() const;
  void step(Cycle now);
  ShadingLevels levels() const;
  void take_completed(Cycle now);
  void take_ray_data(Cycle now);
  bool finish_jobs(Cycle now);
  void shade(Cycle now);
  bool start_jobs(Cycle now);
  void place(Cycle now);
  // When a resource has stopped.
  void on_note(std::uint32_t resource, CompletedRays::Note note, Cycle now);
  void give_up(Cycle now);
  void restart(Cycle now);

  Machine& machine_;
  Workload& workload_;
  std::vector<SidePorts> clients_;
  Trace trace_;
  ShadingRecorder recorder_;
  OpenRays open_;
  CameraRays camera_;
  CompletedArrivals arrivals_;
  std::unique_ptr<RayData> data_;  // in memory
  ShadeWorkers workers_;
  ShadeHelpers helpers_;
  RayPlacement placement_;
  ResourceLoss loss_;
  ShadingSamples samples_;
  HitBatch shaded_;           // scratch
  RayData::Arrived arrived_;  // scratch
  bool started_ = false;
  Cycle now_ = 0;
  Cycle next_ = 0;  // next(), at the end of the last run()
};

}  // namespace carousel::ringbus::cycle
