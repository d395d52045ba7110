#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <vector>

#include "ringbus/cycle/fabric/packet_size.h"
#include "ringbus/cycle/messages/side_wire.h"
#include "ringbus/cycle/rays/travelling_rays.h"
#include "ringbus/cycle/shapes/multicast.h"
#include "ringbus/cycle/shapes/shape_buffer.h"
#include "ringbus/cycle/shapes/shape_memory.h"
#include "ringbus/cycle/testers/tester.h"
#include "ringbus/cycle/tile/completed_port.h"
#include "ringbus/cycle/tile/context_phases.h"
#include "ringbus/cycle/tile/rays_in_test.h"
#include "ringbus/cycle/tile/resource_agent.h"
#include "ringbus/cycle/tile/resource_samples.h"
#include "ringbus/cycle/tile/result_times.h"
#include "ringbus/cycle/tile/round_trips.h"
#include "ringbus/cycle/tile/shade_help.h"
#include "ringbus/cycle/tile/spill_memory.h"
#include "ringbus/cycle/tile/tile_ledger.h"
#include "ringbus/cycle/tile/tile_settings.h"
#include "ringbus/cycle/tile/walk/subtree_visits.h"
#include "ringbus/cycle/tile/walk/subtree_walk.h"
#include "ringbus/packets/statistics_sink.h"
#include "ringbus/protocol/answers.h"
#include "ringbus/protocol/port_logic.h"
#include "ringbus/resource/resource.h"
#include "ringbus/results/trace.h"

namespace carousel::ringbus::cycle {

/// A resource with a clock. Packets come in by input queues, pass a dispatch stage that looks through their IDs, are
/// tested in contexts, and leave by egress queues. Packets of its own wait in an issue queue while their shapes are
/// fetched. A packet that does not bring its shapes waits in its context for them. PortLogic and FlowRules make the
/// decisions that do not depend on time.
///
/// The dispatch stage takes one packet at a time, `packets.ids_per_cycle` IDs a cycle; packets of other resources go
/// first. With `visit: owners` packets without a ray here pass beside it. A packet with rays here is taken only when a
/// test context and a place in its egress queue are free, so that tests always end; a packet without rays here goes on
/// meanwhile (an idle visit).
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

  Cycle next() const override;
  bool polled() const override { return awaits_credit_; }  // no wakeup tells of credits
  Cycle unannounced() const override { return next_credit(); }
  void hear(Cycle at) override { side_arrival_ = std::min(side_arrival_, at); }
  void run(Cycle end) override;
  Cycle next_after_run() const override { return next_; }
  std::string describe() const override;

  Cycle last_event() const override { return now_; }
  void close(Cycle end) override;
  TileResult result() const override;
  Busy busy() const override;
  std::uint64_t lines_asked() const override { return shapes_.lines_asked(); }
  ResourceStatistics statistics() const override;
  CollectionStore::Statistics collections() const override { return resource_.collections().statistics(); }
  const IdCensus* census() const override { return &census_; }
  const std::vector<OutPort>& out() const override { return ports_.out; }
  std::string blocked(std::size_t port) const override;
  std::uint64_t packets_discarded() const override { return discarded_; }
  const Trace& trace() const override { return trace_; }
  const CounterSamples& samples() const override { return samples_; }

 private:
  /// A packet in test.
  struct Context {
    PacketId packet;
    IntersectionCounts counts;  // of tests that begin when the shapes are there
    std::uint32_t reads = 0;    // records read for them
    BundlePasses bundle_passes;
    RayPlaces places{};
    ResultTimes results;                // behind a distributor
    AnyHitQuestion question;            // asked when the tests are done
    std::vector<std::uint32_t> tested;  // slots of its rays, for RaysInTest
    HitBatch completed;                 // rays handed over then, with the slots they leave
    std::vector<std::uint32_t> freed_slots;
    Cycle since = 0, begun = 0;  // the packet holds it; its tests began
    bool subtree = false;
    bool has_data = false;  // it came from the issue queue with its shapes
  };
  struct Issue {
    PacketId packet;
    ShapeBuffer::User user = 0;
    bool takes_data = false;    // it waits for its shapes
    std::uint32_t spilled = 0;  // reads of spilled entries that it waits for
  };

  // With recordings (tile_record.cpp).
  void record_parts();
  void note_dispatch(Cycle begin, std::size_t ids, SliceKind kind, PacketId packet, bool has_trip);
  void note_issued(PacketId id, Cycle now);
  void note_test(const Context& context, Cycle now);
  void note_admitted(std::span<const RayId> rays);
  void note_tested(const Packet& packet, PacketId id, Cycle at, const TestOutcome& outcome);
  Hit hit_of(RayId ray) const;
  void note_retired(const Packet& packet, PacketId id);
  void note_done(Cycle now);

