#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/types/workload.h"
#include "ringbus/cycle/testers/tester.h"
#include "ringbus/cycle/tile/walk/walk_time.h"
#include "ringbus/protocol/machine.h"
#include "ringbus/resource/resource.h"
#include "ringbus/results/ray_times.h"
#include "ringbus/results/recording.h"
#include "ringbus/results/trace.h"

namespace carousel::ringbus::cycle {

/// Writes down what happens at one resource: its steps always (two runs are compared by them), and slices of the
/// timeline and the life of the followed ray where they are asked for. A recorder changes nothing else.
class TileRecorder {
 public:
  /// Keeps a reference to the machine.
  TileRecorder(ResourceId id, Machine& machine, const Recording& recording, TraceWindow steps)
      : machine_(machine),
        id_(id),
        recording_(recording),
        times_(recording.times != nullptr ? &recording.times->of(id) : nullptr),
        trace_(id.value, steps) {}

  const Trace& trace() const { return trace_; }
  /// Rays' time is accounted for.
  bool has_times() const { return times_ != nullptr; }
  void step(Cycle now, StepKind kind, std::uint32_t packet, std::size_t rays) { trace_.note(now, kind, packet, rays); }

  /// The units get tracks behind those of the dispatch stage and of `contexts`.
  void record_units(Tester& tester, std::size_t contexts) const {
    if (has_slices() && !has_ray())
      tester.record(*recording_.slices, recording_.track + 1 + static_cast<std::uint32_t>(contexts));
  }

  void dispatched(Cycle begin, Cycle end, std::size_t ids, SliceKind kind, PacketId packet, bool has_trip) {
    if (times_ != nullptr && has_trip && kind != SliceKind::kRetire && !hears(packet))
      history(packet).dispatched(begin, end);
    if (has_slices()) [[unlikely]]
      note_dispatch(begin, end, ids, kind, packet, has_trip);
  }
  void issued(PacketId id, Cycle now) {
    if (times_ != nullptr) history(id).begin(now);
    if (has_slices()) [[unlikely]]
      note_issued(id, now);
  }
  /// A packet in the issue queue has had its shapes since `at`.
  void shapes_came(PacketId id, Cycle at) {
    if (times_ != nullptr) history(id).until(at, RayStage::kShapes);
  }
  /// Members of packet `id` that live here have been tested. `walks`: what each did by itself, in their order; empty if
  /// they were tested together.
  void tested_rays(PacketId id, std::span<const PacketMember> members, Cycle since, Cycle begun, Cycle now,
                   std::span<const WalkTime> walks = {}) {
    if (times_ != nullptr) note_tested_rays(id, members, since, begun, now, walks);
  }
  /// `since`, `begun`: the packet took the context, and its tests began.
  void in_context(PacketId id, std::size_t context, Cycle since, Cycle begun, Cycle end) {
    if (has_slices()) [[unlikely]]
      note_context(id, context, since, begun, end);
  }
  void admitted(std::span<const RayId> rays, Cycle now) {
    if (has_ray()) [[unlikely]]
      note_admitted(rays, now);
  }
  /// A visit has tested rays of `packet`, which is a copy of packet `id` where others hear it at the same time.
  void tested(const Packet& packet, PacketId id, Cycle at, const TestOutcome& outcome, const Resource& resource) {
    if (has_ray()) [[unlikely]]
      note_tested(packet, id, at, outcome, resource);
  }
  /// `part`: other members of the packet are under way.
  void retired(const Packet& packet, PacketId id, Cycle now, bool part = false) {
    if (times_ != nullptr && !part) history(id).close();
    if (has_ray()) [[unlikely]]
      note_retired(packet, id, now);
  }
  void completed(const HitBatch& rays, std::span<const std::uint32_t> slots, Cycle now) {
    if (times_ != nullptr)
      for (std::size_t i = 0; i < rays.size(); ++i) times_->done(slots[i], rays[i].tag, now);
    if (has_ray()) [[unlikely]]
      note_completed(rays, now);
  }

 private:
  PacketHistory& history(PacketId id) const { return recording_.times->histories()[id.value]; }
  /// Others hear the packet of another resource at the same time.
  bool hears(PacketId id) const { return machine_.topology.broadcasts() && machine_.packet(id).owner != id_; }
  void note_tested_rays(PacketId id, std::span<const PacketMember> members, Cycle since, Cycle begun, Cycle now,
                        std::span<const WalkTime> walks);
  bool has_slices() const { return recording_.slices != nullptr; }
  bool has_ray() const { return recording_.ray != nullptr; }
  [[gnu::cold]] void note_dispatch(Cycle begin, Cycle end, std::size_t ids, SliceKind kind, PacketId packet,
                                   bool has_trip);
  [[gnu::cold]] void note_issued(PacketId id, Cycle now);
  [[gnu::cold]] void note_context(PacketId id, std::size_t context, Cycle since, Cycle begun, Cycle end);
  [[gnu::cold]] void note_admitted(std::span<const RayId> rays, Cycle now);
  [[gnu::cold]] void note_tested(const Packet& packet, PacketId id, Cycle at, const TestOutcome& outcome,
                                 const Resource& resource);
  [[gnu::cold]] void note_retired(const Packet& packet, PacketId id, Cycle now);
  [[gnu::cold]] void note_completed(const HitBatch& rays, Cycle now);
  Hit hit_of(RayId ray) const;

  Machine& machine_;
  ResourceId id_;
  Recording recording_;
  ResourceTimes* times_;  // null: rays' time is not accounted for
  Trace trace_;
};

}  // namespace carousel::ringbus::cycle
