#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "ringbus/cycle/testers/ray_places.h"
#include "ringbus/cycle/testers/tester.h"
#include "ringbus/cycle/tile/stages/any_hit_port.h"
#include "ringbus/cycle/tile/stages/completions.h"
#include "ringbus/cycle/tile/stages/context_phases.h"
#include "ringbus/cycle/tile/stages/dispatch_stage.h"
#include "ringbus/cycle/tile/stages/egress.h"
#include "ringbus/cycle/tile/stages/result_times.h"
#include "ringbus/cycle/tile/stages/retirement.h"
#include "ringbus/cycle/tile/stages/tile_settings.h"
#include "ringbus/cycle/tile/walk/subtree_visits.h"
#include "ringbus/cycle/tile/walk/subtree_walk.h"

namespace carousel::ringbus::cycle {

/// The parts of a resource that its stages share. All of them outlive the stages.
struct TileParts {
  Machine& machine;
  Resource& resource;
  PortLogic& logic;
  Tester& tester;
  ShapeBuffer& shapes;
  SubtreeWalk& walk;
  const PacketNeeds& needs;
  TileRecorder& recorder;
  DispatchStage& dispatch;
  Egress& egress;
  Completions& completions;
  Retirement& retirement;
  AnyHitPort& any_hit;
};

/// The packets in test at a resource, from the first cycle of their context to the last, with the fetches in between.
/// A context is the user of ShapeBuffer with its number.
class TestContexts {
 public:
  /// Keeps the references. `first_ray_user`: of ShapeBuffer, for rays in subtrees.
  TestContexts(const TileParts& parts, const TileSettings& settings, ShapeBuffer::User first_ray_user);

  const TileParts& parts() const { return parts_; }
  bool has_free() const { return phases_.in(ContextPhase::kFree) != 0; }
  std::size_t free() const { return static_cast<std::size_t>(std::popcount(phases_.in(ContextPhase::kFree))); }
  bool all_free() const { return phases_.all_free(); }
  /// The first free context; there is one.
  std::size_t first_free() const { return static_cast<std::size_t>(std::countr_zero(phases_.in(ContextPhase::kFree))); }

  /// A packet takes the free context; dispatch has read it at `at`. `has_data`: the context holds its shapes already.
  void begin(std::size_t context, PacketId id, Cycle now, Cycle at, bool has_data);

  /// Starts the tests of packets that dispatch has read.
  void start(Cycle now);
  /// Rays in subtrees go on, and those whose data has come begin their tests, then packets likewise. Returns whether
  /// packets have begun.
  bool serve(Cycle now);
  /// Ends the tests that are done, after serve(). Returns whether there were any.
  bool finish(Cycle now);
  /// Takes in the answers to any-hit calls.
  void take_any_hit(Cycle now);

  /// Tests begin, and take units, when dispatch has read the packet; otherwise that is known before.
  bool starts_later() const { return starts_later_; }
  /// The time after `now` at which dispatch has read a packet, and at which tests end; kNever: none.
  Cycle next_start_after(Cycle now) const { return phases_.first_end_after(now, phases_.in(ContextPhase::kStarting)); }
  Cycle next_end_after(Cycle now) const { return phases_.first_end_after(now, phases_.in(ContextPhase::kComputing)); }
  /// The end of the last tests under way; 0: none.
  Cycle last_end() const { return phases_.last_end(phases_.in(ContextPhase::kComputing)); }

  bool testing() const {
    using enum ContextPhase;
    return (phases_.in(kComputing) | phases_.in(kStarting)) != 0 || (phases_.in(kWalking) != 0 && visits_.testing());
  }
  bool fetching() const { return (phases_.in(ContextPhase::kWalking) | phases_.in(ContextPhase::kFetching)) != 0; }
  SubtreeVisits& visits() { return visits_; }
  const SubtreeVisits& visits() const { return visits_; }

  /// All tests come to nothing. Packets of others go on as they are.
  void discard(Cycle now);
  /// Forgets what has come for packets that are gone.
  void forget_ready();

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
    bool loaded = false;    // it holds all that rays in its treelet need
    bool has_data = false;  // it came from the issue queue with its shapes
  };

  void start_one(std::size_t context, Cycle now);
  void walk(std::size_t context, Cycle now);
  void compute(std::size_t context, Cycle at);
  void distribute(Context& context, Cycle at);
  void end(std::size_t context, Cycle now);
  void end_part(std::size_t context, Cycle now);
  void note_answered(Packet& packet, std::size_t before) const;
  ResourceId id() const { return parts_.resource.id(); }
  static ShapeBuffer::User user(std::size_t context) { return static_cast<ShapeBuffer::User>(context); }

  TileParts parts_;
  PlaceCounter places_;
  bool broadcasts_, fetch_by_resource_, starts_later_;
  bool forwards_;  // stragglers, behind a distributor
  std::vector<Context> contexts_;
  ContextPhases phases_;
  SubtreeVisits visits_;
  PacketPart part_;  // scratch
};

}  // namespace carousel::ringbus::cycle
