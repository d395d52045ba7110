#include "ringbus/cycle/fabric/hub.h"

#include <utility>

#include "ringbus/cycle/fabric/bus.h"
#include "ringbus/cycle/fabric/router.h"

namespace carousel::ringbus::cycle {

std::unique_ptr<Hub> make_hub(std::uint32_t hub, const Topology& topology, std::span<const Packet> packets,
                              std::vector<InPort> in, std::vector<OutPort> out) {
  // The agent of a ring whose stops have no queues is not of the fabric (rings/ring_hub.h).
  if (topology.hubs()[hub] == Topology::Hub::kBus)
    return std::make_unique<Bus>(topology, packets, std::move(in), std::move(out));
  return std::make_unique<Router>(ResourceId(static_cast<std::uint32_t>(topology.resources()) + hub), topology,
                                  std::move(in), std::move(out));
}

}  // namespace carousel::ringbus::cycle
