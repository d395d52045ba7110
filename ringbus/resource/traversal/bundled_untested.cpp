// Undecided bundles that go back to the builder untested (`bundles.split: untested`; US 11308683, FIG. 11 and 12: the
// rays of a bundle that is split may be processed as if they were newly received).
#include <bit>

#include "ringbus/resource/traversal/bundled.h"

namespace carousel::ringbus {

/// Sends the rays of a bundle that is undecided somewhere back to the builder. They come to the same node again, for
/// all of its children, in bundles of at most half as many, so that this ends. Where storage is short a packet goes out
/// on the reserve, and its bundles are split at once: then each packet leaves its own collection shorter.
void BundledTraversal::give_back(Packet& packet, LocalBundle& local, bool entered, TestOutcome& outcome) {
  const std::span<const std::uint32_t> rays = context_.store.rays_of(local.slot);
  const std::size_t most = std::bit_ceil(rays.size()) / 2;
  for (const std::uint32_t slot : rays)
    if ((context_.store.record(slot).tag.flags & kRayDone) == 0)
      ejected_.add_again(slot, static_cast<std::uint8_t>(most));
  outcome.reads += static_cast<std::uint32_t>(rays.size());
  counts_.touched += rays.size();
  if (entered) charge_transforms(rays, packet.key);  // for its bounds in the instance
  packet.members[local.member].mask = 0;
  local.change = -1;
  ++counts_.visits;
  ++counts_.returned;
}

void BundledTraversal::retire(const Packet& packet, CollectionStore& collections) {
  rays_->retire(packet, collections);
  if (!returns_) return;
  again_.clear();
  for (const PacketMember& member : packet.members)
    if (member.again) again_.push_back(member.ray);
  if (!again_.empty()) collections.add(packet.key, packet.depth, 0.0f, again_);
}

}  // namespace carousel::ringbus
