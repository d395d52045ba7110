#include "ringbus/cycle/fabric/hub.h"

#include <utility>

#include "ringbus/cycle/fabric/bus.h"
#include "ringbus/cycle/fabric/router.h"

namespace carousel::ringbus::cycle {

std::unique_ptr<Hub> make_hub(std::uint32_t hub, const Topology& topology, std::span<const Packet> packets,
                              std::vector<InPort> in, std::vector<OutPort> out) {
  switch (topology.hubs()[hub]) {
    case Topology::Hub::kBus:
      return std::make_unique<Bus>(topology, packets, std::move(in), std::move(out));
    case Topology::Hub::kRouter:
      return std::make_unique<Router>(ResourceId(static_cast<std::uint32_t>(topology.resources()) + hub), topology,
                                      std::move(in), std::move(out));
    case Topology::Hub::kRing:  // its agent is not of the fabric (rings/ring_hub.h)
    case Topology::Hub::kBridge:
      break;
  }
  return std::make_unique<Bridge>(hub, topology, packets, std::move(in), std::move(out));
}

}  // namespace carousel::ringbus::cycle
