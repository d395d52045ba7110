// The tests of a packet at a resource: from the first cycle of its context to the last, with the fetches in between.
#include <algorithm>

#include "ringbus/cycle/tile/tile.h"

namespace carousel::ringbus::cycle {

bool Tile::testers_free() const {
  return std::all_of(contexts_.begin(), contexts_.end(),
                     [](const Context& c) { return c.phase == Context::Phase::kFree; });
}

Tile::Context* Tile::free_context() {
  if (help_.holds()) return nullptr;
  for (Context& context : contexts_)
    if (context.phase == Context::Phase::kFree) return &context;
  return nullptr;
}

std::array<ShapeSpan, 2> Tile::shape_data(accel::NodeKey key, bool transform) const {
  return {memory_.strip(key), transform ? memory_.transform(key.instance) : ShapeSpan{}};
}

bool Tile::lacks(const ShapeSpan& span) {
  return span.bytes > 0 && !shapes_.has(span);
}

void Tile::begin_fetch(Context& context, const ShapeSpan& strip, Cycle now) {
  ++context.outstanding;
  fetch(strip, kContextTag | static_cast<std::uint32_t>(&context - contexts_.data()), now);
}

void Tile::begin_test(Context& context, PacketId id, Cycle at) {
  Packet& packet = machine_.packet(id);
  const TestOutcome outcome = resource_.test(packet);
  context.packet = id;
  context.counts = outcome.counts;
  context.reads = outcome.reads;
  context.bundle_passes = outcome.bundle_passes;
  for (const AnyHitCall& call : outcome.any_hit_calls) {
    context.question.slots.push_back(call.slot);
    context.question.times += call.times;
  }
  context.completed.swap(resource_.completed());
  context.freed_slots.swap(resource_.freed_slots());
  context.subtree = resource_.is_treelet(packet.key);
  context.phase = Context::Phase::kComputing;
  if (context.subtree) {
    // Each ray fetches the strip that it needs next, so as many fetches are under way as there are rays.
    context.done = tester_.walk(at, context.counts, walk_.account().chain, context.reads);
    context.strips.clear();
    for (const std::uint32_t instance : walk_.account().instances)
      if (const ShapeSpan span = memory_.transform(instance); !shapes_.has(span)) context.strips.push_back(span);
    for (const accel::NodeKey key : walk_.account().strips)
      if (const ShapeSpan strip = memory_.strip(key); !shapes_.has(strip)) context.strips.push_back(strip);
    std::reverse(context.strips.begin(), context.strips.end());
    const std::size_t together = std::min({outcome.rays, kSubtreeFetches, context.strips.size()});
    for (std::size_t i = 0; i < together; ++i) {
      begin_fetch(context, context.strips.back(), at);
      context.strips.pop_back();
    }
  } else {
    if (fetch_by_resource_)
      for (const ShapeSpan& span : shape_data(packet.key, context.counts.transforms > 0))
        if (lacks(span)) begin_fetch(context, span, at);
    if (context.outstanding == 0)
      context.done = tester_.strip(at, context.counts, context.reads, context.bundle_passes);
  }
  if (context.outstanding > 0) context.phase = Context::Phase::kFetching;
}

bool Tile::finish_tests(Cycle now) {
  bool moved = false;
  for (Context& context : contexts_) {
    if (context.phase != Context::Phase::kComputing || context.done > now) continue;
    end_test(context, now);
    moved = true;
  }
  return moved;
}

void Tile::end_test(Context& context, Cycle now) {
  const PacketId id = context.packet;
  const Packet& packet = machine_.packet(id);
  trace_.note(now, StepKind::kTested, id.value, packet.members.size());
  context.phase = Context::Phase::kFree;
  context.subtree = false;
  ask(context, now);
  take_completed(context.completed, context.freed_slots);
  if (packet.owner == id_ && !logic_.travels(packet)) {
    occupy_dispatch(now, packet.members.size());
    retire_at_owner(id);
  } else {
    depart(id, now, true);
  }
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
  done_.insert(done_.end(), rays.begin(), rays.end());
  done_slots_.insert(done_slots_.end(), slots.begin(), slots.end());
  rays.clear();
  slots.clear();
}

void Tile::fetch(const ShapeSpan& strip, std::uint32_t tag, Cycle now) {
  shapes_.request(strip, tag, now);
  ++fetches_out_;
  // Its place in the buffer is taken now; another packet that wants it meanwhile waits behind this fetch.
  shapes_.keep(strip);
}

void Tile::take_answers(Cycle now) {
  while (shapes_.next() <= now) {
    const std::uint32_t tag = shapes_.take();
    --fetches_out_;
    if (logic_.only_forwards()) continue;
    if ((tag & kContextTag) == 0) {
      for (Issue& issue : issue_)
        if (issue.tag == tag && !issue.ready()) --issue.outstanding;
      continue;
    }
    Context& context = contexts_[tag & ~kContextTag];
    --context.outstanding;
    if (!context.strips.empty()) {
      begin_fetch(context, context.strips.back(), now);
      context.strips.pop_back();
    }
    if (context.outstanding > 0) continue;
    context.phase = Context::Phase::kComputing;
    context.done = context.subtree ? std::max(context.done, now + tester_.bank(UnitKind::kBox).latency())
                                   : tester_.strip(now, context.counts, context.reads, context.bundle_passes);
  }
}

}  // namespace carousel::ringbus::cycle
