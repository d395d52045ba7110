#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

#include "core/config/fields/collections.h"
#include "core/config/fields/packets.h"
#include "core/config/fields/topology.h"
#include "ringbus/cycle/shapes/shape_memory.h"
#include "ringbus/packets/packet.h"
#include "ringbus/resource/collections/issue_policy.h"
#include "ringbus/resource/traversal/make_traversal.h"

namespace carousel::ringbus::cycle {

/// A packet on a link, with all that goes along with it: its bytes, and the cycles for which it occupies the link; how
/// many packets it is, and how many messages go before it.
struct PacketLoad {
  std::uint32_t bytes = 0;
  std::uint32_t cycles = 0;
  std::uint32_t packets = 1, messages = 0;

  /// `count` more packets or messages of `each` bytes, each of which begins a cycle of a link of that width.
  void add(std::uint32_t each, std::uint32_t count, std::uint32_t width) {
    bytes += each * count;
    cycles += (each + width - 1) / width * count;
  }
};

/// Bytes of a packet on a link, as hardware would lay it out:
///   header 16: node key 8, owner 2, home 2, count 2, depth 1, kind and lanes 1
///   per ray: ID 4; and of a strip of boxes a result bit a shape (1 byte; with `shapes: single` 1 bit), or with ordered
///   traversal the next node 12 (key 8, entry 4)
///   per shape of a strip of boxes: nearest entry 4, for policies that read them (with `shapes: single` of the one)
///   per ray and child of a treelet of the whole tree that it goes on to at once: its member 1, the node's key 8, and
///   the entry 4, for policies that read them; per group of rays at another treelet: key 8, depth 1, count 1
///   per new ray that looks for a slot: its record 64; with addressed placement its address 2
///   with `carry: data` the shapes that are tested (ShapeMemory::shapes()), and below an instance what is stored of its
///   transform, or the records of Gaussians around which the triangles stand
/// With other `packets.results`:
///   per_shape: no results until the first resource with rays of it has tested a strip of boxes; from then on a packet
///   for each shape, with all IDs, a bit a ray, the shape's entry and its part of the data
///   message: no results; before the packet go messages, one for each shape hit by a ray that its owner does not have:
///   header 16, ID 4, and the entry 4 or the next node 12
///   implied_order: the packet's number 2; an entry is a ray's ID or, once the ray has been tested, its result in the
///   ID's place, which a bit a ray tells apart. Rays of bundles that were taken apart bring both.
class PacketSize {
 public:
  PacketSize(const CollectionsConfig& collections, const PacketsConfig& packets, const LinkConfig& link,
             const RayIdLayout& layout)
      : ordered_(one_collection_a_ray(collections.traversal)),
        entries_(issue_policy(collections.policy).reads_entries),
        data_(packets.carry == PacketCarry::kData),
        results_(packets.results),
        ids_per_cycle_(static_cast<std::uint32_t>(packets.ids_per_cycle)),
        width_(static_cast<std::uint32_t>(link.bytes_per_cycle)),
        layout_(layout) {}

  /// True if the size of a packet depends on how far its tests are.
  bool results_grow() const { return results_ != PacketResults::kMask; }

  PacketLoad load(const Packet& packet, const ShapeMemory& memory, bool treelet) const {
    PacketLoad load;
    const auto n = static_cast<std::uint32_t>(packet.members.size());
    const bool test = packet.kind == PacketKind::kTest;
    const bool brings = test && data_ && !treelet;
    const std::uint32_t data = brings ? memory.shapes(packet.key, packet.lanes).bytes : 0;
    std::uint32_t transform = brings ? memory.transform(packet.key.instance).bytes : 0;
    if (brings)
      for (const ShapeSpan& record : memory.gaussians(packet.key, packet.lanes)) transform += record.bytes;
    if (const std::uint32_t parts = this->parts(packet, memory, treelet); parts > 0) {
      load.add(of_shape(n) + (data + parts - 1) / parts + transform, parts, width_);
      load.packets = parts;
      return load;
    }
    load.add(whole(packet, n, treelet) + data + transform, 1, width_);
    if (test && results_ == PacketResults::kMessage)
      load.add(message(), load.messages = messages(packet, packet, treelet), width_);
    return load;
  }
  /// The load of an answer to a packet that a resource has heard, with `rays` rays that live there: without the shapes.
  /// `answered` is the resource's copy of the packet, with their results.
  PacketLoad answer(const Packet& packet, const Packet& answered, std::uint32_t rays, const ShapeMemory& memory,
                    bool treelet) const {
    PacketLoad load;
    switch (results_) {
      case PacketResults::kMask:
        load.add(whole(packet, rays, treelet), 1, width_);
        break;
      case PacketResults::kPerShape:
        if (const std::uint32_t parts = this->parts(answered, memory, treelet); parts > 0)
          load.add(of_shape(rays), load.packets = parts, width_);
        else
          load.add(kHeader + kId * rays, 1, width_);
        break;
      case PacketResults::kMessage:
        load.add(kHeader, 1, width_);
        load.add(message(), load.messages = messages(packet, answered, treelet), width_);
        break;
      case PacketResults::kImpliedOrder:
        load.add(in_order(packet, answered.named, rays, treelet), 1, width_);
        break;
    }
    return load;
  }

