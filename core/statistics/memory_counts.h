#pragma once

#include "core/statistics/counters.h"

namespace carousel {

/// Use of the memory behind the caches. A line is a sector where the caches have sectors.
struct MemoryCounts {
  std::uint64_t lines = 0, bytes = 0, lines_written = 0, busy = 0;

  static constexpr auto counters() {
    using C = MemoryCounts;
    return std::array{
        Counter{"dram_lines", &C::lines, "lines", "lines, or sectors, read from DRAM"},
        Counter{"dram_bytes", &C::bytes, "bytes", "bytes read from DRAM"},
        Counter{"dram_lines_written", &C::lines_written, "lines",
                "lines written to DRAM: spilled collection entries, and data of rays and paths"},
        Counter{"dram_busy_cycles", &C::busy, "cycles", "cycles in which DRAM moved lines"},
    };
  }
  friend bool operator==(const MemoryCounts&, const MemoryCounts&) = default;
};

/// Lines that were written in caches with `memory.l2_write: back` and were still there at the end of the run. They are
/// written to memory then.
struct CacheDrain {
  std::uint64_t lines = 0, bytes = 0, cycles = 0;

  static constexpr auto counters() {
    using C = CacheDrain;
    return std::array{
        Counter{"lines", &C::lines, "lines", "lines written to DRAM when the run was over"},
        Counter{"bytes", &C::bytes, "bytes", "bytes of these"},
        Counter{"cycles", &C::cycles, "cycles",
                "cycles from the end of the run to the last of them; not in engine.cycles"},
    };
  }
  friend bool operator==(const CacheDrain&, const CacheDrain&) = default;
};

/// The leaves of a structure as strips of triangles (`bvh.leaves: strips`).
struct LeafStripCounts {
  std::uint64_t triangles = 0, strips = 0, vertices = 0;
  std::uint64_t bytes = 0;           ///< bytes of the leaves
  std::uint64_t separate_bytes = 0;  ///< that they would have with three vertices a triangle

  static constexpr auto counters() {
    using C = LeafStripCounts;
    return std::array{
        Counter{"triangles", &C::triangles, "triangles", "triangles of leaves"},
        Counter{"strips", &C::strips, "strips", "strips that they form"},
        Counter{"vertices", &C::vertices, "vertices", "vertices that the strips hold"},
        Counter{"bytes", &C::bytes, "bytes", "bytes of all leaves"},
        Counter{"bytes_saved", &C::bytes_saved, "bytes", "bytes more with 40 for each primitive"},
        Counter{"separate_bytes", &C::separate_bytes, "bytes", "bytes with 40 for each primitive", Shown::kNever},
    };
  }
  constexpr std::uint64_t bytes_saved() const { return separate_bytes - bytes; }
  friend bool operator==(const LeafStripCounts&, const LeafStripCounts&) = default;
};

/// The leaves of a structure in compressed blocks (`bvh.leaves: blocks`).
struct PackedLeafCounts {
  std::uint64_t leaves = 0, triangles = 0, blocks = 0, raw_blocks = 0, vertices = 0, bytes = 0;

  static constexpr auto counters() {
    using C = PackedLeafCounts;
    return std::array{
        Counter{"leaves", &C::leaves, "leaves", "leaves of triangles"},
        Counter{"triangles", &C::triangles, "triangles", "triangles of these leaves"},
        Counter{"blocks", &C::blocks, "blocks", "blocks of 128 bytes that hold them"},
        Counter{"raw_blocks", &C::raw_blocks, "blocks",
                "those of the blocks that hold up to three triangles as floats, since these are on no common grid"},
        Counter{"vertices", &C::vertices, "vertices", "vertices of all blocks"},
        Counter{"bytes", &C::bytes, "bytes", "bytes of all blocks"},
    };
  }
  friend bool operator==(const PackedLeafCounts&, const PackedLeafCounts&) = default;
};

}  // namespace carousel
