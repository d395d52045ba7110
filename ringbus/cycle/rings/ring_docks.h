#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/config/graph/ring.h"
#include "ringbus/cycle/fabric/ports.h"
#include "ringbus/cycle/rings/ring_fabric.h"
#include "ringbus/topology/graph_facts.h"
#include "ringbus/topology/topology.h"

namespace carousel::ringbus::cycle {

/// A ring whose stops have no queues as one node of a network of packets T (Token, or those of synthetic traffic), to
/// which each node that stands at a stop has a wire of a cycle, and another one back: its port, which a packet keeps
/// busy for its bytes over the width of the port. A packet waits at the end of its wire until the rule of the stops
/// lets it on, and holds up those behind it. Where it gets off there is room for all packets there are, unless the node
/// is a router with few places; it goes on when its last flit has come.
template <class T>
class RingDocks {
 public:
  using In = InPortOf<T>;
  using Out = OutPortOf<T>;

  /// `node`: the number of the ring among those of the topology. Ports are those of its wires, and must outlive it, as
  /// the topology must. `bytes`: of a packet, where packets do not say.
  RingDocks(ResourceId node, const TopologyConfig& config, const Topology& topology, std::vector<In>& in,
            std::vector<Out>& out, std::array<Cycle, 2> window, std::uint32_t bytes)
      : topology_(topology),
        over_(*topology.ring(node)),
        out_(out),
        config_(config),
        graph_(draw_checked(config_)),
        shape_(config::stop_rings(config_, graph_)[topology.ring_number(node)]),
        bytes_(bytes),
        docks_(shape_.stops) {
    const Topology::Ports& ports = topology.ports(node);
    for (std::size_t port = 0; port < ports.in.size(); ++port) {
      const ResourceId stop = topology.wires()[ports.in[port]].from;
      docks_[over_.places[stop.value]].enter(*this, stop, in[port]);
    }
    for (std::size_t port = 0; port < ports.out.size(); ++port) {
      const Topology::Wire& wire = topology.wires()[ports.out[port]];
      docks_[over_.places[wire.to.value]].leave(out[port], wire.places > 0);
    }
    std::vector<RingEnd*> ends;
    for (Dock& dock : docks_) ends.push_back(&dock);
    fabric_ = make_ring(shape_, std::move(ends), RingLinks(graph_.links.size(), window));
  }
  RingDocks(const RingDocks&) = delete;
  RingDocks& operator=(const RingDocks&) = delete;

  Cycle next(Cycle now) const {
    Cycle first = fabric_->next();
    for (const Out& out : out_)
      if (const Cycle at = out.next(false); at > now) first = std::min(first, at);
    return first == kNever ? first : std::max(first, now + 1);
  }
  void step(Cycle now) {
    for (Out& out : out_) out.take_credits(now);
    if (fabric_->rides() || fabric_->next() <= now) fabric_->step(now);
    bool sent = false;
    for (Out& out : out_)
      while (out.send(now)) sent = true;
    if (sent) fabric_->look_again(now);
  }

  const config::Graph& graph() const { return graph_; }
  const RingShape& shape() const { return shape_; }
  const RingFabric& fabric() const { return *fabric_; }
  /// `number`: of the ring, for people.
  std::string describe(std::size_t number) const {
    std::size_t leaving = 0, waiting = 0;
    for (const Out& out : out_) leaving += out.egress();
    for (const Dock& dock : docks_) waiting += dock.due() != kNever;
    const std::size_t riding = tokens_.size() - unused_.size();
    if (leaving + waiting + riding == 0) return "";
    return fmt::format(
        "ring {}: {} packets ride, {} stops have packets that wait to get on, and {} packets wait to leave", number,
        riding, waiting, leaving);
  }

 private:
  /// The stop of a node.
  class Dock final : public RingEnd {
   public:
    void enter(RingDocks& docks, ResourceId node, In& in) {
      docks_ = &docks;
      node_ = node;
      in_ = &in;
    }
    void leave(Out& out, bool few) {
      out_ = &out;
      few_ = few;
    }

    Cycle due() const override { return in_->next(); }
    RingPacket take(Cycle now) override {
      const T token = in_->take(now);
      const RingShape& shape = docks_->shape_;
      const std::vector<std::uint32_t>& places = docks_->over_.places;
      RingPacket packet;
      packet.from = places[node_.value];
      packet.to = places[docks_->topology_.leaves_at(docks_->over_, node_, ResourceId(token.stop)).value];
      packet.random = docks_->turn_++;
      packet.direction = shape.direction(packet.from, packet.to, packet.random);
      if constexpr (requires { token.size_bytes; })
        packet.bytes = token.size_bytes;
      else
        packet.bytes = docks_->bytes_;
      packet.ready = now;
      packet.tag = docks_->keep(token);
      return packet;
    }
    bool has_place() const override { return !few_ || out_->has_place(); }
    void keep_place() override {
      if (few_) out_->reserve();
    }
    void arrive(const RingPacket& packet, Cycle tail) override {
      T token = docks_->tokens_[packet.tag];
      docks_->unused_.push_back(packet.tag);
      token.link_cycles = 1;  // the port has moved it, flit by flit
      out_->count_moved(ceil_div(packet.bytes, docks_->shape_.port) - 1);
      if (few_) out_->release();
      out_->push(token, tail, true);
    }

   private:
    RingDocks* docks_ = nullptr;
    ResourceId node_{};
    In* in_ = nullptr;
    Out* out_ = nullptr;
    bool few_ = false;  // places for packets that get off
  };

  std::uint32_t keep(const T& token) {
    if (unused_.empty()) {
      unused_.push_back(static_cast<std::uint32_t>(tokens_.size()));
      tokens_.emplace_back();
    }
    const std::uint32_t tag = unused_.back();
    unused_.pop_back();
    tokens_[tag] = token;
    return tag;
  }

  const Topology& topology_;
  const TopologyPlan::StopRing& over_;
  std::vector<Out>& out_;
  TopologyConfig config_;  // of which graph and shape keep parts
  config::Graph graph_;
  RingShape shape_;
  std::uint32_t bytes_;
  std::vector<T> tokens_;              // of packets on the ring, by tag
  std::vector<std::uint32_t> unused_;  // tags
  std::vector<Dock> docks_;
  std::unique_ptr<RingFabric> fabric_;
  std::uint32_t turn_ = 0;  // packets so far, by which equally long ways take turns
};

}  // namespace carousel::ringbus::cycle
