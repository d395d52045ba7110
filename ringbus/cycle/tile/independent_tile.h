#pragma once

#include <cstdint>
#include <queue>
#include <span>
#include <string>
#include <vector>

#include "ringbus/cycle/messages/side_wire.h"
#include "ringbus/cycle/tile/stages/completed_port.h"
#include "ringbus/cycle/tile/stages/shade_help.h"
#include "ringbus/cycle/tile/stages/tile_settings.h"
#include "ringbus/cycle/tile/unlinked_resource.h"
#include "ringbus/cycle/tile/walk/ray_walk.h"
#include "ringbus/cycle/tile/walk/stack_registers.h"
#include "ringbus/resource/visit/any_hit_hold.h"

namespace carousel::ringbus::cycle {

/// A resource of the conventional machine: it traces its own rays depth-first, each with a stack of its own, and has no
/// links, packets or collections.
///
/// Every ray in a slot is a thread that in turn waits for the strip it needs next (at the border of an instance also
/// for its transform), is tested against it, and gives it back. A ray that is ready takes the units at once, or behind
/// the rays that were ready before it, so that the tests of other rays hide its wait for memory. Picking rays and
/// moving stack entries costs no cycles: the baseline is given its best, and the bytes that its stacks move are
/// reported apart. With `testers.stack_entries` older entries are in memory, and a ray waits for those that it reads.
class IndependentTile final : public UnlinkedResource {
 public:
  /// Keeps references to the machine and its memory.
  IndependentTile(ResourceId id, Machine& machine, const ShapeMemory& memory, const TileSettings& settings,
                  const SidePorts& ports);

  Cycle next() const override;
  void run(Cycle end) override;
  std::string describe() const override;

  TileResult result() const override;
  Work work() const override;

 private:
  struct Thread {
    RayId ray;
    RayWalk walk;
    accel::NodeKey strip;  // fetched or in test
    HitBatch calls;        // any-hit calls to ask shading for when it has been tested
  };
  /// A ray in test. Of rays whose tests end at one time, the one that began first goes on first.
  struct Test {
    Cycle done = 0;
    std::uint64_t turn = 0;
    std::uint32_t slot = 0;
    bool operator>(const Test& o) const { return done != o.done ? done > o.done : turn > o.turn; }
  };

  void step(Cycle now);
  void take_new_rays(Cycle now);
  void keep_running(std::uint32_t slot, Cycle now);
  void test(std::uint32_t slot, Cycle now);
  void serve(Cycle now);
  void take_entries(Cycle now);
  void test_held_back(Cycle now);
  void complete(std::uint32_t slot);
  bool follows(std::uint32_t slot) const {
    return recording_.ray != nullptr && recording_.ray->ray->is(threads_[slot].ray);
  }
  /// Its ray has been in `stage` since what was accounted for last.
  void spent(std::uint32_t slot, RayStage stage, Cycle until) {
    if (times_ != nullptr) times_->spent(slot, store_.record(slot).tag, stage, until);
  }
  void note_done(Cycle now);
  void hand_over(Cycle now);
  TileState classify() const;

  // The users of the shape buffer are slots.
  SideWire question_wire_;
  SidePorts ports_;
  StackRegisters registers_;
  CompletedPort completed_port_;
  ShadeHelp help_;

  std::vector<Thread> threads_;  // by slot
  std::priority_queue<Test, std::vector<Test>, std::greater<>> tests_;
  std::vector<std::uint32_t> held_back_;  // slots of rays that are ready, but the resource shades
  std::uint64_t next_turn_ = 0;
  HitBatch completed_;
  std::vector<std::uint32_t> freed_slots_;
  struct {
    StackTraffic traffic;
    std::uint64_t held = 0;
  } stack_;
  ResourceTimes* times_;   // null: rays' time is not accounted for
  Cycle waits_since_ = 0;  // the followed ray
};

}  // namespace carousel::ringbus::cycle
