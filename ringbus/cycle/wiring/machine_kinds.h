#pragma once

#include <optional>

#include "ringbus/cycle/testers/distributor_kinds.h"
#include "ringbus/cycle/wiring/side_channels.h"

namespace carousel::ringbus::cycle {

/// The kinds of messages of a machine beside the packets on its links, in the order of the byte ledger.
struct MachineKinds {
  SideKinds side;
  MemoryKinds memory;
  std::optional<RayDataKinds> ray_data{};
  std::optional<DistributorKinds> distributor{};
  std::optional<OwnCacheKinds> own_caches{};
};

/// `ray_data`: ray control and shading have data in memory. `distributor`: null, unless the machine's testers stand
/// behind one.
MachineKinds machine_kinds(ChannelList& list, const LinkConfig& link, const MemoryConfig& memory, bool ray_data,
                           const TestersConfig::Distributor* distributor, Traversal traversal);

}  // namespace carousel::ringbus::cycle
