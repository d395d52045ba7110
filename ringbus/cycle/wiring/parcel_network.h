#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/config/fields/memory.h"
#include "ringbus/cycle/messages/side_ports.h"
#include "ringbus/cycle/parcels/line_turns.h"
#include "ringbus/cycle/parcels/parcel_plan.h"
#include "ringbus/cycle/parcels/relay.h"
#include "ringbus/cycle/parcels/shared_link.h"
#include "ringbus/cycle/wiring/agent_numbers.h"
#include "ringbus/cycle/wiring/memory_system.h"
#include "ringbus/cycle/wiring/network.h"

namespace carousel::ringbus::cycle {

/// The relays and links of a machine whose links carry more than packets, and their doors to its parts.
class ParcelNetwork {
 public:
  /// The wires of the topology that packets share with others, with the numbers of their agents.
  static Network::SharedWires shared_wires(const ParcelPlan& plan, const AgentNumbers& agents);

  /// Keeps references to the plan and the topology, but not to the rest.
  ParcelNetwork(ChannelList& list, const ParcelPlan& plan, const AgentNumbers& agents, const Topology& topology,
                const Network& network, const LinkConfig& link, const MemoryConfig& memory);

  /// The ends of a resource's channels, of which `side` has those beside the links: what is drawn goes over links.
  struct Sides {
    SidePorts resource, shading;
  };
  Sides join(std::uint32_t resource, const SidePorts& side);
  /// The far ends of what resources send to drawn caches, and these to drawn memories. Once.
  DrawnAskers askers();
  /// The near ends of what caches send. Once, with the system that was made for askers().
  void join(const MemorySystem& memory);

  const ParcelPlan& plan() const { return plan_; }
  const std::vector<std::unique_ptr<Relay>>& relays() const { return relays_; }
  const std::vector<std::unique_ptr<SharedLink>>& shared_links() const { return shared_; }
  /// The longest way of a resource's requests over links to its caches and on to memory, and back.
  Cycle way_to_memory(std::uint32_t resource) const;
  /// Agents over which messages travel.
  std::vector<Agent*> agents() const;
  /// Each by its own clock. Before the start.
  void run_by_clocks() const;
  /// Nothing has happened on the links since, by the clock of the resources.
  Cycle quiet_from() const;
  /// The use of a link of the plan by its number there.
  const LinkTime& time_of(std::size_t link) const { return *times_[link]; }
  /// From now on it is read over time, at most so often.
  void sample(std::size_t most);
  void close(Cycle end) const;

 private:
  static constexpr std::uint32_t kShapeDoor = 0, kRayDoor = 1;  // of a resource

  void make_links(const Network& network);
  std::vector<DoorPlace> cache_doors(std::uint32_t resource) const;
  LineTurns turns(const config::Banks& banks) const;
  /// Makes a channel from the links to a part, or back.
  template <class T>
  Channel<T>& channel(std::vector<std::unique_ptr<Channel<T>>>& into, MessageKind kind, const ChannelEnds& ends) {
    return *into.emplace_back(std::make_unique<Channel<T>>(list_.at(kind, ends)));
  }
  void add_cache(std::size_t cache, std::size_t group, std::size_t bank, DrawnAskers& out);
  std::size_t askers_of(std::size_t group) const;

  ChannelList& list_;
  const ParcelPlan& plan_;
  AgentNumbers numbers_;
  const Topology& topology_;
  MachineClocks clocks_;
  MemoryConfig memory_;
  std::uint64_t line_bytes_;
  ParcelRoutes routes_;
  MessageKind over_links_, at_ends_, requests_at_ends_, lines_at_ends_;
  std::optional<MessageKind> to_shared_links_;
  std::vector<std::unique_ptr<Channel<Parcel>>> links_;      // by link of the plan: to the node at its end
  std::vector<std::unique_ptr<Channel<Parcel>>> to_shared_;  // likewise; null unless packets share it
  std::vector<std::unique_ptr<Relay>> relays_;               // by node of the graph
  std::vector<std::unique_ptr<SharedLink>> shared_;
  std::vector<LinkTime*> times_;  // by link of the plan; of relays' ports and of shared_
  std::vector<std::unique_ptr<Channel<NewRays>>> new_rays_;
  std::vector<std::unique_ptr<Channel<CompletedRays>>> completed_;
  std::vector<std::unique_ptr<Channel<FetchRequest>>> requests_;
  std::vector<std::unique_ptr<Channel<FetchAnswer>>> answers_;
  std::vector<std::unique_ptr<Channel<std::uint64_t>>> lines_;
};

}  // namespace carousel::ringbus::cycle