  std::uint64_t hops() const;
  void sample(Cycle now);
  void read(Cycle at, std::span<std::uint64_t> row);
  Cycle next_arrival() const;
  Cycle next_on_links() const;
  Cycle next_on_side() const;
  Cycle next_but_shapes() const;
  Cycle next_credit() const;
  Cycle next_egress() const;
  bool wants_credit() const;
  bool at_rest() const;
  void step(Cycle now);
  bool go_on(Cycle now);
  bool take_shapes(Cycle now);
  bool start_alone(Cycle now);
  void pass_ahead(Cycle limit);
  bool pass_on(Cycle now);
  void look_at_links();
  void note_state(Cycle now);
  void note_blocked(Cycle now);
  void serve(Cycle now);
  void start_tests(Cycle now);
  void take_new_rays(Cycle now);
  void take_opacities(Cycle now);
  bool admit();
  bool finish_tests(Cycle now);
  bool cut_through(Cycle now, bool dispatch_rests = false);
  bool handle(Cycle now);
  bool handle_arrival(std::size_t d, Cycle now);
  bool pass_through_dispatch(std::size_t d, Cycle now);

  // The choice among packets that have arrived (tile_window.cpp).
  std::size_t seen(std::size_t d, Cycle now) const;
  bool choose_to_cut(std::size_t d, Cycle now);
  bool choose_to_handle(std::size_t d, Cycle now);
  bool can_handle(std::size_t d, const Token& token);
  bool waits_for_shapes(const Token& token) const;
  bool handle_issue(Cycle now);
  bool fill_issue(Cycle now);
  bool nothing_else_to_do(Cycle now) const;
  /// The end of the tests under way, or of the dispatch of all packets in the issue queue, if that is later.
  Cycle work_ahead_ends(Cycle now) const;
  /// The time from which a collection that is not ready may go, by `collections.partial`; kNever while that waits for
  /// another event.
  Cycle partial_may_go(Cycle now) const;
  bool send(Cycle now);

  // New rays that travel (tile_rays.cpp).
  bool send_new_rays(Cycle now);
  void visit_with_rays(std::size_t d, Cycle now);
  void retire_rays(std::size_t d, Cycle now);
  Cycle take_slots(Packet& packet, Cycle now);
  void come_home(PacketId id, Cycle now);

  // When a resource has stopped (tile_stop.cpp).
  bool fault_is_due() const {
    return sink_.statistics().rays_completed >= static_cast<std::uint64_t>(fault_.after_rays);
  }
  void stop(Cycle now);
  void on_order(NewRays::Order order, Cycle now);
  void discard_work(Cycle now);
  void discard_at_owner(PacketId id);
  bool drained() const;

  Context* free_context();
  bool testers_free() const { return phases_.all_free(); }
  ShapeBuffer::User user_of(const Context& context) const {
    return static_cast<ShapeBuffer::User>(&context - contexts_.data());
  }
  void enter(const Context& context, ContextPhase phase, Cycle end = 0) { phases_.enter(user_of(context), phase, end); }
  bool is_ready(const Issue& issue) const {
    return issue.spilled == 0 && (!issue.takes_data || shapes_.is_here(issue.user));
  }
  void take_spilled();
  void write_spilled(Cycle now);
  void read_spilled(Issue& issue, Cycle now);
  void begin_test(Context& context, PacketId id, Cycle at, bool has_data);
  void start(Context& context, Cycle now);
  void compute(Context& context, Cycle at);
  void distribute(Context& context, Cycle at);
  bool fetches_ahead(const Packet& packet) const;
  ShapeNeed shape_data(const Packet& packet, bool transform) const;
  void end_test(Context& context, Cycle now);
  void end_part(Context& context, Cycle now);
  void ask(Context& context, Cycle now);
  void depart(PacketId id, Cycle ready, bool reserved);
  void count_sent(const Packet& packet, const PacketLoad& load, bool answers);
  bool take_answer(std::size_t d, Cycle now);
  void test_own_rays(Context& context, PacketId id, Cycle now);
  void retire_at_owner(PacketId id, std::size_t entries);
  void retire_part(PacketId id, Cycle now);
  void take_completed(HitBatch& rays, std::vector<std::uint32_t>& slots);
  void hand_over(Cycle now);
  std::size_t read_on_visit(const Packet& packet) const {
    return packet_size_.read_on_visit(packet, memory_, resource_.is_treelet(packet.key));
  }
  std::size_t read_at_owner(const Packet& packet) const {
    // What has met primitives goes past the collections, but for rays that have other nodes to visit.
    if (two_outputs_ && !packet.key.ref.is_inner())
      return static_cast<std::size_t>(
          std::count_if(packet.next.begin(), packet.next.end(), [](const NextNode& next) { return next.any; }));
    return packet_size_.read_at_owner(packet, memory_, resource_.is_treelet(packet.key), broadcasts_);
  }
  void note_answered(Packet& packet, std::size_t before) const;
  Cycle dispatch_cycles(std::size_t ids) const { return std::max<Cycle>(1, ceil_div(ids, ids_per_cycle_)); }
  void occupy_dispatch(Cycle now, std::size_t ids, SliceKind kind, PacketId packet, bool has_trip = true);
  void hold_dispatch(Cycle now, Cycle cycles, std::size_t ids, SliceKind kind, PacketId packet, bool has_trip);
  void sort_ids(std::size_t joined, std::size_t entries, PacketId packet);
  OutPort& out_for(const Packet& packet) { return ports_.out[logic_.out_port(packet)]; }
  bool may_inject(const Packet& packet);
  /// Notes it if there is none.
  bool has_place(const OutPort& out) {
    waits_for_place_ |= !out.has_place();
    return out.has_place();
  }
  bool dispatch_wanted() const;
  /// A packet that is at the front, or may be brought there, needs dispatch.
  bool stops_here(const InPort& in) const { return window_ > 1 || !cuts_through_ || in.front().skip == 0; }
  TileState classify(bool blocked) const;

