#pragma once

#include <memory>
#include <string>
#include <vector>

#include "accel/structure/accel.h"
#include "core/config/config.h"
#include "core/types/workload.h"
#include "ringbus/cycle/shading/shading_agent.h"
#include "ringbus/cycle/shapes/shape_blocks.h"
#include "ringbus/cycle/shapes/shape_memory.h"
#include "ringbus/cycle/tile/resource_agent.h"
#include "ringbus/cycle/wiring/agent_numbers.h"
#include "ringbus/cycle/wiring/machine_kinds.h"
#include "ringbus/cycle/wiring/machine_parts.h"
#include "ringbus/cycle/wiring/memory_system.h"
#include "ringbus/cycle/wiring/network.h"
#include "ringbus/cycle/wiring/parcel_network.h"
#include "ringbus/cycle/wiring/ray_data_channels.h"
#include "ringbus/cycle/wiring/recorder.h"
#include "ringbus/cycle/wiring/side_channels.h"
#include "ringbus/protocol/machine.h"
#include "ringbus/time/channel_list.h"

namespace carousel::ringbus::cycle {

/// A whole machine under virtual time: every agent, and the channels between them.
class SimulatedMachine {
 public:
  /// Keeps references to the structure and the workload.
  SimulatedMachine(const Config& config, const accel::Accel& accel, float scene_size, Workload& workload,
                   bool statistics, const Observation& observed);

  const Machine& shared() const { return shared_; }
  const Network& network() const { return network_; }
  const MemorySystem& memory() const { return *memory_; }
  /// Before the start.
  void warm(const WarmCaches& from);
  const ShapeMemory& shapes() const { return shape_memory_; }
  /// Null unless a timeline or the life of a ray is recorded.
  Recorder* recorder() const { return recorder_.get(); }
  /// Null unless the time of all rays is accounted for.
  const RayTimes* ray_times() const { return times_.get(); }
  const MachineParts& parts() const { return parts_; }
  const ShadingAgent& shading() const { return *shading_; }
  /// Null unless links carry more than packets.
  const ParcelNetwork* parcels() const { return parcels_.get(); }
  const std::vector<std::unique_ptr<ResourceAgent>>& resources() const { return resources_; }
  /// Every channel between two agents.
  const ChannelList& channels() const { return channels_; }
  const MachineKinds& kinds() const { return kinds_; }

  /// Shares the agents out over threads. Neighbours go to the same thread, and each cache to the thread of its
  /// resources; shading and memory go to the last thread.
  std::vector<std::vector<Agent*>> share_out(std::size_t threads) const;
  /// Announces all arrivals but those of credits, for which agents look when they need any.
  void connect(WakeupTable& wakeups) const;
  /// The least latency of any channel.
  Cycle lookahead() const { return channels_.least_latency(); }
  /// Every agent that waits for something, a line each, and the circle of waits if there is one; empty when all are at
  /// rest.
  std::string describe_waits() const;
  /// After close(), and when all else has been counted: caches write back all that they hold for memory.
  CacheDrain drain(Cycle end) const {
    return parcels_ ? memory_->drain(end, parcels_->agents(), parcels_->quiet_from()) : memory_->drain(end, {}, end);
  }
  /// The run is over at `end`: all agents make their last readings.
  void close(Cycle end) const;
  /// Calls `body` with each wire and the port by which it leaves its node.
  template <class Body>
  void for_each_link(const Body& body) const {
    const Topology& topology = shared_.topology;
    for (std::size_t i = 0; i < topology.wires().size(); ++i) body(topology.wires()[i], topology.out_port_of(i));
  }
  /// The near ends of the links that leave a node.
  const std::vector<OutPort>& out_of(ResourceId node) const {
    if (node.value < resources_.size()) return resources_[node.value]->out();
    return network_.hubs()[node.value - resources_.size()]->out();
  }

  /// What a link did until `end`, in cycles of the resources. `number`: its wire in the topology, which leaves its
  /// first node by `port`.
  LinkUse use_of_link(std::size_t number, std::size_t port, Cycle end) const;
  /// The cycles in which it has moved something so far.
  Cycle busy_of_link(std::size_t number, std::size_t port) const {
    const ResourceId from = shared_.topology.wires()[number].from;
    return network_.clocks().from_core(shared_.topology.mhz(from)).before(out_of(from)[port].busy());
  }

 private:
  ResourceId hub_node(std::uint32_t hub) const {
    return ResourceId(static_cast<std::uint32_t>(resources_.size()) + hub);
  }
  /// Calls `record` with each port of a node and where its packets are to be noted, if they are.
  template <class Record>
  void record_links(ResourceId node, const Record& record) {
    const auto& out = shared_.topology.ports(node).out;
    if (!recorder_ && !times_) return;
    // Behind a medium that brings a packet to several resources its way divides.
    const bool divided = shared_.topology.broadcasts() && node.value >= shared_.topology.resources();
    for (std::size_t port = 0; port < out.size(); ++port) {
      LinkRecorder to = recorder_ ? recorder_->of_link(node, out[port]) : LinkRecorder{};
      if (times_ && !divided) to.histories = &times_->histories();
      to.link = network_.clocks().from_core(shared_.topology.wires()[out[port]].mhz);
      record(port, to);
    }
  }

  Machine shared_;
  ShapeMemory shape_memory_;
  std::unique_ptr<const ShapeBlocks> shape_blocks_;  // null: collections are keyed by nodes
  ChannelList channels_;
  ParcelPlan plan_;
  AgentNumbers numbers_;
  Network network_;
  MachineKinds kinds_;
  MachineParts parts_;
  std::unique_ptr<ParcelNetwork> parcels_;                  // null: links carry packets alone
  std::vector<std::unique_ptr<SideChannels>> sides_;        // by resource
  std::vector<std::unique_ptr<RayDataChannels>> ray_data_;  // by L2
  std::vector<std::unique_ptr<ResourceAgent>> resources_;
  std::unique_ptr<Recorder> recorder_;  // null: nothing is recorded
  std::unique_ptr<RayTimes> times_;     // null: the rays' time is not accounted for
  std::unique_ptr<MemorySystem> memory_;
  std::unique_ptr<ShadingAgent> shading_;
};

}  // namespace carousel::ringbus::cycle
