#include "ringbus/cycle/wiring/parcel_network.h"

#include <algorithm>
#include <utility>

#include "ringbus/cycle/parcels/fetch_doors.h"
#include "ringbus/cycle/parcels/line_doors.h"
#include "ringbus/cycle/parcels/ray_door.h"

namespace carousel::ringbus::cycle {

using config::Banks;
using config::Graph;

Network::SharedWires ParcelNetwork::shared_wires(const ParcelPlan& plan, const AgentNumbers& agents) {
  Network::SharedWires out;
  for (const ParcelPlan::Link& link : plan.links)
    if (link.wire != ParcelPlan::kNone) out.emplace(link.wire, agents.shared_link(out.size()));
  return out;
}

ParcelNetwork::ParcelNetwork(ChannelList& list, const ParcelPlan& plan, const AgentNumbers& agents,
                             const Topology& topology, const Network& network, const LinkConfig& link,
                             const MemoryConfig& memory)
    : list_(list),
      plan_(plan),
      numbers_(agents),
      topology_(topology),
      clocks_(network.clocks()),
      memory_(memory),
      line_bytes_(fetched_bytes(memory)),
      routes_(plan),
      over_links_(list.carry(
          {"messages on links", "nodes", "neighbours", "links", static_cast<std::uint64_t>(link.bytes_per_cycle)})),
      at_ends_(list.carry({"messages at ends of links", "nodes", "parts", "links"})),
      requests_at_ends_(list.carry({"line requests at ends of links", "nodes", "parts", "links"}, kAddressBytes)),
      lines_at_ends_(list.carry({"lines at ends of links", "parts", "nodes", "links"}, line_bytes_)) {
  make_links(network);
}

void ParcelNetwork::make_links(const Network& network) {
  const Graph& graph = plan_.graph;
  std::vector<std::vector<ParcelPort>> out(graph.nodes.size());
  for (std::size_t i = 0; i < plan_.links.size(); ++i) {
    const Graph::Link& link = plan_.drawn(plan_.links[i]);
    const auto latency = static_cast<Cycle>(link.latency_cycles);
    const std::uint32_t from = numbers_.relay(link.from), to = numbers_.relay(link.to);
    const ClockRatio to_link = clocks_.between(plan_.mhz(link.from), link.mhz),
                     to_receiver = clocks_.between(link.mhz, plan_.mhz(link.to)),
                     from_core = clocks_.from_core(link.mhz);
    to_shared_.emplace_back();
    const std::uint32_t wire = plan_.links[i].wire;
    if (wire == ParcelPlan::kNone) {
      Channel<Parcel>& channel = this->channel(links_, over_links_, {from, to, latency});
      channel.cross(to_receiver, {});
      out[link.from].emplace_back(
          channel, latency, to_link,
          std::make_unique<LinkTime>(static_cast<std::uint64_t>(link.bytes_per_cycle), from_core));
      times_.push_back(out[link.from].back().time());
      continue;
    }
    const std::uint32_t agent = numbers_.shared_link(shared_.size());
    if (!to_shared_links_) to_shared_links_ = list_.carry({"messages to shared links", "nodes", "near ends", "links"});
    to_shared_.back() = std::make_unique<Channel<Parcel>>(list_.at(*to_shared_links_, {from, agent, 1}));
    Channel<Parcel>& channel =
        this->channel(links_, over_links_, {agent, to, SharedLink::far_latency(link.latency_cycles)});
    channel.cross(to_receiver, {});
    out[link.from].emplace_back(*to_shared_.back(), 1, to_link);
    shared_.push_back(std::make_unique<SharedLink>(
        topology_, wire, SharedLink::Ends{&network.near(wire), &network.far(wire), to_shared_.back().get(), &channel},
        from_core));
    times_.push_back(&shared_.back()->time());
  }
  for (std::uint32_t node = 0; node < graph.nodes.size(); ++node) {
    std::vector<Channel<Parcel>*> in;
    for (const std::uint32_t link : routes_.in(node)) in.push_back(links_[link].get());
    relays_.push_back(std::make_unique<Relay>(node, static_cast<Cycle>(graph.nodes[node].drawn->latency_cycles),
                                              routes_, std::move(in), std::move(out[node])));
  }
}

LineTurns ParcelNetwork::turns(const Banks& banks) const {
  return {banks.nodes.size(), static_cast<std::uint64_t>(banks.interleave_bytes) / line_bytes_};
}

ParcelNetwork::Sides ParcelNetwork::join(std::uint32_t resource, const SidePorts& side) {
  Sides out{side, side};
  const config::DrawnParts& parts = plan_.parts;
  if (!parts.pools.empty()) {
    const std::uint32_t shading = parts.pool_node(resource);
    if (parts.new_rays)
      out.resource.new_rays = &channel(new_rays_, at_ends_, {numbers_.relay(resource), resource, kDoorCycles, true});
    if (parts.completed_rays)
      out.shading.completed =
          &channel(completed_, at_ends_, {numbers_.relay(shading), numbers_.shading(), kDoorCycles, true});
    relays_[resource]->put_door(kRayDoor,
                                std::make_unique<RayDoor<CompletedRays, NewRays>>(
                                    parts.completed_rays ? side.completed : nullptr, Carried::kCompletedRays,
                                    DoorPlace{shading, resource}, parts.new_rays ? out.resource.new_rays : nullptr));
    relays_[shading]->put_door(
        resource, std::make_unique<RayDoor<NewRays, CompletedRays>>(
                      parts.new_rays ? side.new_rays : nullptr, Carried::kNewRays, DoorPlace{resource, kRayDoor},
                      parts.completed_rays ? out.shading.completed : nullptr));
  }
  if (numbers_.asks_over_links()) {
    const Banks& banks = parts.caches[parts.caches_of[resource]];
    relays_[resource]->put_door(kShapeDoor,
                                std::make_unique<FetchDoor>(CacheClient{side.fetch, side.fetched}, turns(banks),
                                                            cache_doors(resource), line_bytes_));
  }
  return out;
}

/// A resource's doors at its caches: at each, behind those of the resources before it.
std::vector<DoorPlace> ParcelNetwork::cache_doors(std::uint32_t resource) const {
  const std::vector<std::size_t>& of = plan_.parts.caches_of;
  const auto here = of.begin() + resource;
  const auto before = static_cast<std::uint32_t>(std::count(of.begin(), here, *here));
  std::vector<DoorPlace> out;
  for (const std::uint32_t node : plan_.parts.caches[*here].nodes) out.push_back({node, before});
  return out;
}

std::size_t ParcelNetwork::askers_of(std::size_t group) const {
  return static_cast<std::size_t>(std::ranges::count(plan_.parts.caches_of, group));
}

DrawnAskers ParcelNetwork::askers() {
  DrawnAskers out;
  std::size_t cache = 0;
  for (std::size_t group = 0; group < plan_.parts.caches.size(); ++group)
    for (std::size_t bank = 0; bank < plan_.parts.caches[group].nodes.size(); ++bank)
      add_cache(cache++, group, bank, out);
  const Banks& memories = plan_.parts.memories;
  for (std::size_t m = 0; m < memories.nodes.size(); ++m) {
    const std::uint32_t node = memories.nodes[m];
    std::vector<MemoryAgent::Client>& askers = out.memories.emplace_back(DrawnAskers::AtMemory{plan_.mhz(node)}).askers;
    std::uint32_t door = 0;
    for (std::size_t group = 0; group < plan_.parts.caches.size(); ++group)
      for (const std::uint32_t cache_node : plan_.parts.caches[group].nodes) {
        const std::uint32_t dram = numbers_.memory(m);
        Channel<std::uint64_t>& down = channel(lines_, requests_at_ends_, {numbers_.relay(node), dram, kDoorCycles});
        Channel<std::uint64_t>& up =
            channel(lines_, lines_at_ends_, {dram, numbers_.relay(node), MemoryAgent::answer_latency(memory_)});
        askers.push_back({&down, &up});
        relays_[node]->put_door(
            door++, std::make_unique<AnswerDoor>(LineEnds{&down, &up}, LineBank{turns(memories), m},
                                                 DoorPlace{cache_node, static_cast<std::uint32_t>(askers_of(group))},
                                                 line_bytes_));
      }
  }
  return out;
}

/// Doors to a cache for each resource that asks it; the door to memory comes behind them.
void ParcelNetwork::add_cache(std::size_t cache, std::size_t group, std::size_t bank, DrawnAskers& out) {
  const Banks& banks = plan_.parts.caches[group];
  const std::uint32_t node = banks.nodes[bank], relay = numbers_.relay(node), l2 = numbers_.cache(cache);
  const Cycle answer = ShapeCache::answer_latency(memory_);
  DrawnAskers::AtCache& at = out.caches.emplace_back();
  std::uint32_t door = 0;
  for (std::uint32_t r = 0; r < plan_.parts.caches_of.size(); ++r) {
    if (plan_.parts.caches_of[r] != group) continue;
    const DoorPlace asker{r, kShapeDoor};
    if (numbers_.own_caches > 0) {
      Channel<std::uint64_t>& down = channel(lines_, requests_at_ends_, {relay, l2, kDoorCycles});
      Channel<std::uint64_t>& up = channel(lines_, lines_at_ends_, {l2, relay, answer});
      at.own_caches.push_back({&down, &up});
      relays_[node]->put_door(
          door++, std::make_unique<AnswerDoor>(LineEnds{&down, &up}, LineBank{turns(banks), bank}, asker, line_bytes_));
    } else {
      const CacheClient ends{&channel(requests_, at_ends_, {relay, l2, kDoorCycles}),
                             &channel(answers_, at_ends_, {l2, relay, answer})};
      at.resources.push_back(ends);
      relays_[node]->put_door(door++, std::make_unique<CacheDoor>(ends, asker));
    }
  }
}

void ParcelNetwork::join(const MemorySystem& memory) {
  const config::DrawnParts& parts = plan_.parts;
  const std::vector<MemoryAgent::Client> own = memory.own_to_l2(), down = memory.to_memory();
  for (std::uint32_t r = 0; numbers_.caches_drawn && r < own.size(); ++r) {
    const Banks& banks = parts.caches[parts.caches_of[r]];
    relays_[r]->put_door(kShapeDoor, std::make_unique<AskDoor>(LineEnds{own[r].requests, own[r].answers}, LineBank{},
                                                               turns(banks), cache_doors(r), line_bytes_));
  }
  std::uint32_t cache = 0;
  for (std::size_t group = 0; numbers_.memories_drawn && group < parts.caches.size(); ++group)
    for (std::size_t bank = 0; bank < parts.caches[group].nodes.size(); ++bank, ++cache) {
      std::vector<DoorPlace> doors;
      for (const std::uint32_t node : parts.memories.nodes) doors.push_back({node, cache});
      relays_[parts.caches[group].nodes[bank]]->put_door(
          static_cast<std::uint32_t>(askers_of(group)),
          std::make_unique<AskDoor>(LineEnds{down[cache].requests, down[cache].answers},
                                    LineBank{turns(parts.caches[group]), bank}, turns(parts.memories), std::move(doors),
                                    line_bytes_));
    }
}

Cycle ParcelNetwork::way_to_memory(std::uint32_t resource) const {
  if (plan_.parts.caches.empty()) return 0;
  if (const auto& of = plan_.graph.manager_of; !of.empty() && of[resource] == resource) return 0;  // it reads no shapes
  const auto there_and_back = [this](std::uint32_t from, std::uint32_t to) {
    return routes_.cycles(Carried::kShapes, from, to) + routes_.cycles(Carried::kShapes, to, from) + 2 * kDoorCycles;
  };
  Cycle longest = 0;
  for (const std::uint32_t cache : plan_.parts.caches[plan_.parts.caches_of[resource]].nodes) {
    Cycle behind = 0;
    for (const std::uint32_t memory : plan_.parts.memories.nodes)
      behind = std::max(behind, there_and_back(cache, memory));
    longest = std::max(longest, there_and_back(resource, cache) + behind);
  }
  return longest;
}

std::vector<Agent*> ParcelNetwork::agents() const {
  std::vector<Agent*> out;
  for (const auto& relay : relays_) out.push_back(relay.get());
  for (const auto& link : shared_) out.push_back(link.get());
  return out;
}

void ParcelNetwork::run_by_clocks() const {
  for (std::uint32_t node = 0; node < relays_.size(); ++node)
    relays_[node]->run_by(clocks_.to_fastest(plan_.mhz(node)));
  std::size_t shared = 0;
  for (const ParcelPlan::Link& link : plan_.links)
    if (link.wire != ParcelPlan::kNone) shared_[shared++]->run_by(clocks_.to_fastest(plan_.drawn(link).mhz));
}

Cycle ParcelNetwork::quiet_from() const {
  Cycle last = 0;
  for (std::uint32_t node = 0; node < relays_.size(); ++node)
    last = std::max(last, clocks_.from_core(plan_.mhz(node)).to_core(relays_[node]->last_step()));
  return last;
}

void ParcelNetwork::sample(std::size_t most) {
  for (LinkTime* time : times_) time->sample(most);
}

void ParcelNetwork::close(Cycle end) const {
  for (LinkTime* time : times_) time->close(end);
}

}  // namespace carousel::ringbus::cycle