  /// IDs and results that dispatch reads of a packet that goes round.
  std::uint32_t read_on_visit(const Packet& packet, const ShapeMemory& memory, bool treelet) const {
    const auto n = static_cast<std::uint32_t>(packet.members.size());
    if (packet.kind != PacketKind::kTest || !results_grow()) return n;
    if (results_ == PacketResults::kImpliedOrder) return ids(packet);
    return in_parts(n, parts(packet, memory, treelet));
  }
  /// ... and of one that retires, with the messages before it; on a bus those were read with the answers.
  std::uint32_t read_at_owner(const Packet& packet, const ShapeMemory& memory, bool treelet, bool bus) const {
    const auto n = static_cast<std::uint32_t>(packet.members.size());
    if (packet.kind != PacketKind::kTest || !results_grow()) return n;
    if (results_ == PacketResults::kMessage && !bus) return n + ids_per_cycle_ * messages(packet, packet, treelet);
    return in_parts(n, parts(packet, memory, treelet));
  }
  /// ... and of an answer.
  std::uint32_t read_of_answer(const Packet& packet, const Packet& answered, std::uint32_t rays,
                               const ShapeMemory& memory, bool treelet) const {
    if (results_ == PacketResults::kMessage) return ids_per_cycle_ * messages(packet, answered, treelet);
    return in_parts(rays, results_ == PacketResults::kPerShape ? parts(answered, memory, treelet) : 0);
  }

 private:
  static constexpr std::uint32_t kHeader = 16, kId = 4, kEntry = 4, kNext = 12, kNumber = 2, kExit = 9, kGroup = 10;

  bool has_boxes(const Packet& packet, bool treelet) const { return packet.key.ref.is_inner() && !treelet; }
  std::uint32_t entry_bytes() const { return entries_ ? kEntry : 0; }
  /// One packet of those that a strip's has become.
  std::uint32_t of_shape(std::uint32_t n) const { return kHeader + kId * n + (n + 7) / 8 + entry_bytes(); }
  std::uint32_t message() const { return kHeader + kId + (ordered_ ? kNext : entry_bytes()); }

  /// Packets that a packet has become, one a shape; 0 while it is one for all of them.
  std::uint32_t parts(const Packet& packet, const ShapeMemory& memory, bool treelet) const {
    if (results_ != PacketResults::kPerShape || packet.kind != PacketKind::kTest || packet.answered == 0) return 0;
    return has_boxes(packet, treelet) ? memory.boxes(packet.key, packet.lanes) : 0;
  }
  /// Entries of `parts` packets, each of which takes whole cycles.
  std::uint32_t in_parts(std::uint32_t n, std::uint32_t parts) const {
    if (parts == 0) return n;
    return parts * std::max(1u, (n + ids_per_cycle_ - 1) / ids_per_cycle_) * ids_per_cycle_;
  }
  static std::uint32_t ids(const Packet& packet) {
    return static_cast<std::uint32_t>(packet.members.size()) - packet.answered + packet.named;
  }
  /// A single packet with `n` of its rays, without shapes.
  std::uint32_t whole(const Packet& packet, std::uint32_t n, bool treelet) const {
    if (packet.kind == PacketKind::kTest && results_ == PacketResults::kImpliedOrder)
      return in_order(packet, ids(packet), packet.answered, treelet);
    std::uint32_t bytes = kHeader + kId * n;
    if (packet.kind == PacketKind::kRays)
      bytes += static_cast<std::uint32_t>(sizeof(RayRecord) * packet.requests.size() + 2 * packet.addresses.size());
    if (packet.kind != PacketKind::kTest || results_grow()) return bytes;
    bytes += kGroup * static_cast<std::uint32_t>(packet.groups.size());
    if (ordered_)
      bytes += kNext * n;
    else if (treelet)
      bytes += (kExit + entry_bytes()) * static_cast<std::uint32_t>(packet.exits.size());
    else if (has_boxes(packet, treelet))
      bytes += box_results(packet, n);
    return bytes;
  }
  /// Bytes of the results of `rays` rays with the boxes of a strip, or with the one that the packet has in single-shape
  /// mode.
  std::uint32_t box_results(const Packet& packet, std::uint32_t rays) const {
    const bool one = std::popcount(packet.lanes) == 1;
    return one ? (rays + 7) / 8 + entry_bytes() : rays + entry_bytes() * accel::kMaxWidth;
  }
  /// A packet in which results stand in the places of IDs.
  std::uint32_t in_order(const Packet& packet, std::uint32_t ids, std::uint32_t results, bool treelet) const {
    const bool boxes = !ordered_ && has_boxes(packet, treelet);
    return kHeader + kNumber + (ids + results + 7) / 8 + kId * ids +
           (ordered_ ? kNext * results
            : boxes  ? box_results(packet, results)
                     : 0);
  }
  /// The hits in `answered` that the owner of the packet learns by messages: those of rays that it does not have.
  std::uint32_t messages(const Packet& packet, const Packet& answered, bool treelet) const {
    std::uint32_t count = 0;
    if (!ordered_ && !has_boxes(packet, treelet)) return 0;
    for (std::size_t i = 0; i < answered.members.size(); ++i) {
      if (layout_.owner(answered.members[i].ray) == packet.owner) continue;
      count += ordered_ ? std::uint32_t{answered.next[i].any}
                        : static_cast<std::uint32_t>(std::popcount(answered.members[i].mask));
    }
    return count;
  }

  bool ordered_, entries_, data_;
  PacketResults results_;
  std::uint32_t ids_per_cycle_, width_;
  RayIdLayout layout_;
};

}  // namespace carousel::ringbus::cycle
