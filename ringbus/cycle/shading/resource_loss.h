#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "core/config/fields/faults.h"
#include "core/config/fields/topology.h"
#include "core/types/workload.h"
#include "ringbus/faults/outstanding_rays.h"
#include "ringbus/results/cycle_result.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// The state of ray control while a resource stops, and the rays that are lost with that resource.
///
/// The resource sends a last beat, which stands for the regular ones of its wires. `silence_cycles` later ray control
/// gives it up and orders all resources to discard their work. When all of them are drained, the rays that have not
/// come back are placed again.
class ResourceLoss {
 public:
  ResourceLoss(const FaultsConfig::Resource& fault, const LinkConfig& link);

  /// Rays are handed to ray control, and come back. An open ray that is added again is an error.
  void submitted(const RayBatch& rays) {
    if (ledger_) ledger_->add(rays);
  }
  void came_back(const HitBatch& rays) {
    if (ledger_) ledger_->remove(rays);
  }

  /// The last beat of a resource arrives.
  void on_last_beat(std::uint32_t resource, Cycle now);
  /// The time at which the resource is given up.
  Cycle give_up_at() const { return give_up_at_; }
  /// Gives it up: `resources` have to be drained. Throws SimulationError if the configuration recovers from nothing;
  /// `completed` rays are told in its message.
  std::uint32_t give_up(std::size_t resources, std::uint64_t completed, Cycle now);
  /// Rays get no slots before all resources are drained.
  bool draining() const { return draining_ > 0; }
  /// A resource is drained; returns true if it is the last one.
  bool drained_last() { return --draining_ == 0; }
  /// Work begins anew; returns the rays that have to be placed again.
  RayBatch restart(Cycle now);

  std::uint32_t stopped() const { return stop_->resource; }
  /// The times at which a resource stopped and work began anew; absent if no stop was noted.
  const std::optional<StopTimes>& times() const { return stop_; }
  std::uint64_t rays_restarted() const { return rays_restarted_; }
  std::uint64_t paths_restarted() const { return paths_restarted_; }

 private:
  FaultsConfig::Resource fault_;
  Cycle latency_;
  std::unique_ptr<OutstandingRays> ledger_;  // where a resource may stop
  std::optional<StopTimes> stop_;
  Cycle give_up_at_ = kNever;
  std::size_t draining_ = 0;  // resources that have not noted that they are drained
  std::uint64_t rays_restarted_ = 0, paths_restarted_ = 0;
};

}  // namespace carousel::ringbus::cycle
