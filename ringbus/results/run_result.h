#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "core/statistics/link_fault_counts.h"
#include "core/statistics/queue_use.h"
#include "core/statistics/rank_counts.h"
#include "core/statistics/rank_memory.h"
#include "core/types/ids.h"
#include "ringbus/packets/statistics_sink.h"
#include "ringbus/resource/collections/collection_store.h"
#include "ringbus/results/cycle_result.h"
#include "ringbus/results/energy_events.h"
#include "ringbus/results/link_statistics.h"
#include "ringbus/results/memory_request.h"
#include "ringbus/results/nearest_result.h"
#include "ringbus/results/occupancy_series.h"
#include "ringbus/results/ray_log.h"
#include "ringbus/results/ray_times.h"
#include "ringbus/results/slice_log.h"
#include "ringbus/results/time_series.h"
#include "ringbus/transport/transport.h"

namespace carousel::ringbus {

/// The part of a rank in a run, and its messages to each other rank.
struct RankResult {
  std::uint32_t first_resource = 0, resources = 0;  ///< its arc
  std::uint64_t rays_completed = 0;                 ///< and shaded by it
  std::size_t threads = 1;
  double waiting = 0;  ///< share of its threads' time in which they had nothing to do
  RankMemory memory{};
  std::vector<RankCounts> to;  ///< by rank; its own is empty
};

struct RunOptions {
  std::size_t threads = 1;
  bool statistics = true;                        ///< false: nothing is counted at the resources
  bool link_statistics = true;                   ///< native: counts at the links too
  std::stop_token stop;                          ///< ends the run early; it is then incomplete
  std::chrono::milliseconds stuck_after{10000};  ///< native: a SimulationError after no progress for so long
  std::size_t samples = 0;                       ///< most samples of the time series; 0: there is none
  TimelineOptions timeline{};                    ///< slices of time that are recorded
  FollowedRay* ray = nullptr;                    ///< its life is recorded, in place of the timeline
  Transport* transport = nullptr;                ///< native: to the other ranks of the run
  std::uint64_t scene_bytes = 0;                 ///< bytes of the scene that this rank has, for its report
  EnergyMeter* meter = nullptr;                  ///< cycle: reads what costs energy
  MemoryLog* memory = nullptr;                   ///< cycle: requests to the memory are appended
  cycle::TraceWindow trace{};                    ///< cycle: the steps of these cycles are kept
  cycle::WarmCaches warm{};                      ///< cycle: lines that the caches hold from the start
  bool ray_times = false;                        ///< cycle: where all rays' cycles go
  std::span<PixelCost> heat{};                   ///< cycle, with ray_times: one a pixel, to be added to; may be empty
  /// Called a few times a second from the calling thread with the rays completed so far; may be empty.
  std::function<void(std::uint64_t completed)> progress;
};

struct LinkResult {
  ResourceId from, to;
  std::size_t depth = 0;
  LinkStatistics statistics;
  OccupancySeries series{};  ///< native
  LinkFaultCounts faults{};
};

struct RunResult {
  bool complete = true;  ///< false: stopped early
  std::uint64_t rays_emitted = 0, rays_completed = 0;
  std::uint64_t rays_restarted = 0;     ///< restarted because a resource stopped
  std::uint64_t paths_restarted = 0;    ///< the (pixel, sample)s of these rays
  std::uint64_t packets_discarded = 0;  ///< in flight when the resource was excluded
  double recovery_seconds = 0;          ///< native: from the resource's last sign of life until the restart
  double wall_seconds = 0;
  std::size_t threads = 1;                        ///< threads used
  std::chrono::steady_clock::time_point start{};  ///< native: the origin of the links' series
  std::uint64_t slots_used = 0;                   ///< times a slot was assigned
  std::uint64_t slot_waits = 0;                   ///< times new rays had to wait for free slots
  QueueUse completed{};                           ///< native: the queue of completed rays
  QueueUse groups{};                              ///< native: the queues of new rays to all resources
  std::vector<ResourceStatistics> resources;      ///< empty without statistics
  std::vector<CollectionStore::Statistics> collections;
  std::vector<LinkResult> links;
  std::optional<NearestResult> nearest{};   ///< if rays look for several hits
  std::vector<RankResult> ranks;            ///< empty if there is one
  std::optional<TimeSeries> series;         ///< with RunOptions::samples
  std::optional<Timeline> timeline;         ///< with RunOptions::timeline; with RunOptions::ray of its packets
  std::vector<RayFact> facts;               ///< with RunOptions::ray, by time
  std::optional<cycle::CycleResult> cycle;  ///< results of the cycle engine
};

}  // namespace carousel::ringbus
