#include "ringbus/cycle/wiring/machine_kinds.h"

namespace carousel::ringbus::cycle {

MachineKinds machine_kinds(ChannelList& list, const LinkConfig& link, const MemoryConfig& memory, bool ray_data,
                           const TestersConfig::Distributor* distributor, Traversal traversal) {
  const auto width = static_cast<std::uint64_t>(link.bytes_per_cycle);
  const ControlKinds control(list, width);
  const FetchKinds fetch(list, memory, width);
  const MemoryKinds lines(list, memory);
  const AnyHitKinds any_hit(list, width);
  const HelpKinds help(list, width);
  MachineKinds kinds{{control, fetch, any_hit, help}, lines};
  if (ray_data) kinds.ray_data.emplace(list, memory, width);
  if (memory.fetch == MemoryConfig::Fetch::kMulticast) kinds.side.pushed = pushed_kind(list, memory);
  if (distributor != nullptr) kinds.distributor.emplace(list, *distributor, traversal, width);
  if (memory.l1_kib > 0) kinds.own_caches.emplace(list, memory);
  return kinds;
}

}  // namespace carousel::ringbus::cycle
