#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "accel/structure/accel.h"
#include "core/config/config.h"
#include "ringbus/protocol/machine.h"
#include "ringbus/ranks/rank_message.h"

namespace carousel::ringbus {

/// With `scene.placement: partitioned`: what packets bring along from rank to rank. A packet starts where its shape is
/// (Homes), and its rays are everywhere; so the shape's data go with it, and the rays stay.
class ShapeTravel {
 public:
  /// Keeps references. Preconditions: the structure is partitioned.
  ShapeTravel(const Config& config, const Machine& machine);

  /// Adds the shape of a packet that goes to resource `to` of another rank to the message, unless no rank from there on
  /// needs it.
  void take_along(PacketId id, const Packet& packet, ResourceId to, RankMessage& message) const;
  /// The shapes of a packet from another rank, before the packet arrives.
  void enter(PacketId id, std::span<const std::uint64_t> shapes);
  /// The key at this rank of the shape that a packet names, for a test.
  accel::NodeKey key_here(const Packet& packet) const;
  /// Memory that guests have taken.
  std::uint64_t guest_bytes() const { return machine_.accel.guests->bytes(); }

 private:
  bool needed(const Packet& packet, ResourceId from, std::uint32_t home) const;

  const Machine& machine_;
  const accel::Partition& partition_;
  std::optional<std::uint64_t> treelet_triangles_;
  std::vector<accel::NodeRef> guests_;  // by packet; the same threads touch one as touch the packet
};

}  // namespace carousel::ringbus
