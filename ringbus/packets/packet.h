#pragma once

#include <cstdint>
#include <vector>

#include "accel/structure/node.h"
#include "core/types/ids.h"
#include "core/types/workload.h"
#include "ringbus/rays/ray_id.h"

namespace carousel::ringbus {

using PacketId = Id<struct PacketTag>;

enum class PacketKind : std::uint8_t {
  kTest,         ///< rays to be tested against the strip of `key`
  kMemberships,  ///< rays on their way to the collection of `key` at resource `home`
  kRays,         ///< new rays with their data, looking for slots
};

/// A ray of a packet: its ID and the strip's answer. Bit l of `mask` is set when it hit lane l. `again`: it has not
/// been tested and comes to the same strip once more. `joined`: the low half of the cycle in which it joined the
/// collection that the packet was made of; 0 in engines without a clock.
struct PacketMember {
  RayId ray;
  std::uint8_t mask = 0;
  bool again = false;
  std::uint32_t joined = 0;
};

/// The node that an ordered ray visits next. The ray's owner writes it into the packet.
struct NextNode {
  accel::NodeKey key;
  float entry = 0;
  std::uint16_t depth = 0;
  bool any = false;  ///< false: the ray is complete
};

/// A child outside a treelet, to which a member of its packet goes on. The ray's owner writes it into the packet.
struct PacketExit {
  std::uint32_t member = 0;
  NextNode next;
};

/// Members from `first` on that are at another treelet than those before them (`collections.grouped`).
struct PacketGroup {
  std::uint32_t first = 0;
  std::uint16_t depth = 0;
  accel::NodeKey key;
};

/// A moving collection. It belongs to one resource, is allocated once, and is written only by the resource that has
/// its index: the link's queue passes the right to write along with the index.
struct Packet {
  PacketKind kind = PacketKind::kTest;
  ResourceId owner, home;
  accel::NodeKey key;
  std::uint32_t lanes = ~0u;          ///< shapes of the strip to test; one bit in single-shape mode
  std::uint16_t depth = 0;            ///< depth of `key`, in strips below the root
  std::uint16_t direction = 0;        ///< that it travels round the ring
  std::uint32_t hops_left = 0;        ///< links to cross until it is back at its owner (rings)
  std::uint32_t reserved_blocks = 0;  ///< collection blocks that its retirement may take
  std::uint32_t answered = 0;         ///< members that have been tested (with `packets.results` other than mask)
  std::uint32_t named = 0;            ///< ... of them, those that tests have added: rays of bundles taken apart
  bool takes_reserve = false;         ///< they are of the reserve: its retirement must not lengthen its own collection
  std::vector<PacketMember> members;
  float nearest[accel::kMaxWidth] = {};  ///< by lane: the nearest entry of any member
  std::vector<NextNode> next;            ///< one a member, where the traversal writes it
  std::vector<PacketExit> exits;         ///< where rays leave treelets of the whole tree for all children at once
  std::vector<PacketGroup> groups;       ///< behind the members at `key`, in order; empty: all are there
  std::vector<RayRequest> requests;      ///< kRays: the rays not yet taken
  std::vector<ResourceId> addresses;     ///< kRays with addressed placement: one a request
  std::vector<std::uint64_t> owners;     ///< a bit for each resource that owns a member

  /// The treelet at which a member is.
  PacketGroup place_of(std::size_t member) const {
    PacketGroup out{0, depth, key};
    for (const PacketGroup& group : groups)
      if (group.first <= member) out = group;
    return out;
  }
};

}  // namespace carousel::ringbus
