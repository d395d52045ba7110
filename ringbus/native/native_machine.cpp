#include "ringbus/native/native_machine.h"

#include <algorithm>

namespace carousel::ringbus {

namespace {

/// Pieces go from producers to consumers, and empty ones back.
void require_both_ways(QueueKind kind, const char* key, std::size_t producers, std::size_t consumers) {
  const auto parties = [](std::size_t threads) { return threads > 1 ? Parties::kMany : Parties::kOne; };
  require_parties(kind, key, parties(producers), parties(consumers));
  require_parties(kind, key, parties(consumers), parties(producers));
}

}  // namespace

NativeMachine::NativeMachine(const Config& config, const accel::Accel& accel, float scene_size,
                             const LinkMaker& own_links, Transport* transport, std::size_t threads)
    : shared(config, accel, scene_size, std::nullopt,
             transport == nullptr ? RankShare()
                                  : RankShare(transport->rank(), transport->ranks(), config.topology.resources)),
      completed(config.shading.queue.kind, static_cast<std::size_t>(config.shading.queue.depth)) {
  // One resource sends on a wire and one receives, and one thread at a time plays a resource.
  require_parties(config.topology.link.queue, "topology.link.queue", Parties::kOne, Parties::kOne);
  const RankShare& share = shared.share;
  const std::size_t resources = share.alone() ? shared.topology.resources() : share.arc_size();
  const std::size_t workers = static_cast<std::size_t>(shader_workers(config));
  require_both_ways(config.shading.queue.kind, "shading.queue", std::min(threads, resources),
                    std::min(threads, workers));
  // Threads that submit rays take turns. Groups that waited for other ranks come from any thread.
  require_both_ways(config.rays.queue.kind, "rays.queue", share.alone() ? 1 : threads, 1);
  shared.control.queue_groups(config.rays.queue.kind, static_cast<std::size_t>(config.rays.queue.depth));
  if (!share.alone()) gate = std::make_unique<RankGate>(config, *transport, shared, completed);
  if (shared.topology.routed()) stops.resize(shared.packets.size());
  Config of_wire = config;  // the links of a graph may differ
  for (const Topology::Wire& wire : shared.topology.wires()) {
    if (wire.depth > 0) of_wire.topology.link.depth = wire.depth;
    of_wire.topology.link.queue = wire.queue.value_or(config.topology.link.queue);
    if (wire.queue) require_parties(*wire.queue, "topology.links.queue", Parties::kOne, Parties::kOne);
    if (gate && !gate->here(wire)) {
      links.push_back(gate->make_link(static_cast<std::uint32_t>(links.size()),
                                      static_cast<std::size_t>(config.topology.link.depth)));
      continue;
    }
    links.push_back(own_links ? own_links(of_wire, links.size(), wire.from, wire.to, shared.packets)
                              : make_link(of_wire, links.size(), wire.from, wire.to, shared.packets));
  }
}

}  // namespace carousel::ringbus
