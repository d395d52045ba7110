#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "accel/structure/accel.h"
#include "ringbus/packets/packet.h"
#include "ringbus/protocol/flow_rules.h"
#include "ringbus/rays/ray_control.h"
#include "ringbus/results/nearest_result.h"
#include "ringbus/topology/topology.h"

namespace carousel {
struct Config;
}

namespace carousel::ringbus {

/// The parts of a machine that its resources share, whatever engine runs it: the structure, the network, the packets,
/// each of which belongs to the holder of its ID, and the ray records, which belong to their owners. Parts that only
/// one engine needs (links, channels, simulated memory) stand beside it in that engine.
struct Machine {
  /// Keeps a reference to `accel`. `local_packets`: how many packets a resource needs in each direction where packets
  /// never travel; absent: as many as it may have under way elsewhere. `share`: the part that this process plays; it
  /// has the records of its own resources only, and a place for every packet, which is filled while the packet is here.
  Machine(const Config& config, const accel::Accel& accel, float scene_size,
          std::optional<std::uint32_t> local_packets = std::nullopt, const RankShare& share = {});

  Packet& packet(PacketId id) { return packets[id.value]; }
  const Packet& packet(PacketId id) const { return packets[id.value]; }
  /// With Topology::broadcasts(), the answer of resource `from` to a packet of another: its own rays of the packet. It
  /// writes the answer, and the packet's owner reads it when it has come.
  Packet& answer(ResourceId from, PacketId id) { return answers[from.value][id.value]; }
  /// The first of a resource's packets; they stand one after another, by direction.
  PacketId first_packet(ResourceId owner) const {
    return PacketId(owner.value * static_cast<std::uint32_t>(topology.directions()) * packets_per_direction);
  }

  /// Several pools of shader workers place rays, each those of its resources, in place of `control`: `pool_of` by
  /// resource. Before the first ray.
  void divide_control(const Config& config, float scene_size, const std::vector<std::size_t>& pool_of);
  /// What places the rays of a resource.
  const RayControl& control_of(ResourceId resource) const {
    return pools.empty() ? control : *pools[pool_of[resource.value]];
  }
  std::uint64_t slots_used() const;
  std::uint64_t slot_waits() const;

  /// What rays that look for several hits have found and cost, over all resources; absent if none does.
  std::optional<NearestResult> nearest() const;

  const accel::Accel& accel;
  RankShare share;
  Topology topology;
  FlowRules flow;
  bool home_local;                                ///< `collections.home: local`
  bool stays;                                     ///< packets are tested where they are issued and never travel
  bool own_rays_last;                             ///< `testers.own_rays: after`
  std::uint32_t packets_per_direction;            ///< packets that one resource has for each direction
  std::vector<Packet> packets;                    ///< by owner, then direction
  std::vector<std::vector<Packet>> answers;       ///< by resource, then packet
  std::vector<std::unique_ptr<RayStore>> stores;  ///< by resource
  RayControl control;
  std::vector<std::unique_ptr<RayControl>> pools;  ///< those of several pools of workers, in place of `control`
  std::vector<std::size_t> pool_of;                ///< likewise; by resource
};

}  // namespace carousel::ringbus
