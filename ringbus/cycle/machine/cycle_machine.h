#pragma once

#include <memory>
#include <vector>

#include "accel/structure/accel.h"
#include "core/config/config.h"
#include "ringbus/cycle/memory/shape_memory.h"
#include "ringbus/cycle/time/clock.h"
#include "ringbus/protocol/packet_pool.h"
#include "ringbus/rays/ray_control.h"
#include "ringbus/topology/topology.h"

namespace carousel::ringbus::cycle {

/// What the agents of a simulated machine share: the packets, which belong to whoever holds their ID, and the ray
/// records, which belong to their owners.
struct CycleMachine {
  CycleMachine(const Config& config, const accel::Accel& accel, float scene_size);

  Packet& packet(PacketId id) { return packets[id.value]; }
  /// Packets of a resource and direction.
  std::uint32_t packets_per_direction() const;
  /// Whether packets are tested where they are issued and never travel.
  bool stays() const { return topology.resources() == 1 || config.collections.home == Home::kLocal; }

  /// Whether resources ask shader workers what lets rays through.
  bool calls_shader() const {
    return accel.calls_any_hit() && config.testers.any_hit == TestersConfig::AnyHit::kShader;
  }

  const Config& config;
  const accel::Accel& accel;
  Topology topology;
  ShapeMemory memory;
  std::vector<Packet> packets;                    ///< by owner, then direction
  std::vector<std::unique_ptr<RayStore>> stores;  ///< by resource
  RayControl control;
};

/// From ray control and shading to a resource and back: wires of their own, as long as a hop.
Cycle control_latency(const Config& config);

}  // namespace carousel::ringbus::cycle
