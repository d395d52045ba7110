#pragma once

#include <cstdint>

#include "core/config/config.h"
#include "ringbus/cycle/memory/shape_memory.h"
#include "ringbus/packets/packet.h"
#include "ringbus/resource/collections/issue_policy.h"
#include "ringbus/resource/traversal/make_traversal.h"

namespace carousel::ringbus::cycle {

/// Bytes of a packet on a link, as hardware would lay it out:
///   header 16: node key 8, owner 2, home 2, count 2, depth 1, kind and lanes 1
///   per ray: ID 4; and of a strip of boxes a result bit a shape (1 byte), or with ordered traversal the next
///   node 12 (key 8, entry 4)
///   per shape of a strip of boxes: nearest entry 4, for policies that read them
///   per new ray that looks for a slot: its record 64; with addressed placement its address 2
///   with `carry: data` the shapes that are tested (ShapeMemory::shapes()), and below an instance what is stored of its
///   transform
class PacketSize {
 public:
  PacketSize(const CollectionsConfig& collections, PacketCarry carry)
      : ordered_(one_collection_a_ray(collections.traversal)),
        entries_(issue_policy(collections.policy).reads_entries),
        data_(carry == PacketCarry::kData) {}

  std::uint32_t bytes(const Packet& packet, const ShapeMemory& memory, bool treelet) const {
    std::uint32_t bytes = answer_bytes(packet, static_cast<std::uint32_t>(packet.members.size()), treelet);
    if (packet.kind == PacketKind::kTest && data_ && !treelet)
      bytes += memory.shapes(packet.key, packet.lanes).bytes + memory.transform(packet.key.instance).bytes;
    return bytes;
  }
  /// Bytes of an answer with `rays` of the packet's rays: without the shapes.
  std::uint32_t answer_bytes(const Packet& packet, std::uint32_t rays, bool treelet) const {
    std::uint32_t bytes = 16 + 4 * rays;
    if (packet.kind == PacketKind::kRays)
      bytes += static_cast<std::uint32_t>(sizeof(RayRecord) * packet.requests.size() + 2 * packet.addresses.size());
    if (packet.kind != PacketKind::kTest) return bytes;
    if (ordered_)
      bytes += 12 * rays;
    else if (packet.key.ref.is_inner() && !treelet)
      bytes += rays + (entries_ ? 4 * accel::kMaxWidth : 0);
    return bytes;
  }

 private:
  bool ordered_, entries_, data_;
};

}  // namespace carousel::ringbus::cycle
