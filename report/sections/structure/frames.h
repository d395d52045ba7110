#pragma once

#include <string>
#include <vector>

#include "report/sections/verify.h"
#include "report/sections/visitor.h"

namespace carousel::report {

/// Use of the L2 that the builder asks.
struct FrameUpdateL2 {
  std::uint64_t lines = 0, hits = 0, written = 0, write_fetches = 0, drained = 0;
};

template <class V>
void describe(V& v, const FrameUpdateL2& r) {
  v.field("lines", r.lines, "lines", "lines that the unit asked for");
  v.field("hits", r.hits, "lines", "those of them that were there");
  v.field("written", r.written, "lines", "lines that it wrote");
  v.field("write_fetches", r.write_fetches, "lines",
          "those of which a part was written, fetched from the memory first");
  v.field("drained", r.drained, "lines",
          "those that stayed there written, and went to the memory before the first ray");
}

/// The clusters of meshes, and their part in an update.
struct FrameClusters {
  std::uint64_t count = 0, rebuilt = 0, better = 0, dealt_meshes = 0, bytes = 0;
};

template <class V>
void describe(V& v, const FrameClusters& r) {
  v.field("count", r.count, "clusters", "clusters of all meshes");
  v.field("rebuilt", r.rebuilt, "clusters", "those with a primitive that has moved, in which the tree is sought anew");
  v.field("better", r.better, "clusters", "those of them in which it has less area than a refit, and is taken");
  v.field("dealt_meshes", r.dealt_meshes, "meshes",
          "meshes of which clusters were hung anew below nodes above them, since that has less area than a refit");
  v.field("bytes", r.bytes, "bytes", "bytes that the builder keeps of clusters beside the structure");
}

/// The simulated machine spent this on bringing the structure to a frame.
struct FrameUpdateCost {
  std::uint64_t cycles = 0;
  std::uint64_t levels = 0, boxes = 0;
  std::uint64_t bytes_read = 0, bytes_written = 0, top_bytes = 0;
  std::uint64_t lines_dropped = 0;
  std::optional<FrameUpdateL2> l2{};
  std::optional<double> joules{};
};

template <class V>
void describe(V& v, const FrameUpdateCost& r) {
  v.field("cycles", r.cycles, "cycles", "time of the builder, before the first ray of the frame");
  v.field("levels", r.levels, "steps", "steps of its work of which each waits for all writes of the one before");
  v.field("boxes", r.boxes, "boxes", "boxes that it added to others, or sorted into bins");
  v.field("bytes_read", r.bytes_read, "bytes", "bytes of lines that it read from the memory, or an L2 for it");
  v.field("bytes_written", r.bytes_written, "bytes", "bytes of lines that it wrote to the memory, or an L2 for it");
  v.field(
      "top_bytes", r.top_bytes, "bytes",
      "bytes of lines that it asked for or wrote for the top level; without an L2 a part of both, and the rest is that "
      "of meshes");
  v.field("lines_dropped", r.lines_dropped, "lines",
          "lines of shared caches that it, or what it reads, made out of date");
  v.section("l2", r.l2, "use of the L2 that it asks (frames.builder.asks: l2)");
  v.field("joules", r.joules, "J",
          "energy of its bytes of the memory and of the L2 that it asks, its store and its boxes, with energy.profile");
}

/// A picture of the series.
struct Frame {
  std::uint64_t frame = 0;
  double time = 0;
  std::string update{}, why{};
  std::optional<std::uint64_t> cycles{}, raster_cycles{};
  std::uint64_t rays = 0, box_tests = 0, primitive_tests = 0;
  std::optional<std::uint64_t> memory_bytes{};
  std::optional<double> joules{};
  double surface_cost = 0;
  std::optional<double> surface_cost_rebuilt{};
  std::optional<std::uint64_t> depth_first_tests{}, depth_first_tests_rebuilt{};
  std::optional<FrameUpdateCost> builder{};
  std::optional<FrameClusters> clusters{};
  std::optional<std::uint64_t> rebuild_cycles{}, rebuild_bytes{}, cycles_rebuilt{};
  std::optional<bool> rebuild_pays{};
  Digest digest{};
};

template <class V>
void describe(V& v, const Frame& r) {
  v.field("frame", r.frame, "frame", "number of the frame");
  v.field("time", r.time, "s", "moment that it shows; scene.time with this value shows it by itself");
  v.field("update", r.update, "",

          "how the structure came to be that of the frame: built before the run, refit, rebuild, clusters, or kept");
  v.field("why", r.why, "", "why it was rebuilt although frames.update is another; empty if it was not");
  v.field("cycles", r.cycles, "cycles", "time of its rays, without the update before them (cycle)");
  v.field("raster_cycles", r.raster_cycles, "cycles", "time of the raster pass before them, with raster.time: cycles");
  v.field("rays", r.rays, "rays", "rays of the frame");
  v.field("box_tests", r.box_tests, "tests", "tests of a ray against a box");
  v.field("primitive_tests", r.primitive_tests, "tests", "tests of a ray against a primitive");
  v.field("memory_bytes", r.memory_bytes, "bytes", "bytes that its rays read from the memory and wrote to it (cycle)");
  v.field("joules", r.joules, "J", "energy of its rays, with energy.profile");
  v.field("surface_cost", r.surface_cost, "nodes",
          "nodes and blocks that a line through the scene's box meets on average, the top level with them");
  v.field("surface_cost_rebuilt", r.surface_cost_rebuilt, "nodes",
          "that of a structure that is built for the frame, where this one was not");
  v.field("depth_first_tests", r.depth_first_tests, "tests",
          "tests of boxes and primitives of the frame's rays, each traced by itself, depth first, in the refitted "
          "structure");
  v.field("depth_first_tests_rebuilt", r.depth_first_tests_rebuilt, "tests",
          "those in a structure that is built for the frame");
  v.section("builder", r.builder, "cost of the update (cycle)");
  v.section("clusters", r.clusters, "clusters of the structure, with frames.update: clusters");
  v.field("rebuild_cycles", r.rebuild_cycles, "cycles",
          "time in which the builder would have rebuilt what it refitted or renewed (cycle)");
  v.field("rebuild_bytes", r.rebuild_bytes, "bytes", "bytes that it would have read and written for that (cycle)");
  v.field("cycles_rebuilt", r.cycles_rebuilt, "cycles",
          "time of the frame's rays in a rebuilt structure, which no cache holds yet; looked at where they might spare "
          "more than the rebuild costs, if their time went down as their tests do (cycle)");
  v.field("rebuild_pays", r.rebuild_pays, "",
          "true if the refitted tree is so worn that rebuild_cycles and cycles_rebuilt are less than the refit and its "
          "rays; false without cycles_rebuilt where the tests of a rebuilt tree foretell no gain (cycle)");
  v.section("digest", r.digest, "digests of the frame");
}

/// A series of frames. All other sections are those of its last frame.
struct Frames {
  std::uint64_t count = 0;
  std::optional<std::uint64_t> cycles{}, builder_cycles{}, builder_bytes{};
  std::uint64_t rays = 0;
  std::optional<std::uint64_t> limited_by_builder{}, worn{};
  std::vector<Frame> rows{};
};

template <class V>
void describe(V& v, const Frames& r) {
  v.field("count", r.count, "frames", "frames that were shown");
  v.field("cycles", r.cycles, "cycles", "time of all of them, rays, updates and raster passes (cycle)");
  v.field("builder_cycles", r.builder_cycles, "cycles", "part of it that is the builder's (cycle)");
  v.field("builder_bytes", r.builder_bytes, "bytes", "bytes that the builder read and wrote (cycle)");
  v.field("rays", r.rays, "rays", "rays of all frames");
  v.field("limited_by_builder", r.limited_by_builder, "frames",
          "frames whose update took longer than their rays (cycle)");
  v.field("worn", r.worn, "frames", "frames with rebuild_pays (cycle)");
  v.section("rows", r.rows, "each frame");
}

}  // namespace carousel::report
