#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/config/parts.h"
#include "core/statistics/byte_row.h"
#include "core/statistics/intersection_counts.h"
#include "core/statistics/shading_counts.h"

namespace carousel::ringbus {

/// The counts so far of everything that costs energy in a simulated machine. A part counts an event when it decides on
/// it: a packet's tests when the first of them begins, a message when it is sent.
struct EnergyEvents {
  struct OfResource {
    IntersectionCounts tests;
    std::uint64_t record_reads = 0;  ///< records of rays and bundles read for tests, by either port of the store
    std::uint64_t packet_rays = 0;   ///< members of packets that it issued
    std::uint64_t shape_reads = 0;   ///< spans of shape data that were needed
    std::uint64_t stack_bytes = 0;   ///< written to and read from stacks of rays
    std::uint64_t buffer_bytes = 0;  ///< moved at sorted buffers of nearest hits, and set aside and taken back there
    std::uint64_t color_terms = 0;   ///< of NearestCounts
    std::uint64_t prefetch_votes = 0;
    bool warps = false;  ///< the stacks are registers
  };
  std::vector<OfResource> resources;
  std::vector<std::uint64_t> link_bytes;                                    ///< by link of the report
  std::vector<std::uint64_t> row_bytes;                                     ///< by row of the byte ledger
  std::uint64_t l2_lines = 0, asked_ahead = 0, l1_lines = 0, l2_pages = 0;  ///< pages looked up or put into TLBs
  PartCounts<Parts> parts;
  std::uint64_t shaded = 0, products = 0, lookups = 0;
  ShadeProgramCounts programs;  ///< of shader workers, as the next one
  ShadeDataCounts shade_data;
  std::uint64_t activations = 0;  ///< of rows of DRAM with banks
};

/// Reads the energy of a simulated machine in the course of a run. The engine calls from one thread at a time.
class EnergyMeter {
 public:
  virtual ~EnergyMeter() = default;
  /// Before the run: the rows of the machine's byte ledger, without counts, and the most samples of its time series.
  virtual void begin(const std::vector<ByteRow>& rows, std::size_t most_samples) = 0;
  /// The cycle for which it waits, which is later than that of the last call of read().
  virtual std::uint64_t next() const = 0;
  /// All events before the cycle next(), and no others.
  virtual void read(const EnergyEvents& events) = 0;
  /// All events of a run of so many cycles, those that nobody waited for included.
  virtual void close(std::uint64_t cycles, const EnergyEvents& events) = 0;
};

}  // namespace carousel::ringbus
