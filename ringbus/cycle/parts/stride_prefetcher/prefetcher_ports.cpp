#include "ringbus/cycle/parts/stride_prefetcher/prefetcher_ports.h"

#include "ringbus/cycle/messages/side_ports.h"
#include "ringbus/cycle/shapes/shape_cache.h"

namespace carousel::ringbus::cycle {

PrefetcherPorts::Kinds::Kinds(ChannelList& list, const LinkConfig& link)
    : hints(list.carry({"prefetch hints", "resources", StridePrefetcherPart::kName, "wires of hints",
                        static_cast<std::uint64_t>(link.bytes_per_cycle)})),
      requests(list.carry({"prefetch requests", StridePrefetcherPart::kName, "L2", "request wires",
                           static_cast<std::uint64_t>(link.bytes_per_cycle)})) {}

PrefetcherPorts::PrefetcherPorts(const Kinds& kinds, const PartSites& sites, const PartSite& site)
    : requests_(std::make_unique<Channel<FetchRequest>>(
          sites.list.at(kinds.requests, {site.agent, site.l2, control_latency(sites.link)}))),
      wire_(sites.link, control_latency(sites.link)) {
  for (const std::uint32_t resource : site.resources)
    hints_.push_back(std::make_unique<Channel<ShapeHint>>(
        sites.list.at(kinds.hints, {resource, site.agent, ShapeCache::request_latency(sites.memory)})));
}

AttachedPart<StridePrefetcherCounts> PrefetcherPorts::ends() const {
  AttachedPart<StridePrefetcherCounts> out;
  for (const auto& channel : hints_) out.hints.push_back(channel.get());
  out.ahead = requests_.get();
  return out;
}

}  // namespace carousel::ringbus::cycle
