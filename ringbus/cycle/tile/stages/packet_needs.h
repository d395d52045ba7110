#pragma once

#include <algorithm>
#include <cstddef>

#include "ringbus/cycle/fabric/packet_size.h"
#include "ringbus/cycle/shapes/shape_blocks.h"
#include "ringbus/cycle/shapes/shape_buffer.h"
#include "ringbus/cycle/shapes/shape_memory.h"
#include "ringbus/resource/resource.h"

namespace carousel::ringbus::cycle {

/// The needs of a packet at a resource: the shapes of its tests, and the number of its entries that dispatch reads.
class PacketNeeds {
 public:
  /// Keeps references. `blocks`: by which collections are keyed; null: by nodes. `two_outputs`: results of primitives
  /// go past the collections (US 9633468). `broadcasts`: packets are heard, and their results come as answers.
  PacketNeeds(const PacketSize& size, const ShapeMemory& memory, const ShapeBlocks* blocks, const Resource& resource,
              bool two_outputs, bool broadcasts)
      : size_(size),
        memory_(memory),
        blocks_(blocks),
        resource_(resource),
        two_outputs_(two_outputs),
        broadcasts_(broadcasts) {}

  /// The shapes of a packet's tests, what is stored of their instance's transform, and records of Gaussians.
  ShapeNeed shapes(const Packet& packet, bool transform) const {
    return {loads_treelets()     ? memory_.treelet(packet.key.ref)
            : blocks_ != nullptr ? blocks_->span(packet.key.ref)
            : is_treelet(packet) ? memory_.strip(packet.key)
                                 : memory_.shapes(packet.key, packet.lanes),
            transform || memory_.reads_record(packet.key) ? memory_.transform(packet.key.instance) : ShapeSpan{},
            is_treelet(packet) ? memory_.gaussians(packet.key) : memory_.gaussians(packet.key, packet.lanes)};
  }
  /// True if a visit loads a treelet of the whole tree.
  bool loads_treelets() const { return memory_.has_treelets(); }
  bool is_treelet(const Packet& packet) const { return resource_.is_treelet(packet.key); }

  /// Entries that dispatch reads of a packet on a visit, and of one that is back at its owner.
  std::size_t read_on_visit(const Packet& packet) const {
    return size_.read_on_visit(packet, memory_, is_treelet(packet));
  }
  std::size_t read_at_owner(const Packet& packet) const {
    // Rays that have met primitives go past the collections, unless they have other nodes to visit.
    if (two_outputs_ && !packet.key.ref.is_inner())
      return static_cast<std::size_t>(
          std::count_if(packet.next.begin(), packet.next.end(), [](const NextNode& next) { return next.any; }));
    return size_.read_at_owner(packet, memory_, is_treelet(packet), broadcasts_);
  }

  const PacketSize& size() const { return size_; }
  const ShapeMemory& memory() const { return memory_; }

 private:
  PacketSize size_;
  const ShapeMemory& memory_;
  const ShapeBlocks* blocks_;
  const Resource& resource_;
  bool two_outputs_, broadcasts_;
};

}  // namespace carousel::ringbus::cycle