  Machine& machine_;
  const ShapeMemory& memory_;
  const ShapeBlocks* blocks_;
  ResourceId id_;
  StatisticsSink sink_;
  Trace trace_;
  TransformAccount transforms_;
  SubtreeWalk walk_;
  Resource resource_;
  PortLogic logic_;
  Ports ports_;
  Tester tester_;
  ShapeBuffer shapes_;  // users: contexts, then places of the issue queue, then rays in subtrees
  CompletedPort completed_port_;
  TravellingRays travelling_;
  std::size_t rays_out_ = 0;  // packets of its own with new rays
  ShadeHelp help_;
  PacketSize packet_size_;
  PlaceCounter places_;
  Cycle ids_per_cycle_, sort_rate_;
  SideWire question_wire_;
  std::size_t issue_places_;
  bool visit_all_, cuts_through_, broadcasts_;
  bool two_outputs_, forwards_, fetch_by_resource_;
  Multicast multicast_;
  bool contexts_fetch_;  // packets travel, and wait in the contexts of others for shapes
  Partial partial_;
  Cycle memory_latency_;  // of a miss
  bool starts_later_;  // tests begin, and take units, when dispatch has read the packet; otherwise that is known before

  Cycle now_ = 0;
  Cycle next_ = 0;               // next(), at the end of the last run()
  Cycle next_here_ = kNever;     // next event of tests and dispatch, as of the last step
  Cycle next_start_ = kNever;    // the beginning of tests of packets that dispatch reads
  Cycle side_arrival_ = kNever;  // the next one on a channel beside the links, as far as it has been announced
  bool served_ = false;          // a test has begun since the issue queue was filled
  bool may_send_ = false;        // likewise: a packet waits to leave, or for credits
  bool awaits_credit_ = false, wants_credit_ = false;
  Cycle link_state_from_ = kNever;  // the resource will be in that state unless something else happens before
  Cycle blocked_from_ = kNever;     // a packet waits for a credit, or will then
  bool waits_for_place_ = false;    // what dispatch would take up waits for a place in an egress queue, or for a credit
  Cycle dispatch_free_ = 0;         // later than dispatch_ends_ when it pauses
  Cycle dispatch_since_ = 0, dispatch_ends_ = 0, dispatch_busy_ = 0;  // from the first to the last cycle of its work
  std::size_t next_in_ = 0;
  std::size_t window_;                    // packets at the front of an input queue among which it chooses
  bool steps_always_;                     // any event may matter to all parts
  std::vector<std::size_t> passed_over_;  // by port: how often the first one has been
  std::deque<Issue> issue_;
  Cycle next_partial_ = kNever;  // a collection that is not ready may go then
  std::size_t issued_ = 0;
  std::vector<Context> contexts_;
  PacketPart part_;  // scratch
  ContextPhases phases_;
  SubtreeVisits visits_;
  bool storage_full_ = false;
  FaultsConfig::Resource fault_;
  bool pauses_ = false;  // once, when fault_.after_rays rays are complete
  bool stops_ = false;   // likewise, for good
  bool told_drained_ = false;
  std::uint64_t discarded_ = 0;
  std::size_t questions_out_ = 0;
  RaysInTest in_test_;
  SpillMemory spill_memory_;
  std::size_t spills_out_ = 0;  // reads under way
  HitBatch done_;               // to be handed over
  std::vector<std::uint32_t> done_slots_;
  std::vector<std::uint32_t> answers_due_;  // with a bus: of each packet of its own
  RoundTrips trips_;
  PacketKindCounts sent_;
  std::uint64_t passed_ = 0, passed_rays_ = 0;  // packets without rays here, and their members
  TileLedger ledger_;
  IdCensus census_;
  Recording recording_;
  CounterSamples samples_;
  LevelSum ids_, collections_;  // over time
};

}  // namespace carousel::ringbus::cycle
