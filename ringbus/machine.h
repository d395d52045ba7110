#pragma once

#include <memory>
#include <vector>

#include "accel/accel.h"
#include "core/config.h"
#include "ringbus/completed_queue.h"
#include "ringbus/link.h"
#include "ringbus/packet.h"
#include "ringbus/ray_control.h"
#include "ringbus/topology.h"

namespace carousel::ringbus {

/// What the native engine's resources share: the wires, the packets that travel on them, and the ways to and
/// from shading.
struct Machine {
  Machine(const Config& config, const accel::Accel& accel, float scene_size);

  Packet& packet(PacketId id) { return packets[id.value]; }

  const Config& config;
  const accel::Accel& accel;
  Topology topology;
  std::uint32_t packets_per_direction;   ///< of one resource
  std::vector<Packet> packets;           ///< by owner, then direction
  std::vector<std::unique_ptr<Link>> links;   ///< as topology.wires()
  std::vector<std::unique_ptr<RayStore>> stores;   ///< by resource
  RayControl control;
  CompletedQueue completed;
};

}  // namespace carousel::ringbus
