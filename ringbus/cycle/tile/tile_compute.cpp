// The tests of a packet at a resource: from the first cycle of its context to the last, with the fetches in between.
#include <algorithm>
#include <bit>

#include "ringbus/cycle/tile/tile.h"

namespace carousel::ringbus::cycle {

Tile::Context* Tile::free_context() {
  const ContextPhases::Set free = phases_.in(ContextPhase::kFree);
  if (help_.holds() || free == 0) return nullptr;
  return &contexts_[static_cast<std::size_t>(std::countr_zero(free))];
}

/// The shapes of a packet's tests, and what is stored of their instance's transform.
ShapeNeed Tile::shape_data(const Packet& packet, bool transform) const {
  return {blocks_ != nullptr                 ? blocks_->span(packet.key.ref)
          : resource_.is_treelet(packet.key) ? memory_.strip(packet.key)
                                             : memory_.shapes(packet.key, packet.lanes),
          transform || memory_.reads_record(packet.key) ? memory_.transform(packet.key.instance) : ShapeSpan{}};
}

void Tile::begin_test(Context& context, PacketId id, Cycle at, bool has_data) {
  Packet& packet = machine_.packet(id);
  const bool answers = broadcasts_ && packet.owner != id_;
  Packet& tested = answers ? begin_answer(machine_, id_, id) : packet;
  const std::size_t members = tested.members.size();
  const TestOutcome outcome = resource_.test(tested);
  if (packet_size_.results_grow()) note_answered(tested, members);
  if (recording_.ray != nullptr) [[unlikely]]
    note_tested(tested, id, at, outcome);
  context.since = now_;
  context.packet = id;
  context.counts = outcome.counts;
  context.reads = outcome.reads;
  context.bundle_passes = outcome.bundle_passes;
  context.places = places_.of(resource_.tested());
  if (tester_.distributor() != nullptr)
    context.results.slots.assign(resource_.tested().begin(), resource_.tested().end());
  for (const AnyHitCall& call : outcome.any_hit_calls) {
    context.question.slots.push_back(call.slot);
    context.question.times += call.times;
  }
  in_test_.begin(resource_.tested(), context.tested);
  context.completed.swap(resource_.completed());
  context.freed_slots.swap(resource_.freed_slots());
  context.subtree = resource_.is_treelet(packet.key);
  context.has_data = has_data;
  if (context.subtree) visits_.prepare(user_of(context), walk_.ways());
  if (!starts_later_) return compute(context, at);
  enter(context, ContextPhase::kStarting, at);
}

/// A visit has tested the rays that live here. `before`: the packet's members then; behind them stand rays of bundles
/// that were taken apart.
void Tile::note_answered(Packet& packet, std::size_t before) const {
  const RayIdLayout& layout = resource_.rays().layout();
  const auto added = static_cast<std::uint32_t>(packet.members.size() - before);
  const auto end = packet.members.begin() + static_cast<std::ptrdiff_t>(before);
  packet.answered +=
      added + static_cast<std::uint32_t>(std::count_if(packet.members.begin(), end, [&](const PacketMember& member) {
        return layout.owner(member.ray) == id_;
      }));
  packet.named += added;
}

void Tile::start_tests(Cycle now) {
  ContextPhases::for_each(phases_.in(ContextPhase::kStarting), [&](std::size_t i) {
    if (phases_.end(i) <= now) start(contexts_[i], now);
  });
}

/// The dispatch stage has read the packet.
void Tile::start(Context& context, Cycle now) {
  if (context.subtree) {
    enter(context, ContextPhase::kWalking);
    context.begun = now;
    visits_.begin(user_of(context), context.reads, now);
    if (context.has_data) shapes_.release(user_of(context), now);  // its rays have taken it
    return;
  }
  const Packet& packet = machine_.packet(context.packet);
  if (context.has_data || !fetch_by_resource_ ||
      shapes_.take(user_of(context), shape_data(packet, context.counts.transforms > 0), now))
    compute(context, now);
  else
    enter(context, ContextPhase::kFetching);
}

void Tile::compute(Context& context, Cycle at) {
  context.begun = at;
  if (tester_.distributor() != nullptr) return distribute(context, at);
  enter(context, ContextPhase::kComputing,
        tester_.strip(at, context.counts, context.reads, context.bundle_passes, context.places));
}

/// The same behind a distributor, which says when each result is there.
void Tile::distribute(Context& context, Cycle at) {
  const ShapeNeed shapes = shape_data(machine_.packet(context.packet), context.counts.transforms > 0);
  tester_.distribute(at, context.results.slots, context.counts, shapes[0].bytes + shapes[1].bytes,
                     context.results.cycles);
  enter(context, ContextPhase::kComputing, forwards_ ? context.results.first() : context.results.last());
}

/// Rays in subtrees go on, and those whose data has come begin their tests, then packets likewise.
void Tile::serve(Cycle now) {
  visits_.serve(now);
  visits_.run(now);
  if (visits_.others().empty()) return;
  served_ = true;
  for (const ShapeBuffer::User context : visits_.others()) compute(contexts_[context], now);
  visits_.others().clear();
}

bool Tile::finish_tests(Cycle now) {
  serve(now);
  using enum ContextPhase;
  const ContextPhases::Set walking = phases_.in(kWalking);
  bool moved = false;
  ContextPhases::for_each(walking | phases_.in(kComputing), [&](std::size_t i) {
    if ((walking >> i & 1) != 0 ? !visits_.ended(i) : phases_.end(i) > now) return;
    end_test(contexts_[i], now);
    moved = true;
  });
  return moved;
}

void Tile::end_test(Context& context, Cycle now) {
  const PacketId id = context.packet;
  const Packet& packet = machine_.packet(id);
  if (Distributor* distributor = tester_.distributor(); distributor != nullptr) {
    const std::size_t due = context.results.due(now);
    distributor->part_went_on(due);
    if (due < context.results.size()) return end_part(context, now);
  }
  trace_.note(now, StepKind::kTested, id.value, packet.members.size());
  if (recording_.slices != nullptr) [[unlikely]]
    note_test(context, now);
  if (!context.subtree) shapes_.release(user_of(context), now);
  enter(context, ContextPhase::kFree);
  context.subtree = false;
  ask(context, now);
  in_test_.end(context.tested);
  take_completed(context.completed, context.freed_slots);
  if (logic_.leaves_after_test(packet)) return depart(id, now, true);
  const std::size_t entries = read_at_owner(packet);
  if (entries > 0) occupy_dispatch(now, entries, SliceKind::kRetire, id);
  retire_at_owner(id, entries);
}

/// Behind a distributor that forwards stragglers: results that are there go on, and those members leave the packet.
void Tile::end_part(Context& context, Cycle now) {
  Packet& packet = machine_.packet(context.packet);
  context.results.take_due(now, packet, part_.packet, part_.slots);
  enter(context, ContextPhase::kComputing, context.results.first());
  part_.take_completed(context.completed, context.freed_slots);
  if (!context.tested.empty()) {
    context.tested = context.results.slots;
    in_test_.end(part_.slots);
  }
  take_completed(part_.completed, part_.freed_slots);
  retire_part(context.packet, now);
}

void Tile::ask(Context& context, Cycle now) {
  if (context.question.slots.empty()) return;
  const Cycle arrival = question_wire_.send(context.question.bytes(), now);
  ports_.questions->send(arrival, std::move(context.question));
  ++questions_out_;
  context.question = {};
}

void Tile::take_opacities(Cycle now) {
  if (ports_.answers == nullptr) return;
  while (ports_.answers->next() <= now) {
    --questions_out_;
    const AnyHitAnswer answer = ports_.answers->take();
    if (logic_.only_forwards()) continue;
    for (const std::uint32_t slot : answer.slots) resource_.release(slot);
  }
  take_completed(resource_.completed(), resource_.freed_slots());
}

/// Both are empty afterwards.
void Tile::take_completed(HitBatch& rays, std::vector<std::uint32_t>& slots) {
  in_test_.hand_over(rays, slots, done_, done_slots_);
}

}  // namespace carousel::ringbus::cycle
