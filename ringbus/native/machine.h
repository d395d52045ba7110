#pragma once

#include <memory>
#include <vector>

#include "accel/structure/accel.h"
#include "core/config/config.h"
#include "ringbus/native/completed_queue.h"
#include "ringbus/native/link.h"
#include "ringbus/packets/packet.h"
#include "ringbus/rays/ray_control.h"
#include "ringbus/topology/topology.h"

namespace carousel::ringbus {

/// What the native engine's resources share: the wires, the packets that travel on them, and the ways to and
/// from shading.
struct Machine {
  Machine(const Config& config, const accel::Accel& accel, float scene_size);

  Packet& packet(PacketId id) { return packets[id.value]; }

  const Config& config;
  const accel::Accel& accel;
  Topology topology;
  std::uint32_t packets_per_direction;            ///< of one resource
  std::vector<Packet> packets;                    ///< by owner, then direction
  std::vector<std::unique_ptr<Link>> links;       ///< as topology.wires()
  std::vector<std::unique_ptr<RayStore>> stores;  ///< by resource
  RayControl control;
  CompletedQueue completed;
};

}  // namespace carousel::ringbus
