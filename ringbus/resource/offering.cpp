#include "ringbus/resource/offering.h"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <utility>

namespace carousel::ringbus {

Offer Offering::offer(bool partial, Packet& packet) {
  if (!busy()) {
    bool storage = false;
    const std::optional<CollectionId> chosen = choose(partial, storage);
    if (!chosen) return storage ? Offer::kStorage : Offer::kNothing;
    const bool ready = collections_.is_ready(*chosen);
    take(*chosen);
    if (group_rays_ > 0 && !ready) group_up();
  } else if (in_flight_ > 0 && !storage_.fits(blocks_needed(block_.key, 0), 0)) {
    return Offer::kStorage;
  }
  fill(packet);
  if (++block_.next_packet == block_.packets) block_.rays.clear();
  return Offer::kPacket;
}

std::optional<CollectionId> Offering::choose(bool partial, bool& storage) {
  const std::optional<CollectionId> best = collections_.best(partial);
  if (!best) return best;
  const std::uint32_t needed = blocks_needed(collections_.key(*best), collections_.front_rays(*best));
  if (storage_.fits(needed, collections_.front_blocks(*best))) return best;
  // One packet at a time, deepest first: each level down needs at most width - 1 blocks more, which the reserve holds,
  // and gives them all back when its subtree is done.
  if (in_flight_ > 0) {
    storage = true;
    return std::nullopt;
  }
  record({.kind = EventKind::kStall, .resource = rays_.owner(), .reason = StallReason::kReserve});
  return collections_.deepest();
}

void Offering::take(CollectionId chosen) {
  block_.key = collections_.key(chosen);
  block_.shape = collections_.shape(chosen);
  block_.depth = collections_.depth(chosen);
  block_.entry = collections_.entry(chosen);
  collections_.take(chosen, block_.rays, &block_.joined);
  block_.next_packet = 0;
  // Memberships that move to another home are not tested on their way: one packet carries them.
  const bool tested = homes_.of(block_.key) == rays_.owner();
  const std::int32_t packets = tested ? traversal_.tests_at(block_.key) / traversal_.collections_at(block_.key) : 1;
  block_.packets = static_cast<std::uint32_t>(packets);
  block_.needed = tested ? traversal_.blocks_needed(block_.key, static_cast<std::uint32_t>(block_.rays.size())) : 0;
  block_.groups.clear();
}

/// Fills the block up with the next collections that are not ready either, in the order of the policy, as long as they
/// fit as a whole: into the packet, and their children into storage.
void Offering::group_up() {
  if (homes_.of(block_.key) != rays_.owner()) return;
  while (block_.rays.size() < group_rays_) {
    const std::optional<CollectionId> next = collections_.best(true);
    if (!next || collections_.is_ready(*next)) return;
    const PacketGroup group{static_cast<std::uint32_t>(block_.rays.size()), collections_.depth(*next),
                            collections_.key(*next)};
    const std::uint32_t rays = collections_.front_rays(*next);
    if (block_.rays.size() + rays > group_rays_ || homes_.of(group.key) != rays_.owner()) return;
    const std::uint32_t needed = block_.needed + traversal_.blocks_needed(group.key, rays);
    if (!storage_.fits(needed, collections_.front_blocks(*next))) return;
    collections_.take(*next, more_, &more_joined_);
    block_.rays.insert(block_.rays.end(), more_.begin(), more_.end());
    block_.joined.insert(block_.joined.end(), more_joined_.begin(), more_joined_.end());
    block_.groups.push_back(group);
    block_.needed = needed;
  }
}

void Offering::fill(Packet& packet) {
  const std::vector<RayId>& rays = block_.rays;
  packet.owner = rays_.owner();
  packet.home = homes_.of(block_.key);
  packet.kind = packet.home == packet.owner ? PacketKind::kTest : PacketKind::kMemberships;
  packet.key = block_.key;
  packet.depth = block_.depth;
  packet.lanes = traversal_.lanes(block_.shape + block_.next_packet);
  packet.reserved_blocks = packet.kind == PacketKind::kTest ? block_.needed : 0;
  packet.groups = block_.groups;
  std::fill(std::begin(packet.nearest), std::end(packet.nearest), kInfinity);
  if (packet.kind == PacketKind::kMemberships) packet.nearest[0] = block_.entry;
  packet.answered = packet.named = 0;
  packet.takes_reserve = !storage_.fits(packet.reserved_blocks, 0);
  if (kChecked && block_.joined.size() != rays.size())
    throw std::logic_error("a packet has rays of which nobody knows when they joined their collection");
  packet.members.resize(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) packet.members[i] = {rays[i], 0, false, block_.joined[i]};
  traversal_.prepare(packet);
  mark_owners(packet);
  storage_.issue(packet.reserved_blocks);
  ++in_flight_;
  record({.kind = EventKind::kIssue,
          .resource = rays_.owner(),
          .key = block_.key,
          .rays = static_cast<std::uint32_t>(rays.size()),
          .members = packet.members});
}

void Offering::mark_owners(Packet& packet) const {
  std::fill(packet.owners.begin(), packet.owners.end(), 0);
  const auto mark = [&](ResourceId owner) {
    packet.owners[owner.value / 64] |= std::uint64_t{1} << (owner.value % 64);
  };
  if (local_) return mark(rays_.owner());
  for (const RayId ray : block_.rays) mark(rays_.layout().owner(ray));
}

void Offering::retire(const Packet& packet, std::size_t joined) {
  storage_.retire(packet.reserved_blocks, packet.members.size(), joined);
  --in_flight_;
}

void Offering::retire_part(const Packet& part, std::size_t joined) {
  storage_.retire(0, part.members.size(), joined);  // blocks that are promised to the packet stay so until it is back
}

std::uint32_t Offering::discard() {
  block_ = {};
  storage_.discard();
  return std::exchange(in_flight_, 0);
}

}  // namespace carousel::ringbus
