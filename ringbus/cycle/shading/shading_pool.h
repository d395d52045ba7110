#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

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
#include "ringbus/results/recording.h"
#include "ringbus/results/trace.h"

namespace carousel::ringbus::cycle {

/// A pool of shader workers with the ray control of its resources: the parts of a step. Completed rays arrive, wait for
/// their data if that is in memory, and are shaded by workers, or by resources that have nothing to test
/// (`idle_resources_shade`). The rays that they cause, and camera rays, are given slots and sent to the resources.
class ShadingPool {
 public:
  /// What all pools have in common.
  struct Shared {
    Machine& machine;
    Workload& workload;
    CameraRays::Source& camera;
    Trace& trace;
  };
  /// `control` gives out the slots of its resources. `clients` by resource, without channels for those of other pools.
  /// `samples`: most readings of its counters. Keeps references to all of it.
  ShadingPool(const Shared& shared, RayControl& control, const ShadingSettings& settings, std::size_t samples,
              std::vector<SidePorts> clients);
  ShadingPool(const ShadingPool&) = delete;  // its parts refer to each other
  ShadingPool& operator=(const ShadingPool&) = delete;

  void keep_in_memory(std::unique_ptr<RayData> data);
  const RayData* ray_data() const { return data_.get(); }
  void record(const Recording& recording) { recorder_.record(recording); }

  /// The next event, as far as it has been announced, or of all that has been sent. When `done`, all pools are.
  Cycle next(bool done) const { return std::min(next_but_completed(done), done ? kNever : arrivals_.next()); }
  Cycle next_of_all(bool done) const {
    return std::min(next_but_completed(done), done ? kNever : arrivals_.next_of_all());
  }
  void announce(Cycle at) { arrivals_.announce(at); }
  void open_window(Cycle end) { arrivals_.open_window(end); }
  /// A step begins: takes what has arrived.
  void arrive(Cycle now);
  /// Ends jobs and starts others until nothing more can be done in this cycle. Returns false if nothing could.
  bool work(Cycle now);
  /// Gives slots to new rays.
  void place(Cycle now);

  /// No ray is open.
  bool none() const { return open_.none(); }
  std::uint64_t emitted() const { return open_.emitted(); }
  std::uint64_t completed() const { return open_.completed(); }
  Cycle busy() const { return workers_.busy(); }
  ShadingCounts counts() const { return workers_.counts(); }
  const Log2Histogram& residence() const { return placement_.slots().residence(); }
  const CounterSamples& samples() const { return samples_.counters(); }
  void close(Cycle end) { samples_.close(end, levels()); }
  const ResourceLoss& loss() const { return loss_; }
  std::string describe() const;

 private:
  Cycle next_but_completed(bool done) const;
  ShadingLevels levels() const;
  void take_completed(Cycle now);
  void take_ray_data(Cycle now);
  bool finish_jobs(Cycle now);
  void shade(Cycle now);
  bool start_jobs(Cycle now);
  // When a resource has stopped.
  void on_note(std::uint32_t resource, CompletedRays::Note note, Cycle now);
  void give_up(Cycle now);
  void restart(Cycle now);

  RayControl& control_;
  Workload& workload_;
  Trace& trace_;
  std::vector<SidePorts> clients_;
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
};

}  // namespace carousel::ringbus::cycle
