#include "ringbus/topology/topology.h"

#include <algorithm>

namespace carousel::ringbus {

namespace {

std::uint16_t directions_of(const TopologyConfig& config) {
  if (config.shape == TopologyShape::kBidirectional) return 2;
  return config.shape == TopologyShape::kMultiRing ? static_cast<std::uint16_t>(config.rings) : 1;
}

}  // namespace

Topology::Topology(const TopologyConfig& config)
    : shape_(config.shape),
      resources_(static_cast<std::uint32_t>(config.resources)),
      groups_(shape_ == TopologyShape::kHierarchical ? std::min(static_cast<std::uint32_t>(config.groups), resources_)
                                                     : 0),
      directions_(directions_of(config)),
      visit_all_(config.visit == Visit::kAll) {
  if (resources_ == 1 || shape_ == TopologyShape::kIndependent) return;
  if (groups_ > 0) wire_groups();
  for (std::uint32_t r = 0; groups_ == 0 && r < resources_; ++r) {
    if (bus()) {
      wires_.push_back({ResourceId(r), ResourceId(resources_), 0});
      wires_.push_back({ResourceId(resources_), ResourceId(r), 0});
    } else if (direct()) {
      for (std::uint32_t to = 0; to < resources_; ++to)
        if (to != r) wires_.push_back({ResourceId(r), ResourceId(to), 0});
    } else {
      for (std::uint16_t d = 0; d < directions_; ++d) wires_.push_back({ResourceId(r), follower(d, ResourceId(r)), d});
    }
  }
}

void Topology::wire_groups() {
  for (std::uint32_t g = 0; g < groups_; ++g) {
    const ResourceId bridge(resources_ + g);
    wires_.push_back({bridge, first_of(g), 0});
    for (std::uint32_t r = first_of(g).value; r < last_of(g).value; ++r)
      wires_.push_back({ResourceId(r), ResourceId(r + 1), 0});
    wires_.push_back({last_of(g), bridge, 0});
    if (groups_ > 1) wires_.push_back({bridge, ResourceId(resources_ + (g + 1) % groups_), 1});
  }
}

ResourceId Topology::follower(std::uint16_t direction, ResourceId here) const {
  const bool back = shape_ == TopologyShape::kBidirectional && direction == 1;
  return ResourceId((here.value + (back ? resources_ - 1 : 1)) % resources_);
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
  ResourceId at = follower(packet.direction, here);
  if (!direct() || visit_all_) return at;
  while (at != packet.owner && !wanted(packet, at)) at = follower(packet.direction, at);
  return at;
}

std::uint16_t Topology::skip_to(const Packet& packet, std::uint32_t at, std::uint32_t end) const {
  std::uint16_t skip = 0;
  for (; at < end && ResourceId(at) != packet.owner && !wanted(packet, ResourceId(at)); ++at) ++skip;
  return skip;
}

std::uint16_t Topology::skip(const Packet& packet, ResourceId here) const {
  if (direct()) return 0;
  if (groups_ > 0) return skip_to(packet, here.value + 1, last_of(group_of(here)).value + 1);
  std::uint16_t skip = 0;
  for (ResourceId at = follower(packet.direction, here); at != packet.owner && !wanted(packet, at);
       at = follower(packet.direction, at))
    ++skip;
  return skip;
}

std::uint16_t Topology::skip_from_entrance(const Packet& packet, std::uint32_t group) const {
  return skip_to(packet, first_of(group).value, last_of(group).value + 1);
}

bool Topology::group_wants(const Packet& packet, std::uint32_t group) const {
  if (visit_all_ || group_of(packet.owner) == group) return true;
  return skip_from_entrance(packet, group) <= last_of(group).value - first_of(group).value;
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
    case Flow::kCredits:
      return depth;
    // Any number is safe; as many as the links hold is all that can be of use.
    case Flow::kBubble:
      return std::min(depth * resources, 256u);
    // Enough to fill every link and every hand.
    case Flow::kNone:
      return depth + 8;
  }
  return depth;
}

}  // namespace carousel::ringbus
