#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/config/fields/topology.h"
#include "core/config/graph/graph.h"
#include "ringbus/cycle/fabric/hub.h"
#include "ringbus/cycle/rings/ring_fabric.h"

namespace carousel::ringbus::cycle {

/// A ring whose stops have no queues, in a machine of rays. It is one node of the network, to which each resource has a
/// wire of a cycle, and another one back: its port. A packet waits at the end of its wire until the rule of the stops
/// lets it on, and holds up those behind it. Where it gets off there is room for all packets there are, as at routers,
/// so that nothing on the ring waits for a resource; from there it goes on when its last flit has come.
///
/// A packet of F flits over h links, with nobody in its way and ports of p cycles a flit, is at its resource after
///     1 + (F p - 1 + h latency_cycles + p - 1) + 1
/// cycles with slots; with grants, RingShape::alone() stands in the middle.
class RingHub final : public Hub {
 public:
  /// `node`: its number. The ports of resources are in the order of these.
  RingHub(ResourceId node, const TopologyConfig& config, const Topology& topology, std::vector<InPort> in,
          std::vector<OutPort> out);
  ~RingHub() override;

  Cycle next() const override;
  void run(Cycle end) override;
  std::string describe() const override;

  const config::Graph& graph() const { return graph_; }
  /// By link of the graph, in cycles of the ring.
  const RingLinks& links() const { return fabric_->links(); }
  const StopRingUse& use() const { return fabric_->use(); }

 private:
  class Dock;

  void step(Cycle now);
  std::uint32_t keep(const Token& token);

  ResourceId node_;
  const Topology& topology_;
  TopologyConfig config_;  // of which graph and shape keep parts
  config::Graph graph_;
  RingShape shape_;
  std::vector<std::uint32_t> places_;  // stops, by resource
  std::vector<Token> tokens_;          // of packets on the ring, by tag
  std::vector<std::uint32_t> unused_;  // tags
  std::vector<std::unique_ptr<Dock>> docks_;
  std::unique_ptr<RingFabric> fabric_;
  std::uint32_t turn_ = 0;  // packets so far, by which equally long ways take turns
  Cycle now_ = 0;
};

}  // namespace carousel::ringbus::cycle
