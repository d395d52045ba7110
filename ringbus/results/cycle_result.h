#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/config/parts.h"
#include "core/numeric/latency_histogram.h"
#include "core/numeric/log2_histogram.h"
#include "core/statistics/byte_row.h"
#include "core/statistics/cache_counts.h"
#include "core/statistics/collection_counts.h"
#include "core/statistics/distributor_counts.h"
#include "core/statistics/memory_counts.h"
#include "core/statistics/packet_kind_counts.h"
#include "core/statistics/ray_bytes.h"
#include "core/statistics/shading_counts.h"
#include "core/statistics/shape_buffer_counts.h"
#include "core/statistics/warp_counts.h"
#include "core/types/unit_kind.h"
#include "ringbus/results/class_use.h"
#include "ringbus/results/dram_use.h"
#include "ringbus/results/ray_times.h"
#include "ringbus/results/stop_ring_use.h"
#include "ringbus/results/trace.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// The state of a resource in one cycle; the times in all states add up to the run.
enum class TileState : std::uint8_t {
  kIdle,     ///< nothing to test: no rays, or collections that wait to fill
  kTesting,  ///< a packet is in test
  kMemory,   ///< shape data is on its way
  kLink,     ///< a packet cannot leave
  kCredits,  ///< collections are ready, but all packets are out
  kStorage,  ///< too little collection storage to go on
  kShading,  ///< it helps the shader workers
};
inline constexpr std::size_t kTileStates = 7;

/// A link or a dispatch stage over the whole run.
struct Utilisation {
  Cycle busy = 0;     ///< cycles in which it worked
  Cycle stalled = 0;  ///< it had work and could not do it
  friend bool operator==(const Utilisation&, const Utilisation&) = default;
};

/// A bank of equal units of one resource: the cycles in which a test was started or the units' interval kept one from
/// starting, and how many of them passed in each state of the resource. A bank may be busy after its last answer.
struct BankUse {
  Cycle busy = 0;
  std::array<Cycle, kTileStates> busy_in{};  ///< by TileState; they add up to `busy`
  std::uint64_t passes = 0, lanes = 0;       ///< tests, and the lanes of the vectors in which they were started
  double fill = 0;                           ///< part of its units that had a test, over its busy cycles
  friend bool operator==(const BankUse&, const BankUse&) = default;
};

/// Cycles of a resource in which a packet is in test. In the rest of them no test is under way: dispatch reads the
/// packet's IDs, or it passes without a test.
struct TestingCycles {
  Cycle any = 0;      ///< some bank or port of the ray store is busy
  Cycle latency = 0;  ///< none is, but answers are awaited
  friend bool operator==(const TestingCycles&, const TestingCycles&) = default;
};

struct TileResult {
  std::array<Cycle, kTileStates> states{};  ///< by TileState
  TestingCycles testing;                    ///< of those in TileState::kTesting
  PerUnit<BankUse> units;
  BankUse ray_reads;               ///< the port of the ray store; with `rays.banks` that of its banks to the box units
  BankUse primitive_ray_reads;     ///< with `rays.banks` that to the units for primitives
  std::uint64_t second_reads = 0;  ///< records that both ports have read for one test
  Cycle bank_conflicts =
      0;  ///< cycles of the ports, beyond those that the reads would take if they were even over the banks
  std::optional<WarpCounts> warps;               ///< only with `testers.simt`
  std::uint64_t warp_lanes = 0;                  ///< likewise; of a warp
  std::vector<LaneUse> bounces;                  ///< likewise; by bounce
  std::optional<DistributorCounts> distributor;  ///< only in a central machine with a distributor
  Utilisation dispatch;
  PacketKindCounts sent;
  ShapeBufferCounts shapes;
  std::vector<StripReads> strip_reads;  ///< by row of accel::StructureDepths
  StackTraffic stack;
  SpillBytes spilled;
  TransformedRayBytes transformed_rays;  ///< kept beside the records
  LatencyHistogram round_trips;          ///< times of its packets from the issue queue until they retire
  Log2Histogram collection_ages;         ///< ages of collections when packets were taken from them
  Cycle packet_cycles = 0;               ///< packets of its own in flight, summed over the cycles
  friend bool operator==(const TileResult&, const TileResult&) = default;
};

