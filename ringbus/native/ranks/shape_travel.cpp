#include "ringbus/native/ranks/shape_travel.h"

#include <algorithm>

namespace carousel::ringbus {

ShapeTravel::ShapeTravel(const Config& config, const Machine& machine)
    : machine_(machine), partition_(*machine.accel.partition), guests_(machine.packets.size()) {
  accel::GuestShapes::Place place{1, accel::kMaxWidth * accel::kMaxLeafTriangles / accel::kBlockTriangles};
  if (config.collections.traversal == Traversal::kTreelet) {
    treelet_triangles_ = static_cast<std::uint64_t>(config.bvh.treelet_triangles);
    // No node has one child alone, and no block is empty.
    const auto most = static_cast<std::uint32_t>(config.bvh.treelet_triangles);
    place = {std::max(place.nodes, most), std::max(place.blocks, most)};
  }
  machine.accel.guests->set_places(static_cast<std::uint32_t>(machine.packets.size()), place);
}

accel::NodeKey ShapeTravel::key_here(const Packet& packet) const {
  if (partition_.here(packet.key.ref)) return packet.key;
  return {packet.key.instance, guests_[static_cast<std::size_t>(&packet - machine_.packets.data())]};
}

/// Tells whether the packet has rays at `from`, or on its way from there to its owner, that are not at home.
bool ShapeTravel::needed(const Packet& packet, ResourceId from, std::uint32_t home) const {
  for (ResourceId at = from; at != packet.owner; at = machine_.topology.next(packet, at))
    if (machine_.topology.wanted(packet, at) && machine_.share.rank_of(at) != home) return true;
  return false;
}

void ShapeTravel::take_along(PacketId id, const Packet& packet, ResourceId to, RankMessage& message) const {
  if (packet.kind != PacketKind::kTest) return;
  const std::optional<std::uint32_t> home = partition_.home(packet.key.ref);
  if (!home || !needed(packet, to, *home)) return;
  const accel::NodeKey key = key_here(packet);
  const bool subtree = treelet_triangles_ && machine_.accel.triangles_below(key) <= *treelet_triangles_;
  const std::size_t first = message.shapes.size();
  accel::pack_shapes(machine_.accel, key.ref, subtree, message.shapes);
  const std::size_t words = message.shapes.size() - first;
  message.guests.push_back({id, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(words)});
}

void ShapeTravel::enter(PacketId id, std::span<const std::uint64_t> shapes) {
  guests_.at(id.value) = machine_.accel.guests->enter(id.value, shapes);
}

}  // namespace carousel::ringbus
