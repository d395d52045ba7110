// The warps of a WarpTile, from their forming to their end.
#include <algorithm>
#include <optional>
#include <utility>

#include "ringbus/cycle/tile/warps/warp_tile.h"

namespace carousel::ringbus::cycle {

bool WarpTile::form_warps(Cycle now) {
  bool any = false;
  while (!free_warps_.empty()) {
    std::optional<WarpForming::Warp> formed = forming_.form(now);
    if (!formed) break;
    any = true;
    const std::uint32_t warp = free_warps_.back();
    free_warps_.pop_back();
    log_.formed(formed->slots.size());
    Warp& of = warps_[warp];
    of = {std::move(formed->slots), {}, 0, formed->begin};
    for (const std::uint32_t slot : of.slots) {
      rays_[slot].warp = warp;
      rays_[slot].lane = static_cast<std::uint32_t>(of.lanes.size());
      of.lanes.push_back({store_.record(slot).tag.bounce});
      if (forming_.packs()) log_.packed(registers_.held_bytes(slot, rays_[slot].walk));
    }
    starts_.push_back({formed->begin, warp});
  }
  return any;
}

bool WarpTile::begin_warps(Cycle now) {
  bool any = false;
  for (; !starts_.empty() && starts_.front().at <= now; any = true) {
    const std::uint32_t warp = starts_.front().warp;
    starts_.pop_front();
    const std::vector<std::uint32_t>& slots = warps_[warp].slots;
    if (!forming_.packs()) {
      go_on(warp, slots, now);
      continue;
    }
    std::uint64_t leaves = 0;
    for (const std::uint32_t slot : slots) {
      Ray& ray = rays_[slot];
      ask(slot, ray.strip, ray.walk.enters(ray.strip.instance));
      leaves += !ray.strip.ref.is_inner();
    }
    warps_[warp].open = static_cast<std::uint32_t>(slots.size());
    tests_.end_group();
    log_.step(slots.size() - leaves, leaves, 0);
  }
  return any;
}

/// Takes all rays on that have been tested, those of a warp together.
bool WarpTile::move_on(Cycle now) {
  if (movers_.empty()) return false;
  std::vector<std::uint32_t> movers = std::exchange(movers_, {});
  std::stable_sort(movers.begin(), movers.end(),
                   [this](std::uint32_t a, std::uint32_t b) { return rays_[a].warp < rays_[b].warp; });
  for (std::size_t first = 0; first < movers.size();) {
    const std::uint32_t warp = rays_[movers[first]].warp;
    std::size_t last = first;
    while (last < movers.size() && rays_[movers[last]].warp == warp) ++last;
    const std::span<const std::uint32_t> slots(&movers[first], last - first);
    forming_.packs() ? pack_again(warp, slots, now) : go_on(warp, slots, now);
    first = last;
  }
  return true;
}

/// Rays of a warp name their next strips together.
void WarpTile::go_on(std::uint32_t warp, std::span<const std::uint32_t> slots, Cycle now) {
  Warp& of = warps_[warp];
  std::uint64_t nodes = 0, leaves = 0;
  std::vector<std::uint32_t> asking;
  for (const std::uint32_t slot : slots) {
    Ray& ray = rays_[slot];
    if (ray.done) continue;
    switch (turn(slot, now)) {
      case Turn::kStrip:
        ++of.open;
        asking.push_back(slot);
        ++(ray.strip.ref.is_inner() ? nodes : leaves);
        ask(slot, ray.strip, ray.walk.enters(ray.strip.instance));
        break;
      case Turn::kReads:
        ++of.open;
        break;
      case Turn::kEnds:
        ray.done = true;
        of.lanes[ray.lane].ended = now;
        break;
    }
  }
  if (!asking.empty()) {
    std::uint64_t helped = 0;
    if (simt_.idle_lanes == SimtConfig::IdleLanes::kHelp) {
      const std::uint64_t before = nodes + leaves;
      help(asking, idle_lanes(of), nodes, leaves);
      helped = nodes + leaves - before;
    }
    log_.step(nodes, leaves, helped);
  }
  tests_.end_group();
  if (of.open > 0) return;
  if (std::all_of(of.slots.begin(), of.slots.end(), [this](std::uint32_t slot) { return rays_[slot].done; }))
    end_warp(warp, now);
  else  // the others have been tested, and waited for one that ended when its stack had come
    movers_.insert(movers_.end(), of.slots.begin(), of.slots.end());
}

/// Each ray that has not ended has a lane, and one more for each further strip that it has in test.
std::uint64_t WarpTile::idle_lanes(const Warp& warp) const {
  auto idle = static_cast<std::uint64_t>(simt_.warp);
  for (const std::uint32_t slot : warp.slots)
    if (!rays_[slot].done) idle -= std::max<std::uint64_t>(1, rays_[slot].in_test);
  return idle;
}

/// Rays leave their warp and wait for others with the same kind of step.
void WarpTile::pack_again(std::uint32_t warp, std::span<const std::uint32_t> slots, Cycle now) {
  if (warp != kNone) {
    for (const std::uint32_t slot : slots) warps_[warp].lanes[rays_[slot].lane].ended = now;
    if (warps_[warp].open == 0) end_warp(warp, now);
  }
  for (const std::uint32_t slot : slots) {
    Ray& ray = rays_[slot];
    ray.warp = kNone;
    switch (turn(slot, now)) {
      case Turn::kStrip:
        forming_.wait(slot, !ray.strip.ref.is_inner(), now);
        break;
      case Turn::kReads:
        break;
      case Turn::kEnds:
        complete(slot);
        break;
    }
  }
}

void WarpTile::end_warp(std::uint32_t warp, Cycle now) {
  Warp& of = warps_[warp];
  WarpLog::Ended log = log_.end(now - of.begin, of.slots.size());
  for (const Lane& lane : of.lanes) log.add(lane.bounce, lane.ended - of.begin);
  if (!forming_.packs())
    for (const std::uint32_t slot : of.slots) complete(slot);
  of.slots.clear();
  free_warps_.push_back(warp);
}

}  // namespace carousel::ringbus::cycle