/// Occupancy of the queue at the far end of a link.
struct Occupancy {
  Cycle packet_cycles = 0;  ///< packets times the cycles they waited
  std::uint64_t most = 0;   ///< packets at once
  friend bool operator==(const Occupancy&, const Occupancy&) = default;
};

struct LinkUse {
  std::uint32_t from = 0, to = 0;
  Utilisation use;
  Occupancy queue;
  std::uint64_t bytes = 0;  ///< bytes of the packets; 0 for synthetic traffic
  std::int64_t mhz = 0;     ///< of the link's clock; 0: that of the resources
  friend bool operator==(const LinkUse&, const LinkUse&) = default;
};

/// A resource stopped for good: the cycle in which it stopped, in which ray control excluded it, and in which all
/// packets had been drained and rays were restarted (0 when none was unfinished).
struct StopTimes {
  std::uint32_t resource = 0;
  Cycle stopped = 0, noticed = 0, restarted = 0;
  friend bool operator==(const StopTimes&, const StopTimes&) = default;
};

/// The ray IDs in the collections of all resources together, looked at in one of every `interval` cycles.
struct IdsAtOnce {
  std::uint64_t most = 0;
  Cycle interval = 0;
  friend bool operator==(const IdsAtOnce&, const IdsAtOnce&) = default;
};

/// A pool of shader workers.
struct PoolUse {
  std::uint64_t shaded = 0;  ///< rays
  Cycle busy = 0;            ///< worker-cycles, as ShadingCounts has them
  friend bool operator==(const PoolUse&, const PoolUse&) = default;
};

struct CycleResult {
  /// From cycle 0 to the last in which a resource, ray control or shading did anything.
  Cycle cycles = 0;
  std::vector<ClassUse> uses;               ///< one for each class of parts, over the whole run
  std::vector<ProgressSample> progress;     ///< in the order of time, at about equal numbers of rays
  std::optional<ProgressSample> all_begun;  ///< when no ray was left that no other ray causes
  std::vector<TileResult> tiles;            ///< by resource
  std::vector<LinkUse> links;
  std::optional<StopRingUse> stops{};  ///< of a ring whose stops have no queues
  std::vector<ByteRow> bytes;
  std::vector<CacheCounts> caches;
  std::vector<AheadCounts> fetched_ahead;  ///< by cache, if a part asks for lines ahead
  PartCounts<Parts> parts;
  std::optional<CacheCounts> own_caches;  ///< sum over resources, if they have caches of their own
  CacheLines cached_lines;                ///< by cache: its lines at the end
  CacheLines recent_lines, own_recent;    ///< after those that they replaced; own_recent: by resource with an own cache
  BufferShapes buffered;                  ///< by resource, at the end
  MemoryCounts memory;                    ///< of all memories
  std::uint64_t first_reads = 0;          ///< lines read from memory that had not been read before
  std::size_t memories = 1;
  std::optional<RayDataBytes> ray_data;  ///< if any is in memory
  CacheDrain drain;
  std::optional<LeafStripCounts> strips;   ///< with `bvh.leaves: strips`
  std::optional<PackedLeafCounts> blocks;  ///< with `bvh.leaves: blocks`
  std::uint64_t structure_bytes = 0;       ///< of the whole structure in the machine's memory
  std::optional<DramUse> dram;             ///< use of DRAM with banks
  ShadingCounts shading;
  std::vector<PoolUse> pools;  ///< its parts, in the order of the drawing
  std::uint64_t hops = 0;
  Log2Histogram residence;                           ///< times of rays from their slot until shading has their hit
  std::optional<std::vector<RayTimeRow>> ray_times;  ///< with RunOptions::ray_times, of a complete run
  std::optional<IdsAtOnce> ids;                      ///< where there are collections
  std::optional<StopTimes> stop;                     ///< if one was excluded before the last ray was shaded
  EpochDigests epochs;
  std::vector<Step> steps;  ///< steps that RunOptions::trace asks for
  friend bool operator==(const CycleResult&, const CycleResult&) = default;
};

}  // namespace carousel::ringbus::cycle
