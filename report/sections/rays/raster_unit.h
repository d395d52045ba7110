#pragma once

#include <cstdint>
#include <optional>

#include "report/sections/structure/frames.h"
#include "report/sections/visitor.h"

namespace carousel::report {

/// The simulated machine spent this on rasterising first hits, before the first ray of the frame.
struct RasterUnit {
  std::uint64_t cycles = 0, busy = 0;
  std::uint64_t list_bytes = 0, sample_bytes = 0;
  std::uint64_t bytes_read = 0, bytes_written = 0;
  FrameUpdateL2 l2{};
  std::optional<double> joules{};
  bool limits = false;
};

template <class V>
void describe(V& v, const RasterUnit& r) {
  v.field("cycles", r.cycles, "cycles", "time of the pass, which engine.cycles lacks");
  v.field("busy_cycles", r.busy, "cycles", "part of it in which triangles were set up, sorted or tested");
  v.field("list_bytes", r.list_bytes, "bytes", "lists of the tiles' triangles, 8 bytes each, written and read");
  v.field("sample_bytes", r.sample_bytes, "bytes", "samples that were written, 20 bytes each");
  v.field("bytes_read", r.bytes_read, "bytes", "bytes of lines that the L2 read from the memory for it");
  v.field("bytes_written", r.bytes_written, "bytes", "bytes of lines that it wrote to the memory");
  v.section("l2", r.l2, "use of the L2 that the unit asks");
  v.field(
      "joules", r.joules, "J",
      "energy of its bytes of the memory and of the L2, its store, a triangle test each time that a triangle is set "
      "up, a box test for each test of a sample, and of any-hit units, with energy.profile");
  v.field("limits", r.limits, "",
          "true if the pass took longer than the rays of the frame, of a sample than their estimate");
}

}  // namespace carousel::report
