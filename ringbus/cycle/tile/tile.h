#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "ringbus/cycle/fabric/packet_size.h"
#include "ringbus/cycle/machine/cycle_machine.h"
#include "ringbus/cycle/memory/shape_port.h"
#include "ringbus/cycle/testers/tester.h"
#include "ringbus/cycle/tile/completed_port.h"
#include "ringbus/cycle/tile/resource_agent.h"
#include "ringbus/cycle/tile/round_trips.h"
#include "ringbus/cycle/tile/shade_help.h"
#include "ringbus/cycle/tile/subtree_walk.h"
#include "ringbus/cycle/time/state_clock.h"
#include "ringbus/packets/statistics_sink.h"
#include "ringbus/resource/resource.h"
#include "ringbus/results/trace.h"

namespace carousel::ringbus::cycle {

/// Fetches that a packet in a subtree has under way at most: a ray each, and no more than this.
inline constexpr std::size_t kSubtreeFetches = 32;
/// Set in the tag of a fetch that is for a test context; the others are for the issue queue.
inline constexpr std::uint32_t kContextTag = 1u << 31;

/// A resource with a clock: input queues, a handler that looks through a packet's IDs, testers, hands to leave
/// by, and a queue of its own packets whose shapes are being fetched.
///
/// One packet at a time is looked through, `packets.ids_per_cycle` IDs a cycle; those of other resources go first.
/// With `visit: owners` packets without a ray here pass beside the handler. A packet with rays here needs a free
/// test context and a place in hand before it is taken, so that tests always end; a packet without rays takes its
/// way meanwhile (fills the bubble).
///
/// Of a resource that has stopped (`faults.resource`) only the ports are left: what comes in goes out by its way, a
/// cycle each, packets of its own come to their end here, and memory and shading may answer to nobody.
class Tile final : public ResourceAgent {
 public:
  struct Ports : SidePorts {
    std::vector<InPort> in;
    std::vector<OutPort> out;
  };

  Tile(ResourceId id, CycleMachine& machine, float scene_size, bool statistics, TraceWindow window, Ports ports);

  Cycle next() const override;
  bool polled() const override { return may_send_; }  // credits come back unannounced
  void run(Cycle end) override;
  std::string describe() const override;

  void close(Cycle end) override { clock_.enter(TileState::kIdle, end); }
  TileResult result() const override;
  ResourceStatistics statistics() const override;
  CollectionStore::Statistics collections() const override { return resource_.collections().statistics(); }
  const std::vector<OutPort>& out() const override { return ports_.out; }
  std::string blocked(std::size_t exit) const override;
  std::uint64_t packets_discarded() const override { return discarded_; }
  const Trace& trace() const override { return trace_; }

 private:
  /// A packet in test.
  struct Context {
    enum class Phase : std::uint8_t { kFree, kFetching, kComputing } phase = Phase::kFree;
    PacketId packet;
    Cycle done = 0;             // kComputing: then; kFetching a subtree: of its tests
    IntersectionCounts counts;  // of tests that begin when the shapes are there
    std::uint32_t reads = 0;    // records for them
    std::uint32_t bundle_passes = 0;
    AnyHitQuestion question;  // asked when the tests are done
    HitBatch completed;       // handed over then, with the slots they leave
    std::vector<std::uint32_t> freed_slots;
    bool subtree = false;
    std::uint32_t outstanding = 0;  // fetches under way
    std::vector<ShapeSpan> strips;  // a subtree's, yet to be fetched, last first
  };
  struct Issue {
    PacketId packet;
    std::uint32_t tag = 0;
    std::uint32_t outstanding = 0;  // fetches under way

    bool ready() const { return outstanding == 0; }
  };

  std::uint64_t hops() const;
  Cycle next_arrival() const;
  Cycle next_beside_ring() const;
  Cycle next_egress() const;
  bool wants_credit() const;
  bool at_rest() const;
  void step(Cycle now);
  void take_answers(Cycle now);
  void take_new_rays(Cycle now);
  void take_opacities(Cycle now);
  bool admit();
  bool finish_tests(Cycle now);
  /// `at_once`: only what finds its link free; the others are taken in hand.
  bool cut_through(Cycle now, bool at_once);
  bool handle(Cycle now);
  bool handle_arrival(std::size_t d, Cycle now);
  bool handle_issue(Cycle now);
  bool fill_issue(Cycle now);
  bool send(Cycle now);

  // When a resource has stopped (tile_stop.cpp).
  bool only_forwards() const { return stopped_ || drains_; }
  void stop(Cycle now);
  void on_order(NewRays::Order order, Cycle now);
  void discard_work(Cycle now);
  void discard_home(PacketId id);
  bool drained() const;

  Context* free_context();
  bool testers_free() const;
  void begin_test(Context& context, PacketId id, Cycle at);
  std::array<ShapeSpan, 2> shape_data(accel::NodeKey key, bool transform) const;
  bool lacks(const ShapeSpan& span);
  void begin_fetch(Context& context, const ShapeSpan& strip, Cycle now);
  void end_test(Context& context, Cycle now);
  void ask(Context& context, Cycle now);
  void depart(PacketId id, Cycle ready, bool reserved);
  void retire_at_owner(PacketId id);
  void take_completed(HitBatch& rays, std::vector<std::uint32_t>& slots);
  void hand_over(Cycle now);
  void occupy_dispatch(Cycle now, std::size_t ids);
  void fetch(const ShapeSpan& strip, std::uint32_t tag, Cycle now);
  std::size_t out_port_of(const Packet& packet) const;
  std::optional<PacketId> free_packet();
  bool may_inject(const Packet& packet) const;
  bool dispatch_wanted() const;
  TileState classify(Cycle now) const;

  CycleMachine& machine_;
  ResourceId id_;
  StatisticsSink sink_;
  Trace trace_;
  TransformAccount transforms_;
  SubtreeWalk walk_;
  Resource resource_;
  Ports ports_;
  Tester tester_;
  ShapePort shapes_;
  CompletedPort completed_port_;
  ShadeHelp help_;
  PacketSize packet_size_;
  Cycle link_bytes_, ids_per_cycle_;
  std::size_t issue_places_;
  bool stays_, visit_all_, cuts_through_, fetch_by_resource_, bubble_;

  Cycle now_ = 0;
  Cycle next_here_ = kNever;  // of tests and handler, as of the last step
  bool may_send_ = false;     // likewise: something is in hand, or waits for credits
  Cycle dispatch_free_ = 0, dispatch_busy_ = 0;
  std::size_t next_in_ = 0, next_direction_ = 0;
  std::vector<std::vector<PacketId>> free_;  // own packets at home, by direction
  std::deque<Issue> issue_;
  std::uint32_t next_tag_ = 0;
  std::vector<Context> contexts_;
  std::deque<NewRays> waiting_;
  bool storage_full_ = false;
  bool pauses_ = false;  // once, when so many rays are complete
  std::uint64_t pause_after_ = 0;
  bool stops_ = false;    // when so many rays are complete
  bool stopped_ = false;  // for good
  bool drains_ = false;   // another has, or it: until everything that was under way is gone
  bool told_drained_ = false;
  std::uint64_t discarded_ = 0;
  std::size_t fetches_out_ = 0, questions_out_ = 0;
  HitBatch done_;  // to be handed over
  std::vector<std::uint32_t> done_slots_;
  RoundTrips trips_;
  std::uint64_t passed_ = 0, passed_rays_ = 0;  // packets without rays here, and their members
  StateClock<TileState, kTileStates> clock_;
};

}  // namespace carousel::ringbus::cycle
