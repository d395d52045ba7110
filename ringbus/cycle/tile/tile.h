#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "ringbus/cycle/tile/records/tile_samples.h"
#include "ringbus/cycle/tile/resource_agent.h"
#include "ringbus/cycle/tile/resource_samples.h"
#include "ringbus/cycle/tile/stages/dispatcher.h"
#include "ringbus/cycle/tile/stages/fail_stop.h"
#include "ringbus/cycle/tile/tile_ledger.h"
#include "ringbus/packets/statistics_sink.h"

namespace carousel::ringbus::cycle {

/// A resource with a clock. Packets come in by input queues, pass a dispatch stage that looks through their IDs, are
/// tested in contexts, and leave by egress queues. Packets of its own wait in an issue queue while their shapes are
/// fetched. A packet that does not bring its shapes waits in its context for them. Each of these is a stage in stages/;
/// PortLogic and FlowRules make the decisions that do not depend on time. The tile says in which order the stages do
/// their parts of a step, when the next step is due, and which parts of a step may be done alone.
///
/// When the resource has stopped (`faults.resource`), only its ports still work: packets of others go on, a cycle each,
/// packets of its own are discarded here, and answers of memory and shading are thrown away.
class Tile final : public ResourceAgent {
 public:
  struct Ports : SidePorts {
    std::vector<InPort> in;
    std::vector<OutPort> out;
  };

  /// Keeps references to the machine and its memory.
  Tile(ResourceId id, Machine& machine, const ShapeMemory& memory, const TileSettings& settings, Ports ports);
  Tile(const Tile&) = delete;  // its stages refer to each other
  Tile& operator=(const Tile&) = delete;

  Cycle next() const override {
    return std::min({next_on_links(), next_on_side(), due_.here, due_.start, contexts_.visits().next()});
  }
  bool polled() const override { return egress_.awaits_credit(); }  // no wakeup tells of credits
  Cycle unannounced() const override { return egress_.next_after(now_); }
  void notify(Cycle at) override { due_.side = std::min(due_.side, at); }
  void run(Cycle end) override;
  Cycle next_after_run() const override { return due_.next; }
  std::string describe() const override;

  Cycle last_event() const override { return now_; }
  void close(Cycle end) override;
  TileResult result() const override;
  Work work() const override;
  ShapeBuffer& shape_buffer() override { return shapes_; }
  ResourceStatistics statistics() const override;
  CollectionStore::Statistics collections() const override { return resource_.collections().statistics(); }
  const IdCensus* census() const override { return &samples_.census(); }
  const std::vector<OutPort>& out() const override { return ports_.out; }
  std::string blocked(std::size_t port) const override { return egress_.blocked(port); }
  std::uint64_t packets_discarded() const override { return fault_.packets_discarded(); }
  const Trace& trace() const override { return recorder_.trace(); }
  const CounterSamples& samples() const override { return samples_.counters(); }

 private:
  // A step, and its parts.
  void step(Cycle now);
  bool keep_running(Cycle now);
  void begin_step(Cycle now);
  void end_step(Cycle now);
  bool finish_tests(Cycle now) {
    served_ |= contexts_.serve(now);
    return contexts_.finish(now);
  }
  bool fill_issue(Cycle now) { return issue_.fill(now, issue_.waits_for_idle() && dispatcher_.links_rest(now)); }

  // Parts of a step that may be done alone (tile_events.cpp).
  bool take_shapes(Cycle now);
  bool start_alone(Cycle now);
  void pass_ahead(Cycle limit);
  bool pass_on(Cycle now);

  // The next event.
  Cycle next_on_links() const {
    const Cycle arrival = dispatcher_.next_arrival_after(now_);
    return egress_.may_send() ? std::min(arrival, egress_.next_after(now_)) : arrival;
  }
  Cycle next_on_side() const { return std::min(shapes_.next(), next_but_shapes()); }
  Cycle next_but_shapes() const { return std::min({entry_.next_arrival(), help_.next_job(), any_hit_.next()}); }
  Cycle next_here() const;

  // The states to which its time is accounted.
  TileState classify(bool blocked) const;
  void note_state(Cycle now);
  void note_blocked(Cycle now);
  void sample(Cycle now) {
    samples_.until(now, [this](Cycle at, std::span<std::uint64_t> row) { read(at, row); });
  }
  void read(Cycle at, std::span<std::uint64_t> row);

  // When a resource has stopped, this one or another.
  void stop(Cycle now);
  void on_order(NewRays::Order order, Cycle now);
  void discard_work(Cycle now);
  bool drained() const;
  bool at_rest() const;

  Machine& machine_;
  StatisticsSink sink_;
  TransformAccount transforms_;
  SubtreeWalk walk_;
  Resource resource_;
  PortLogic logic_;
  Ports ports_;
  Tester tester_;
  ShapeBuffer shapes_;  // users: contexts, then places of the issue queue, then rays in subtrees
  PacketNeeds needs_;
  TileRecorder recorder_;

  // The stages, in the order in which they refer to those before.
  DispatchStage dispatch_;
  Egress egress_;
  CollectionRoom room_;
  TravellingRays travelling_;
  Completions completions_;
  Retirement retirement_;
  AnyHitPort any_hit_;
  ShadeHelp help_;
  TestContexts contexts_;
  IssueQueue issue_;
  RayEntry entry_;
  Dispatcher dispatcher_;
  FailStop fault_;
  TileSamples samples_;
  TileLedger ledger_;

  bool steps_always_;    // any event may matter to all parts
  bool served_ = false;  // a test has begun since the issue queue was filled
  Cycle now_ = 0;
  /// Times of events.
  struct Due {
    Cycle next = 0;             // next(), at the end of the last run()
    Cycle here = kNever;        // of tests and dispatch, as of the last step
    Cycle start = kNever;       // the beginning of tests of packets that dispatch reads
    Cycle side = kNever;        // on a channel beside the links, as far as it has been announced
    Cycle link_state = kNever;  // the resource will be in that state unless something else happens before
  } due_;
};

}  // namespace carousel::ringbus::cycle
