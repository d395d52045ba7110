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

/// A ray, seen from a packet: its ID and what the strip answered. `mask` has bit l set when lane l was hit.
struct PacketMember {
  RayId ray;
  std::uint8_t mask = 0;
};

/// Where an ordered ray goes next, written into the packet by the ray's owner.
struct NextNode {
  accel::NodeKey key;
  float entry = 0;
  std::uint16_t depth = 0;
  bool any = false;  ///< false: the ray is complete
};

/// A moving collection. It belongs to one resource, is allocated once, and is written by whoever holds it: the
/// link's queue passes the right to write along with the index.
struct Packet {
  PacketKind kind = PacketKind::kTest;
  ResourceId owner, home;
  accel::NodeKey key;
  std::uint32_t lanes = ~0u;          ///< shapes of the strip to test; one bit in single-shape mode
  std::uint16_t depth = 0;            ///< of `key`, in strips below the root
  std::uint16_t direction = 0;        ///< which of the ring's directions it travels
  std::uint32_t hops_left = 0;        ///< links to cross until it is back at its owner (rings)
  std::uint32_t reserved_blocks = 0;  ///< collection storage its retirement may need
  std::vector<PacketMember> members;
  float nearest[accel::kMaxWidth] = {};  ///< a lane: nearest entry of any member
  std::vector<NextNode> next;            ///< ordered traversal: one a member
  std::vector<RayRequest> requests;      ///< kRays: the rays not yet taken
  std::vector<ResourceId> addresses;     ///< kRays with addressed placement: one a request
  std::vector<std::uint64_t> owners;     ///< bit set of resources that own a member
};

}  // namespace carousel::ringbus
