#pragma once

#include "core/statistics/cache_counts.h"
#include "core/statistics/memory_counts.h"
#include "core/statistics/ray_bytes.h"
#include "core/statistics/shape_buffer_counts.h"
#include "report/sections/memory/dram.h"
#include "report/sections/visitor.h"

namespace carousel::report {

struct Cache {
  CacheCounts counts;
  double port_utilisation = 0;
  std::optional<AheadCounts> ahead{};
};

template <class V>
void describe(V& v, const Cache& r) {
  describe(v, r.counts);
  v.field("hit_fraction", ratio(r.counts.hits, r.counts.lines), "fraction", "hits over lines");
  v.field("port_utilisation", r.port_utilisation, "fraction",
          "fraction of the run's cycles in which a bank looked up lines, in the mean");
  v.section("ahead", r.ahead, "lines that a part such as a prefetcher asked for ahead");
}

struct ShapeBuffers {
  ShapeBufferCounts counts;
};

template <class V>
void describe(V& v, const ShapeBuffers& r) {
  describe(v, r.counts);
  v.field("hit_fraction", ratio(r.counts.hits, r.counts.hits + r.counts.merged + r.counts.misses), "fraction",
          "hits over strips and transforms needed");
}

/// Leaves in compressed blocks.
struct TriangleBlocks {
  PackedLeafCounts counts;
  std::uint64_t structure_bytes = 0;
};

template <class V>
void describe(V& v, const TriangleBlocks& r) {
  describe(v, r.counts);
  v.field("bytes_per_triangle", ratio(r.counts.bytes, r.counts.triangles), "bytes", "bytes of blocks over triangles");
  v.field("structure_bytes_per_triangle", ratio(r.structure_bytes, r.counts.triangles), "bytes",
          "bytes of the whole structure, nodes included, over triangles");
  v.field("vertices_per_block", ratio(r.counts.vertices, r.counts.blocks), "vertices", "mean number of vertices");
  v.field("triangles_per_block", ratio(r.counts.triangles, r.counts.blocks), "triangles", "mean number of triangles");
}

struct Memory {
  ShapeBuffers shape_buffers;
  std::vector<Cache> caches;
  std::optional<Cache> own_caches;
  MemoryCounts counts;
  double dram_utilisation = 0;
  std::optional<RayDataBytes> ray_data;
  std::optional<CacheDrain> drain;
  std::optional<LeafStripCounts> triangle_strips;
  std::optional<TriangleBlocks> triangle_blocks;
  std::optional<Dram> dram;
};

template <class V>
void describe(V& v, const Memory& r) {
  v.section("shape_buffers", r.shape_buffers, "use of the shape buffers of all resources");
  v.section("caches", r.caches, "use of each L2 cache");
  v.section("own_caches", r.own_caches, "use of the resources' own caches, all together");
  describe(v, r.counts);
  v.field("dram_utilisation", r.dram_utilisation, "fraction", "fraction of the run's cycles in which DRAM moved lines");
  v.section("ray_data", r.ray_data, "data of rays and paths in memory");
  v.section("triangle_strips", r.triangle_strips, "leaves in strips of triangles");
  v.section("triangle_blocks", r.triangle_blocks, "leaves in compressed blocks of triangles");
  v.section("drain", r.drain, "written lines that were in caches at the end of the run");
  v.section("dram", r.dram, "DRAM with banks");
}

}  // namespace carousel::report
