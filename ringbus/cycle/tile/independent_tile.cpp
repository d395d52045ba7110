#include "ringbus/cycle/tile/independent_tile.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "ringbus/cycle/tile/resource_energy.h"

namespace carousel::ringbus::cycle {

IndependentTile::IndependentTile(ResourceId id, Machine& machine, const ShapeMemory& memory,
                                 const TileSettings& settings, const SidePorts& ports)
    : UnlinkedResource(id, machine, memory, settings, ports),
      question_wire_(settings.link, control_latency(settings.link)),
      ports_(ports),
      registers_(id, settings.testers.stack_entries, store_.slots(), shapes_.port()),
      completed_port_(settings.link, ports),
      help_(settings.link, ports),
      threads_(store_.slots(), Thread{{}, RayWalk(transforms_, settings.resource.collections.order), {}, {}}),
      times_(recording_.times != nullptr ? &recording_.times->of(id) : nullptr) {}

Cycle IndependentTile::next() const {
  const Cycle tested = tests_.empty() ? kNever : tests_.top().done;
  const Cycle answered = ports_.answers == nullptr ? kNever : ports_.answers->next();
  return std::min({tested, answered, ports_.new_rays->next(), shapes_.next(), help_.ends(), help_.next_job()});
}

void IndependentTile::run(Cycle end) {
  for (Cycle now; (now = next()) < end;) step(now);
}

void IndependentTile::step(Cycle now) {
  begin_step(now);
  take_new_rays(now);
  while (ports_.answers != nullptr && ports_.answers->next() <= now)
    for (const std::uint32_t slot : ports_.answers->take().slots) {
      spent(slot, RayStage::kOpacity, now);
      keep_running(slot, now);
    }
  shapes_.take_answers(now);
  take_entries(now);
  serve(now);
  do {
    while (!tests_.empty() && tests_.top().done <= now) {
      const std::uint32_t slot = tests_.top().slot;
      tests_.pop();
      trace_.note(now, StepKind::kTestedRay, slot, 1);
      shapes_.release(slot, now);
      registers_.spill(slot, threads_[slot].walk, now);
      if (HitBatch& calls = threads_[slot].calls; !calls.empty()) {
        AnyHitQuestion question{{slot}, std::exchange(calls, {})};
        const Cycle arrival = question_wire_.send(question.bytes(), now);  // before the question is moved away
        ports_.questions->send(arrival, std::move(question));
      } else {
        keep_running(slot, now);
      }
      serve(now);
    }
  } while (help_.step(now, tests_.empty()));
  if (!help_.holds()) test_held_back(now);
  hand_over(now);
  const TileState state = classify();
  ledger_.enter(state, now);
  help_.notify(now, state == TileState::kIdle);
}

TileState IndependentTile::classify() const {
  if (help_.shading()) return TileState::kShading;
  if (!tests_.empty()) return TileState::kTesting;
  return shapes_.fetches() == 0 && registers_.idle() ? TileState::kIdle : TileState::kMemory;
}

void IndependentTile::take_new_rays(Cycle now) {
  while (ports_.new_rays->next() <= now) {
    const NewRays rays = ports_.new_rays->take();
    trace_.note(now, StepKind::kNewRays, 0, rays.ids.size());
    record({.kind = EventKind::kAdmit, .resource = id_, .rays = static_cast<std::uint32_t>(rays.ids.size())});
    for (const RayId id : rays.ids) {
      const std::uint32_t slot = store_.slot(id);
      ++active_;
      threads_[slot].ray = id;
      threads_[slot].walk.start(accel_.root_key(), nullptr, true);
      if (follows(slot)) [[unlikely]]
        note(RayFact::Kind::kAdmitted, now, now);
      spent(slot, RayStage::kLoad, now);
      keep_running(slot, now);
    }
  }
}

// ---- a ray's turns

void IndependentTile::keep_running(std::uint32_t slot, Cycle now) {
  Thread& thread = threads_[slot];
  stack_.held -= thread.walk.stack_bytes().held;
  const std::optional<accel::NodeKey> next = thread.walk.next(store_.record(slot), registers_.beyond(slot));
  registers_.shrink(slot, thread.walk);
  stack_.held += thread.walk.stack_bytes().held;
  if (!next && registers_.beyond(slot) > 0) return registers_.refill(slot, thread.walk, now);
  if (!next) {
    complete(slot);
    return;
  }
  thread.strip = *next;
  if (follows(slot)) [[unlikely]]
    waits_since_ = now;
  const bool enters = thread.walk.enters(next->instance);
  const ShapeNeed need{memory_.strip(*next), enters ? memory_.transform(next->instance) : ShapeSpan{},
                       memory_.gaussians(*next)};
  if (shapes_.take(slot, need, now)) test(slot, now);
}

/// Rays whose stack entries have come go on with the turn that they began.
void IndependentTile::take_entries(Cycle now) {
  for (const std::uint32_t slot : shapes_.spill_answers()) {
    registers_.take(slot);
    spent(slot, RayStage::kShapes, now);
    keep_running(slot, now);
  }
  shapes_.spill_answers().clear();
}

/// Tests the rays that waited for data and need wait no longer.
void IndependentTile::serve(Cycle now) {
  for (const std::uint32_t slot : shapes_.ready()) test(slot, now);
  shapes_.ready().clear();
}

void IndependentTile::test_held_back(Cycle now) {
  for (const std::uint32_t slot : held_back_) test(slot, now);
  held_back_.clear();
}

void IndependentTile::test(std::uint32_t slot, Cycle now) {
  if (help_.holds()) {
    held_back_.push_back(slot);
    return;
  }
  Thread& thread = threads_[slot];
  stack_.held -= thread.walk.stack_bytes().held;
  std::vector<AnyHitCall> calls;
  const IntersectionCounts counts =
      thread.walk.test(accel_, thread.strip,
                       {store_.records(), &slot, 1, statistics_ ? sink_.cull_counts() : nullptr,
                        ports_.questions != nullptr ? &calls : nullptr});
  for (const AnyHitCall& call : calls) thread.calls.push_back(AnyHitHold::completed_at(call));
  const std::uint64_t held = thread.walk.stack_bytes().held;
  stack_.held += held;
  stack_.traffic.peak_bytes = std::max(stack_.traffic.peak_bytes, stack_.held);
  stack_.traffic.ray_peak_bytes = std::max(stack_.traffic.ray_peak_bytes, held);
  const Cycle done = tester_.ray(tester_.read(now, 1), counts);
  tests_.push({done, next_turn_++, slot});
  spent(slot, RayStage::kShapes, now);
  spent(slot, RayStage::kTest, done);
  if (follows(slot)) [[unlikely]] {
    note(RayFact::Kind::kFetched, waits_since_, now, thread.strip);
    note(RayFact::Kind::kWalked, now, done, thread.strip);
    recording_.ray->facts.back().hit = store_.record(slot).hit;
  }
  const PacketMember member{thread.ray, 0};
  record({.kind = EventKind::kTest,
          .resource = id_,
          .key = thread.strip,
          .rays = 1,
          .tests = &counts,
          .members = {&member, 1}});
}

void IndependentTile::complete(std::uint32_t slot) {
  const RayWalk::StackBytes& bytes = threads_[slot].walk.stack_bytes();
  stack_.traffic.pushed_bytes += bytes.pushed;
  stack_.traffic.popped_bytes += bytes.popped;
  --active_;
  store_.finish(slot, completed_);
  transforms_.forget(slot);
  store_.retire(slot);
  freed_slots_.push_back(slot);
}

void IndependentTile::hand_over(Cycle now) {
  if (completed_.empty()) return;
  if (recording_.ray != nullptr) [[unlikely]]
    note_done(now);
  for (std::size_t i = 0; times_ != nullptr && i < completed_.size(); ++i)
    times_->done(freed_slots_[i], completed_[i].tag, now);
  trace_.note(now, StepKind::kComplete, 0, completed_.size());
  record({.kind = EventKind::kComplete, .resource = id_, .rays = static_cast<std::uint32_t>(completed_.size())});
  completed_port_.send(completed_, freed_slots_, {}, now, sent_hits(store_));
}

void IndependentTile::note_done(Cycle now) {
  for (const RayResult& ray : completed_)
    if (recording_.ray->ray->is(ray.tag)) note(RayFact::Kind::kDone, now, now);
}

// ---- the end, good or bad

ResourceAgent::Work IndependentTile::work() const {
  Work out{tester_.busy_units(), tester_.busy_reads(), 0};
  read_energy(tester_, sink_.statistics(), shapes_.counts(), out);
  out.energy.stack_bytes = stack_.traffic.pushed_bytes + stack_.traffic.popped_bytes;
  return out;
}

TileResult IndependentTile::result() const {
  TileResult t;
  ledger_.fill_in(t);
  t.shapes = shapes_.counts();
  t.strip_reads = shapes_.reads();
  t.stack = stack_.traffic;
  t.stack.spilled_bytes = registers_.spilled_bytes();
  t.stack.refilled_bytes = registers_.refilled_bytes();
  t.transformed_rays = transforms_.bytes();
  return t;
}

std::string IndependentTile::describe() const {
  if (active_ == 0) return "";
  return fmt::format("resource {}: {} rays in slots, {} in test", id_.value, active_, tests_.size());
}

}  // namespace carousel::ringbus::cycle
