#include "ringbus/cycle/tile/warps/warp_tile.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "ringbus/cycle/tile/resource_energy.h"

namespace carousel::ringbus::cycle {

WarpTile::WarpTile(ResourceId id, Machine& machine, const ShapeMemory& memory, const TileSettings& settings,
                   const SidePorts& ports)
    : UnlinkedResource(id, machine, memory, settings, ports),
      simt_(settings.testers.simt),
      new_rays_(*ports.new_rays),
      tests_(shapes_, settings.memory, simt_.lines_per_cycle, tester_),
      registers_(id, simt_.stack_entries, store_.slots(), shapes_.port()),
      any_hit_(settings.link, ports),
      ended_(settings.link, ports),
      forming_(simt_),
      prefetcher_(simt_, machine.accel.pieces.get(), store_.slots()),
      log_(simt_.warp),
      rays_(store_.slots(), Ray{{}, RayWalk(transforms_, settings.resource.collections.order), {}}),
      warps_(static_cast<std::size_t>(simt_.warps)) {
  for (std::size_t w = warps_.size(); w-- > 0;) free_warps_.push_back(static_cast<std::uint32_t>(w));
}

Cycle WarpTile::next() const {
  const Cycle started = starts_.empty() ? kNever : starts_.front().at;
  const Cycle formed = free_warps_.empty() ? kNever : std::max(forming_.next(), now_ + 1);
  return std::min(
      {tests_.next(now_), any_hit_.next(), new_rays_.next(), shapes_.next(), started, formed, prefetcher_.next()});
}

void WarpTile::run(Cycle end) {
  for (Cycle now; (now = next()) < end;) step(now);
}

void WarpTile::step(Cycle now) {
  begin_step(now);
  take_new_rays(now);
  take_answers(now);
  bool more = true;
  while (more) {
    more = tests_.read_and_start(now, [&](std::uint32_t slot, accel::NodeKey strip) { return test(slot, strip, now); });
    more |= tests_.end(now, [&](std::uint32_t slot, accel::NodeKey strip) { tested(slot, strip, now); });
    more |= move_on(now);
    more |= form_warps(now);
    more |= begin_warps(now);
  }
  prefetch(now);
  hand_over(now);
  ledger_.enter(classify(), now);
}

TileState WarpTile::classify() const {
  if (tests_.testing()) return TileState::kTesting;
  return tests_.reading() || !registers_.idle() ? TileState::kMemory : TileState::kIdle;
}

void WarpTile::take_new_rays(Cycle now) {
  while (new_rays_.next() <= now) {
    const NewRays rays = new_rays_.take();
    trace_.note(now, StepKind::kNewRays, 0, rays.ids.size());
    record({.kind = EventKind::kAdmit, .resource = id_, .rays = static_cast<std::uint32_t>(rays.ids.size())});
    for (const RayId id : rays.ids) {
      const std::uint32_t slot = store_.slot(id);
      ++active_;
      Ray& ray = rays_[slot];
      ray.id = id;
      ray.done = false;
      ray.walk.start(accel_.root_key(), nullptr, true);
      if (follows(slot)) [[unlikely]]
        note(RayFact::Kind::kAdmitted, now, now);
      if (forming_.packs())
        movers_.push_back(slot);
      else
        forming_.wait(slot, false, now);
    }
  }
}

void WarpTile::take_answers(Cycle now) {
  shapes_.take_answers(now);
  take_entries(now);
  while (any_hit_.next() <= now)
    for (const std::uint32_t slot : any_hit_.take().slots) lane_ends_step(slot);
}

/// Rays whose stack entries have come go on with the turn that they began.
void WarpTile::take_entries(Cycle now) {
  for (const std::uint32_t slot : shapes_.spill_answers()) {
    registers_.take(slot);
    if (forming_.packs()) {
      pack_again(kNone, {&slot, 1}, now);
      continue;
    }
    --warps_[rays_[slot].warp].open;
    go_on(rays_[slot].warp, {&slot, 1}, now);
  }
  shapes_.spill_answers().clear();
}

/// What nobody asks for in this cycle leaves the port to the treelet that was chosen.
void WarpTile::prefetch(Cycle now) {
  if (!prefetcher_.on()) return;
  if (const accel::TreePieces::Piece* chosen = prefetcher_.choose(now))
    tests_.read_ahead({chosen->address, chosen->bytes});
  const bool reading = tests_.reads().reads_ahead();
  tests_.read_idle(now);
  if (reading && !tests_.reads().reads_ahead()) prefetcher_.read(now);
}

// ---- a ray's turns

/// Finds the next strip of a ray, as far as the entries of its stack are at hand; asks for more where they are not.
WarpTile::Turn WarpTile::turn(std::uint32_t slot, Cycle now) {
  Ray& ray = rays_[slot];
  const std::uint64_t before = ray.walk.stack_bytes().held;
  const std::optional<accel::NodeKey> next = ray.walk.next(store_.record(slot), registers_.beyond(slot));
  registers_.shrink(slot, ray.walk);
  ended_.stacked(before, ray.walk);
  ray.waits_since = now;
  if (next) {
    ray.strip = *next;
    prefetcher_.vote(slot, next->ref, now);
    return Turn::kStrip;
  }
  if (registers_.beyond(slot) == 0) {
    prefetcher_.leave(slot, now);
    return Turn::kEnds;
  }
  registers_.refill(slot, ray.walk, now);
  return Turn::kReads;
}

void WarpTile::ask(std::uint32_t slot, accel::NodeKey strip, bool needs_transform) {
  const ShapeNeed need{memory_.strip(strip), needs_transform ? memory_.transform(strip.instance) : ShapeSpan{},
                       memory_.gaussians(strip)};
  ++rays_[slot].in_test;
  tests_.ask(slot, strip, need);
}

/// Lanes without a ray take further nodes from the stacks of those that ask, one from each in turn. A helper has not
/// been in the ray's instance.
void WarpTile::help(std::span<const std::uint32_t> slots, std::uint64_t idle, std::uint64_t& nodes,
                    std::uint64_t& leaves) {
  for (bool any = true; any && idle > 0;) {
    any = false;
    for (const std::uint32_t slot : slots) {
      if (idle == 0) break;
      Ray& ray = rays_[slot];
      const std::uint64_t before = ray.walk.stack_bytes().held;
      const std::optional<accel::NodeKey> next = ray.walk.next(store_.record(slot), registers_.beyond(slot), false);
      registers_.shrink(slot, ray.walk);
      ended_.stacked(before, ray.walk);
      if (!next) continue;
      ask(slot, *next, true);
      ++(next->ref.is_inner() ? nodes : leaves);
      --idle;
      any = true;
    }
  }
}

IntersectionCounts WarpTile::test(std::uint32_t slot, accel::NodeKey strip, Cycle now) {
  Ray& ray = rays_[slot];
  const std::uint64_t before = ray.walk.stack_bytes().held;
  std::vector<AnyHitCall> calls;
  const IntersectionCounts counts = ray.walk.test(
      accel_, strip,
      {store_.records(), &slot, 1, statistics_ ? sink_.cull_counts() : nullptr, any_hit_.on() ? &calls : nullptr});
  ended_.stacked(before, ray.walk);
  for (const AnyHitCall& call : calls) ray.calls.push_back(AnyHitHold::completed_at(call));
  if (follows(slot)) [[unlikely]] {
    note(RayFact::Kind::kFetched, ray.waits_since, now, strip);
    ray.waits_since = now;
  }
  const PacketMember member{ray.id, 0};
  record(
      {.kind = EventKind::kTest, .resource = id_, .key = strip, .rays = 1, .tests = &counts, .members = {&member, 1}});
  return counts;
}

void WarpTile::tested(std::uint32_t slot, accel::NodeKey strip, Cycle now) {
  Ray& ray = rays_[slot];
  trace_.note(now, StepKind::kTestedRay, slot, 1);
  if (follows(slot)) [[unlikely]] {
    note(RayFact::Kind::kWalked, ray.waits_since, now, strip);
    recording_.ray->facts.back().hit = store_.record(slot).hit;
  }
  if (--ray.in_test > 0) return;
  registers_.spill(slot, ray.walk, now);
  if (!ray.calls.empty()) {
    AnyHitQuestion question{{slot}, std::exchange(ray.calls, {})};
    any_hit_.send(question, now);
  } else {
    lane_ends_step(slot);
  }
}

/// The ray goes on, at once or with the others of its warp.
void WarpTile::lane_ends_step(std::uint32_t slot) {
  Warp& of = warps_[rays_[slot].warp];
  --of.open;
  if (simt_.step == SimtConfig::Step::kLane)
    movers_.push_back(slot);
  else if (of.open == 0)
    movers_.insert(movers_.end(), of.slots.begin(), of.slots.end());
}

void WarpTile::complete(std::uint32_t slot) {
  --active_;
  ended_.add(slot, rays_[slot].walk, store_);
  transforms_.forget(slot);
}

void WarpTile::hand_over(Cycle now) {
  if (ended_.rays().empty()) return;
  if (recording_.ray != nullptr) [[unlikely]]
    for (const RayResult& ray : ended_.rays())
      if (recording_.ray->ray->is(ray.tag)) note(RayFact::Kind::kDone, now, now);
  const auto rays = static_cast<std::uint32_t>(ended_.rays().size());
  trace_.note(now, StepKind::kComplete, 0, rays);
  record({.kind = EventKind::kComplete, .resource = id_, .rays = rays});
  ended_.send(now);
}

// ---- the end, good or bad

ResourceAgent::Work WarpTile::work() const {
  Work out{tester_.busy_units(), tester_.busy_reads(), 0};
  read_energy(tester_, sink_.statistics(), shapes_.counts(), out);
  out.energy.warps = true;
  out.energy.prefetch_votes = prefetcher_.counts().votes;
  // What is packed goes out of one lane and into another.
  out.energy.stack_bytes = ended_.stack().pushed_bytes + ended_.stack().popped_bytes + 2 * log_.counts().packed_bytes;
  return out;
}

TileResult WarpTile::result() const {
  TileResult t;
  ledger_.fill_in(t);
  t.shapes = shapes_.counts();
  t.strip_reads = shapes_.reads();
  t.stack = ended_.stack();
  t.stack.spilled_bytes = registers_.spilled_bytes();
  t.stack.refilled_bytes = registers_.refilled_bytes();
  t.transformed_rays = transforms_.bytes();
  WarpCounts& warps = t.warps.emplace(log_.counts());
  warps.lines_wanted = tests_.reads().wanted();
  warps.lines_read = tests_.reads().read();
  warps.votes = prefetcher_.counts().votes;
  warps.prefetches = prefetcher_.counts().prefetches;
  warps.lines_prefetched = tests_.reads().lines_ahead();
  warps.lines_prefetched_used = tests_.reads().used_ahead();
  warps.packing = forming_.packing();
  warps.spilled_bytes = registers_.spilled_bytes();
  warps.refilled_bytes = registers_.refilled_bytes();
  t.warp_lanes = static_cast<std::uint64_t>(simt_.warp);
  t.bounces = log_.bounces();
  return t;
}

std::string WarpTile::describe() const {
  if (active_ == 0) return "";
  return fmt::format("resource {}: {} rays in slots, {} in test, {} wait for a warp", id_.value, active_,
                     tests_.in_test(), forming_.waiting());
}

}  // namespace carousel::ringbus::cycle
