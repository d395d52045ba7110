#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <vector>

#include "ringbus/cycle/tile/stages/any_hit_port.h"
#include "ringbus/cycle/tile/stages/tile_settings.h"
#include "ringbus/cycle/tile/unlinked_resource.h"
#include "ringbus/cycle/tile/walk/ray_walk.h"
#include "ringbus/cycle/tile/walk/stack_registers.h"
#include "ringbus/cycle/tile/warps/ended_rays.h"
#include "ringbus/cycle/tile/warps/lane_tests.h"
#include "ringbus/cycle/tile/warps/treelet_prefetcher.h"
#include "ringbus/cycle/tile/warps/warp_forming.h"
#include "ringbus/cycle/tile/warps/warp_log.h"
#include "ringbus/resource/visit/any_hit_hold.h"

namespace carousel::ringbus::cycle {

/// A resource of the conventional machine as GPUs have it (`testers.simt`): it traces its rays depth-first in warps,
/// and has no links, packets or collections.
///
/// A warp takes a step at a time. Each of its rays names the strip that it needs next, the lines of all of them are
/// read once each, and a ray is tested when its own have come, in units that all lanes share. When the slowest ray has
/// been tested the next step begins (or with `step: lane` each ray takes its next one by itself). A ray that has ended
/// keeps its lane and its slot until the slowest of its warp has ended (T. Aila and S. Laine, Understanding the
/// efficiency of ray traversal on GPUs, HPG 2009). With `compaction: repack` a ray leaves its warp after a step, and
/// those that go on at nodes, and those that go on at leaves, are packed into warps again (W. Fung et al., Dynamic warp
/// formation, MICRO 2007). With `idle_lanes: help` lanes without a ray take further nodes from the stacks of the others
/// (CoopRT, ISCA 2025); here a helper brings its result back to the ray's own stack after each step.
class WarpTile final : public UnlinkedResource {
 public:
  /// Keeps references to the machine and its memory.
  WarpTile(ResourceId id, Machine& machine, const ShapeMemory& memory, const TileSettings& settings,
           const SidePorts& ports);

  Cycle next() const override;
  void run(Cycle end) override;
  std::string describe() const override;

  TileResult result() const override;
  Work work() const override;

 private:
  static constexpr std::uint32_t kNone = ~0u;
  struct Ray {
    RayId id;
    RayWalk walk;
    accel::NodeKey strip;  // its next, where rays are packed
    std::uint32_t warp = kNone, lane = 0;
    std::uint32_t in_test = 0;  // strips of this step that have not been tested
    HitBatch calls{};           // any-hit calls of this step
    Cycle waits_since = 0;
    bool done = false;  // it only keeps its lane
  };
  /// A ray that a warp began with. It may have left, and another may have its slot.
  struct Lane {
    std::uint32_t bounce = 0;
    Cycle ended = 0;
  };
  struct Warp {
    std::vector<std::uint32_t> slots;
    std::vector<Lane> lanes;
    std::uint32_t open = 0;  // rays for which the step waits
    Cycle begin = 0;
  };
  enum class Turn : std::uint8_t { kStrip, kReads, kEnds };
  struct Start {
    Cycle at = 0;
    std::uint32_t warp = 0;
  };

  void step(Cycle now);
  TileState classify() const;
  void take_new_rays(Cycle now);
  void take_answers(Cycle now);
  void take_entries(Cycle now);
  void prefetch(Cycle now);
  // Warps, from their forming to their end.
  bool form_warps(Cycle now);
  bool begin_warps(Cycle now);
  bool move_on(Cycle now);
  void go_on(std::uint32_t warp, std::span<const std::uint32_t> slots, Cycle now);
  void pack_again(std::uint32_t warp, std::span<const std::uint32_t> slots, Cycle now);
  void end_warp(std::uint32_t warp, Cycle now);
  std::uint64_t idle_lanes(const Warp& warp) const;
  // A ray's turns.
  Turn turn(std::uint32_t slot, Cycle now);
  void ask(std::uint32_t slot, accel::NodeKey strip, bool needs_transform);
  void help(std::span<const std::uint32_t> slots, std::uint64_t idle, std::uint64_t& nodes, std::uint64_t& leaves);
  IntersectionCounts test(std::uint32_t slot, accel::NodeKey strip, Cycle now);
  void tested(std::uint32_t slot, accel::NodeKey strip, Cycle now);
  void lane_ends_step(std::uint32_t slot);
  void complete(std::uint32_t slot);
  void hand_over(Cycle now);
  bool follows(std::uint32_t slot) const {
    return recording_.ray != nullptr && recording_.ray->ray->is(rays_[slot].id);
  }

  // The users of the shape buffer are reads of lines.
  SimtConfig simt_;
  Channel<NewRays>& new_rays_;
  LaneTests tests_;
  StackRegisters registers_;
  AnyHitPort any_hit_;
  EndedRays ended_;
  WarpForming forming_;
  TreeletPrefetcher prefetcher_;
  WarpLog log_;

  std::vector<Ray> rays_;  // by slot
  std::vector<Warp> warps_;
  std::vector<std::uint32_t> free_warps_;
  std::deque<Start> starts_;           // warps that have been formed
  std::vector<std::uint32_t> movers_;  // slots of rays that go on at once
};

}  // namespace carousel::ringbus::cycle
