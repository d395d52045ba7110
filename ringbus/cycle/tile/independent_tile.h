#pragma once

#include <cstdint>
#include <queue>
#include <span>
#include <string>
#include <vector>

#include "ringbus/cycle/messages/side_wire.h"
#include "ringbus/cycle/shapes/shape_buffer.h"
#include "ringbus/cycle/testers/tester.h"
#include "ringbus/cycle/tile/resource_agent.h"
#include "ringbus/cycle/tile/resource_samples.h"
#include "ringbus/cycle/tile/stages/completed_port.h"
#include "ringbus/cycle/tile/stages/shade_help.h"
#include "ringbus/cycle/tile/stages/tile_settings.h"
#include "ringbus/cycle/tile/tile_ledger.h"
#include "ringbus/cycle/tile/walk/ray_walk.h"
#include "ringbus/protocol/machine.h"
#include "ringbus/resource/visit/any_hit_hold.h"

namespace carousel::ringbus::cycle {

/// A resource of the conventional machine: it traces its own rays depth-first, each with a stack of its own, and has no
/// links, packets or collections.
///
/// Every ray in a slot is a thread that in turn waits for the strip it needs next (at the border of an instance also
/// for its transform), is tested against it, and gives it back. A ray that is ready takes the units at once, or behind
/// the rays that were ready before it, so that the tests of other rays hide its wait for memory. Picking rays and
/// moving stack entries costs no cycles: the baseline is given its best, and the bytes that its stacks move are
/// reported apart.
class IndependentTile final : public ResourceAgent {
 public:
  /// Keeps references to the machine and its memory.
  IndependentTile(ResourceId id, Machine& machine, const ShapeMemory& memory, const TileSettings& settings,
                  const SidePorts& ports);

  Cycle next() const override;
  bool polled() const override { return false; }
  void run(Cycle end) override;
  std::string describe() const override;

  Cycle last_event() const override { return now_; }
  void close(Cycle end) override;
  TileResult result() const override;
  Work work() const override;
  std::uint64_t lines_asked() const override { return shapes_.lines_asked(); }
  ResourceStatistics statistics() const override;
  CollectionStore::Statistics collections() const override { return {}; }
  const std::vector<OutPort>& out() const override { return no_links_; }
  std::string blocked(std::size_t) const override { return ""; }
  const Trace& trace() const override { return trace_; }
  const CounterSamples& samples() const override { return samples_; }

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
  void test_held_back(Cycle now);
  void complete(std::uint32_t slot);
  bool follows(std::uint32_t slot) const {
    return recording_.ray != nullptr && recording_.ray->ray->is(threads_[slot].ray);
  }
  /// Its ray has been in `stage` since what was accounted for last.
  void spent(std::uint32_t slot, RayStage stage, Cycle until) {
    if (times_ != nullptr) times_->spent(slot, store_.record(slot).tag, stage, until);
  }
  void note(RayFact::Kind kind, Cycle at, Cycle end, accel::NodeKey key = {});
  void note_done(Cycle now);
  void hand_over(Cycle now);
  TileState classify() const;
  void read(Cycle at, std::span<std::uint64_t> row);
  void record(const Event& event) {
    if (statistics_) sink_.record(event);
  }

  const accel::Accel& accel_;
  const ShapeMemory& memory_;
  ResourceId id_;
  RayStore& store_;
  bool statistics_;
  SideWire question_wire_;
  StatisticsSink sink_;
  Trace trace_;
  SidePorts ports_;
  Tester tester_;
  ShapeBuffer shapes_;  // users: slots
  CompletedPort completed_port_;
  ShadeHelp help_;

  TransformAccount transforms_;
  std::vector<Thread> threads_;  // by slot
  std::priority_queue<Test, std::vector<Test>, std::greater<>> tests_;
  std::vector<std::uint32_t> held_back_;  // slots of rays that are ready, but the resource shades
  std::uint64_t next_turn_ = 0;
  std::size_t active_ = 0;  // rays in slots
  HitBatch completed_;
  std::vector<std::uint32_t> freed_slots_;
  std::uint64_t stack_held_ = 0;
  StackTraffic stack_;
  Cycle now_ = 0;
  TileLedger ledger_;
  CounterSamples samples_;
  Recording recording_;
  ResourceTimes* times_;   // null: rays' time is not accounted for
  Cycle waits_since_ = 0;  // the followed ray
  std::vector<OutPort> no_links_;
};

}  // namespace carousel::ringbus::cycle
