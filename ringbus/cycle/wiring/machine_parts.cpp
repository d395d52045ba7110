#include "ringbus/cycle/wiring/machine_parts.h"

#include <tuple>

#include "ringbus/cycle/parts/stride_prefetcher/stride_prefetcher.h"

namespace carousel::ringbus::cycle {

MachineParts::MachineParts(ChannelList& list, const AgentNumbers& numbers, const PartKeys<Parts>& keys,
                           const MemoryConfig& memory, const LinkConfig& link, std::size_t resources)
    : hints_(resources), ahead_(numbers.caches) {
  Parts::for_each([&]<class P>(std::size_t) {
    if (!P::is_built(keys.of<P>())) return;
    PartSites sites{list, memory, link, {}};
    for (std::uint32_t c = 0; c < numbers.caches; ++c)
      sites.at.push_back({numbers.parts() + static_cast<std::uint32_t>(agents_.size()) + c, numbers.cache(c), {}});
    for (std::uint32_t r = 0; r < resources; ++r) sites.at[r / numbers.shared_by].resources.push_back(r);
    auto& parts = std::get<Attached<P>>(attached_);
    parts = attach(keys.of<P>(), sites);
    for (std::size_t c = 0; c < parts.size(); ++c) {
      agents_.push_back(parts[c].agent.get());
      if (parts[c].ahead != nullptr) ahead_[c].push_back(parts[c].ahead);
      for (std::size_t i = 0; i < parts[c].hints.size(); ++i)
        hints_[sites.at[c].resources[i]].push_back(parts[c].hints[i]);
    }
  });
}

PartCounts<Parts> MachineParts::counts() const {
  PartCounts<Parts> out;
  Parts::for_each([&]<class P>(std::size_t) {
    for (const auto& part : std::get<Attached<P>>(attached_))
      (out.of<P>() ? *out.of<P>() : out.of<P>().emplace()) += part.agent->counts();
  });
  return out;
}

}  // namespace carousel::ringbus::cycle
