#pragma once

#include <cstdint>

#include "report/sections/visitor.h"

namespace carousel::report {

/// Data of rays and paths that is in memory (memory.ray_records, path_state, film).
struct RayData {
  std::uint64_t records_read = 0, records_written = 0, states_read = 0, states_written = 0, film_read = 0,
                film_written = 0;
};

template <class V>
void describe(V& v, const RayData& r) {
  v.field("records_read", r.records_read, "bytes", "master copies of rays read before the rays were loaded");
  v.field("records_written", r.records_written, "bytes",
          "master copies of rays written, when they were given slots and when they were complete");
  v.field("states_read", r.states_read, "bytes", "states of paths read before their rays were shaded");
  v.field("states_written", r.states_written, "bytes", "states of paths written with new rays");
  v.field("film_read", r.film_read, "bytes", "pixels read to add the light of a path");
  v.field("film_written", r.film_written, "bytes", "pixels written");
}

/// Leaves in strips of triangles (bvh.leaves: strips).
struct TriangleStrips {
  std::uint64_t triangles = 0, strips = 0, vertices = 0, bytes = 0, bytes_saved = 0;
};

template <class V>
void describe(V& v, const TriangleStrips& r) {
  v.field("triangles", r.triangles, "triangles", "triangles of leaves");
  v.field("strips", r.strips, "strips", "strips that they form");
  v.field("vertices", r.vertices, "vertices", "vertices that the strips hold");
  v.field("bytes", r.bytes, "bytes", "bytes of all leaves");
  v.field("bytes_saved", r.bytes_saved, "bytes", "bytes more with 40 for each primitive");
}

/// Written lines that were still in caches at the end of the run (memory.l2_write: back).
struct CacheDrain {
  std::uint64_t lines = 0, bytes = 0, cycles = 0;
};

template <class V>
void describe(V& v, const CacheDrain& r) {
  v.field("lines", r.lines, "lines", "lines written to DRAM when the run was over");
  v.field("bytes", r.bytes, "bytes", "bytes of these");
  v.field("cycles", r.cycles, "cycles", "cycles from the end of the run to the last of them; not in engine.cycles");
}

}  // namespace carousel::report
