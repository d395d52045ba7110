#include "ringbus/cycle/tile/stages/test_contexts.h"

#include <algorithm>

#include "ringbus/protocol/answers.h"

namespace carousel::ringbus::cycle {

TestContexts::TestContexts(const TileParts& parts, const TileSettings& settings, ShapeBuffer::User first_ray_user)
    : parts_(parts),
      places_(settings.cells, settings.banks),
      broadcasts_(parts.machine.topology.broadcasts()),
      fetch_by_resource_(settings.fetches_by_resource()),
      starts_later_(fetch_by_resource_ || settings.resource.collections.traversal == Traversal::kTreelet ||
                    settings.resource.treelets),
      forwards_(settings.testers.distributor.stragglers == TestersConfig::Distributor::Stragglers::kForward),
      contexts_(static_cast<std::size_t>(settings.testers.contexts)),
      phases_(contexts_.size()),
      visits_(parts.needs.memory(), parts.shapes, parts.tester, contexts_.size(), first_ray_user,
              parts.recorder.has_times()) {}

void TestContexts::begin(std::size_t place, PacketId id, Cycle now, Cycle at, bool has_data) {
  Context& context = contexts_[place];
  Packet& packet = parts_.machine.packet(id);
  const bool answers = broadcasts_ && packet.owner != this->id();
  Packet& tested = answers ? begin_answer(parts_.machine, this->id(), id) : packet;
  const std::size_t members = tested.members.size();
  const TestOutcome outcome = parts_.resource.test(tested);
  if (parts_.needs.size().results_grow()) note_answered(tested, members);
  parts_.recorder.tested(tested, id, at, outcome, parts_.resource);
  context.since = now;
  context.packet = id;
  context.counts = outcome.counts;
  context.reads = outcome.reads;
  context.bundle_passes = outcome.bundle_passes;
  context.places = places_.of(parts_.resource.tested());
  if (parts_.tester.distributor() != nullptr)
    context.results.slots.assign(parts_.resource.tested().begin(), parts_.resource.tested().end());
  context.question.slots.assign(outcome.any_hit_slots.begin(), outcome.any_hit_slots.end());
  context.question.calls.assign(outcome.any_hit_calls.begin(), outcome.any_hit_calls.end());
  parts_.completions.in_test().begin(parts_.resource.tested(), context.tested);
  context.completed.swap(parts_.resource.completed());
  context.freed_slots.swap(parts_.resource.freed_slots());
  context.subtree = parts_.needs.is_treelet(packet);
  context.loaded = context.subtree && parts_.needs.loads_treelets() && packet.groups.empty();
  context.has_data = has_data;
  if (context.subtree) visits_.prepare(place, parts_.walk.ways());
  if (!starts_later_) return compute(place, at);
  phases_.enter(place, ContextPhase::kStarting, at);
}

/// A visit has tested the rays that live here. `before`: the packet's members then; behind them stand rays of bundles
/// that were taken apart.
void TestContexts::note_answered(Packet& packet, std::size_t before) const {
  const RayIdLayout& layout = parts_.resource.rays().layout();
  const auto added = static_cast<std::uint32_t>(packet.members.size() - before);
  const auto end = packet.members.begin() + static_cast<std::ptrdiff_t>(before);
  packet.answered +=
      added + static_cast<std::uint32_t>(std::count_if(packet.members.begin(), end, [&](const PacketMember& member) {
        return layout.owner(member.ray) == id();
      }));
  packet.named += added;
}

void TestContexts::start(Cycle now) {
  ContextPhases::for_each(phases_.in(ContextPhase::kStarting), [&](std::size_t i) {
    if (phases_.end(i) <= now) start_one(i, now);
  });
}

/// The dispatch stage has read the packet.
void TestContexts::start_one(std::size_t place, Cycle now) {
  Context& context = contexts_[place];
  const Packet& packet = parts_.machine.packet(context.packet);
  const bool takes = context.subtree ? context.loaded : fetch_by_resource_;
  if (context.has_data || !takes ||
      parts_.shapes.take(user(place), parts_.needs.shapes(packet, context.counts.transforms > 0), now))
    context.subtree ? walk(place, now) : compute(place, now);
  else
    phases_.enter(place, ContextPhase::kFetching);
}

/// Its rays go through a subtree, each by itself.
void TestContexts::walk(std::size_t place, Cycle now) {
  Context& context = contexts_[place];
  phases_.enter(place, ContextPhase::kWalking);
  context.begun = now;
  visits_.begin(place, context.reads, now, context.loaded);
  if (context.has_data && !context.loaded) parts_.shapes.release(user(place), now);  // its rays have taken it
}

void TestContexts::compute(std::size_t place, Cycle at) {
  Context& context = contexts_[place];
  context.begun = at;
  if (parts_.tester.distributor() != nullptr) return distribute(context, at);
  phases_.enter(place, ContextPhase::kComputing,
                parts_.tester.strip(at, context.counts, context.reads, context.bundle_passes, context.places));
}

/// The same behind a distributor, which says when each result is there.
void TestContexts::distribute(Context& context, Cycle at) {
  const ShapeNeed shapes = parts_.needs.shapes(parts_.machine.packet(context.packet), context.counts.transforms > 0);
  parts_.tester.distribute(at, context.results.slots, context.counts, shapes.bytes(), context.results.cycles);
  phases_.enter(static_cast<std::size_t>(&context - contexts_.data()), ContextPhase::kComputing,
                forwards_ ? context.results.first() : context.results.last());
}

bool TestContexts::serve(Cycle now) {
  visits_.serve(now);
  visits_.run(now);
  if (visits_.others().empty()) return false;
  for (const ShapeBuffer::User context : visits_.others())
    contexts_[context].subtree ? walk(context, now) : compute(context, now);
  visits_.others().clear();
  return true;
}

bool TestContexts::finish(Cycle now) {
  using enum ContextPhase;
  const ContextPhases::Set walking = phases_.in(kWalking);
  bool moved = false;
  ContextPhases::for_each(walking | phases_.in(kComputing), [&](std::size_t i) {
    if ((walking >> i & 1) != 0 ? !visits_.ended(i) : phases_.end(i) > now) return;
    end(i, now);
    moved = true;
  });
  return moved;
}

void TestContexts::end(std::size_t place, Cycle now) {
  Context& context = contexts_[place];
  const PacketId id = context.packet;
  Packet& packet = parts_.machine.packet(id);
  if (Distributor* distributor = parts_.tester.distributor(); distributor != nullptr) {
    const std::size_t due = context.results.due(now);
    distributor->part_went_on(due);
    if (due < context.results.size()) return end_part(place, now);
  }
  parts_.recorder.step(now, StepKind::kTested, id.value, packet.members.size());
  parts_.recorder.in_context(id, place, context.since, context.begun, now);
  parts_.recorder.tested_rays(id, packet.members, context.since, context.begun, now,
                              context.subtree ? visits_.times(place) : std::span<const WalkTime>());
  if (!context.subtree || context.loaded) parts_.shapes.release(user(place), now);
  phases_.enter(place, ContextPhase::kFree);
  context.subtree = context.loaded = false;
  parts_.any_hit.send(context.question, now);
  parts_.completions.in_test().end(context.tested);
  parts_.completions.take(context.completed, context.freed_slots);
  if (parts_.logic.leaves_after_test(packet)) return parts_.egress.depart(id, now, true);
  const std::size_t entries = parts_.needs.read_at_owner(packet);
  if (entries > 0) parts_.dispatch.occupy(now, entries, SliceKind::kRetire, id);
  parts_.retirement.retire(id, packet, entries, now);
}

/// Behind a distributor that forwards stragglers: results that are there go on, and those members leave the packet.
void TestContexts::end_part(std::size_t place, Cycle now) {
  Context& context = contexts_[place];
  Packet& packet = parts_.machine.packet(context.packet);
  context.results.take_due(now, packet, part_.packet, part_.slots);
  phases_.enter(place, ContextPhase::kComputing, context.results.first());
  parts_.recorder.tested_rays(context.packet, part_.packet.members, context.since, context.begun, now);
  part_.take_completed(context.completed, context.freed_slots);
  if (!context.tested.empty()) {
    context.tested = context.results.slots;
    parts_.completions.in_test().end(part_.slots);
  }
  parts_.completions.take(part_.completed, part_.freed_slots);
  parts_.retirement.retire_part(context.packet, part_.packet, now);
}

void TestContexts::take_any_hit(Cycle now) {
  if (!parts_.any_hit.on()) return;
  while (parts_.any_hit.next() <= now) {
    const AnyHitAnswer answer = parts_.any_hit.take();
    if (parts_.logic.only_forwards()) continue;
    for (const std::uint32_t slot : answer.slots) parts_.resource.release(slot);
  }
  parts_.completions.take(parts_.resource.completed(), parts_.resource.freed_slots());
}

void TestContexts::discard(Cycle now) {
  for (std::size_t place = 0; place < contexts_.size(); ++place) {
    if ((phases_.in(ContextPhase::kFree) >> place & 1) != 0) continue;
    Context& context = contexts_[place];
    if (context.subtree) visits_.drop(place, now);
    parts_.shapes.release(user(place), now);
    const PacketId id = context.packet;
    const Packet& packet = parts_.machine.packet(id);
    if (packet.owner != this->id()) {
      parts_.egress.depart(id, now, true);
    } else {
      if (parts_.logic.leaves_after_test(packet)) parts_.egress.port_of(packet).release();
      parts_.retirement.discard(id, now);
    }
    context = Context{};
    phases_.enter(place, ContextPhase::kFree);
  }
}

void TestContexts::forget_ready() {
  parts_.shapes.ready().clear();
  visits_.others().clear();
}

}  // namespace carousel::ringbus::cycle
