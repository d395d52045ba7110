#include "ringbus/topology.h"

#include <algorithm>

namespace carousel::ringbus {

Topology::Topology(const TopologyConfig& config)
    : resources_(static_cast<std::uint32_t>(config.resources)),
      directions_(config.shape == TopologyShape::kBidirectional ? 2 : 1),
      point_to_point_(config.shape == TopologyShape::kPointToPoint),
      visit_all_(config.visit == Visit::kAll) {
  if (resources_ == 1) return;
  for (std::uint32_t r = 0; r < resources_; ++r) {
    if (point_to_point_) {
      for (std::uint32_t to = 0; to < resources_; ++to)
        if (to != r) wires_.push_back({ResourceId(r), ResourceId(to), 0});
    } else {
      wires_.push_back({ResourceId(r), ResourceId((r + 1) % resources_), 0});
      if (directions_ == 2) wires_.push_back({ResourceId(r), ResourceId((r + resources_ - 1) % resources_), 1});
    }
  }
}

bool Topology::wanted(const Packet& packet, ResourceId r) const {
  if (packet.kind == PacketKind::kMemberships) return r == packet.home;
  if (packet.kind == PacketKind::kRays) return true;
  return (packet.owners[r.value / 64] >> (r.value % 64) & 1) != 0;
}

bool Topology::handles(const Packet& packet, ResourceId here) const {
  return visit_all_ ? packet.kind != PacketKind::kMemberships || here == packet.home : wanted(packet, here);
}

ResourceId Topology::next(const Packet& packet, ResourceId here) const {
  const std::uint32_t step = packet.direction == 0 ? 1 : resources_ - 1;
  ResourceId at((here.value + step) % resources_);
  if (!point_to_point_ || visit_all_) return at;
  while (at != packet.owner && !wanted(packet, at)) at = ResourceId((at.value + step) % resources_);
  return at;
}

std::uint32_t Topology::hops(const Packet& packet) const {
  if (resources_ == 1) return 0;
  if (visit_all_) return resources_;
  for (std::uint32_t r = 0; r < resources_; ++r)
    if (ResourceId(r) != packet.owner && wanted(packet, ResourceId(r))) return resources_;
  return 0;
}

std::uint32_t packets_in_flight(const TopologyConfig& config) {
  const std::uint32_t depth = static_cast<std::uint32_t>(config.link.depth);
  const std::uint32_t resources = static_cast<std::uint32_t>(config.resources);
  switch (config.flow) {
    // R resources with `depth` packets each against R links of `depth` places and a place in hand at each
    // resource: one place is always free, so some packet can always move.
    case Flow::kCredits: return depth;
    // Any number is safe; as many as the links hold is all that can be of use.
    case Flow::kBubble: return std::min(depth * resources, 256u);
    // Enough to fill every link and every hand.
    case Flow::kNone: return depth + 8;
  }
  return depth;
}

}  // namespace carousel::ringbus
