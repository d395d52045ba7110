#include "ringbus/cycle/rings/ring_hub.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "ringbus/topology/graph_facts.h"

namespace carousel::ringbus::cycle {

/// The stop of a resource, or of none.
class RingHub::Dock final : public RingEnd {
 public:
  /// Without ports, nothing gets on or off.
  Dock(RingHub& hub, std::uint32_t place, InPort* in, OutPort* out) : hub_(hub), place_(place), in_(in), out_(out) {}

  Cycle due() const override { return in_ == nullptr ? kNever : in_->next(); }
  RingPacket take(Cycle now) override {
    const Token token = in_->take(now);
    RingPacket packet;
    packet.from = place_;
    packet.to = hub_.places_[token.stop];
    packet.random = hub_.turn_++;
    packet.direction = hub_.shape_.direction(packet.from, packet.to, packet.random);
    packet.bytes = token.size_bytes;
    packet.ready = now;
    packet.tag = hub_.keep(token);
    return packet;
  }
  void arrive(const RingPacket& packet, Cycle tail) override {
    Token token = hub_.tokens_[packet.tag];
    hub_.unused_.push_back(packet.tag);
    token.link_cycles = 1;  // the port has moved it, flit by flit
    out_->push(token, tail, true);
  }

 private:
  RingHub& hub_;
  std::uint32_t place_;
  InPort* in_;
  OutPort* out_;
};

RingHub::RingHub(ResourceId node, const TopologyConfig& config, const Topology& topology, std::vector<InPort> in,
                 std::vector<OutPort> out)
    : Hub(std::move(in), std::move(out)),
      node_(node),
      topology_(topology),
      config_(config),
      graph_(draw_checked(config_)),
      shape_(config::stop_ring(config_, graph_)),
      places_(graph_.resources) {
  std::vector<RingEnd*> ends;
  for (std::uint32_t place = 0; place < shape_.stops; ++place) {
    const std::uint32_t resource = shape_.drawn.nodes[place];
    const bool ports = resource < graph_.resources;
    if (ports) places_[resource] = place;
    docks_.push_back(
        std::make_unique<Dock>(*this, place, ports ? &in_[resource] : nullptr, ports ? &out_[resource] : nullptr));
    ends.push_back(docks_.back().get());
  }
  fabric_ = make_ring(shape_, std::move(ends), RingLinks(graph_.links.size(), {0, kNever}));
}

RingHub::~RingHub() = default;

std::uint32_t RingHub::keep(const Token& token) {
  if (unused_.empty()) {
    unused_.push_back(static_cast<std::uint32_t>(tokens_.size()));
    tokens_.emplace_back();
  }
  const std::uint32_t tag = unused_.back();
  unused_.pop_back();
  tokens_[tag] = token;
  return tag;
}

Cycle RingHub::next() const {
  Cycle first = fabric_->next();
  for (const OutPort& out : out_)
    if (const Cycle at = out.next(false); at > now_) first = std::min(first, at);
  return first == kNever ? first : std::max(first, now_ + 1);
}

void RingHub::run(Cycle end) {
  for (Cycle now; (now = next()) < end;) step(now);
}

void RingHub::step(Cycle now) {
  look_at(now);
  now_ = now;
  for (OutPort& out : out_) out.take_credits(now);
  if (fabric_->next() <= now) fabric_->step(now);
  for (OutPort& out : out_)
    while (out.send(now)) {
    }
}

std::string RingHub::describe() const {
  std::size_t leaving = 0, waiting = 0;
  for (const OutPort& out : out_) leaving += out.egress();
  for (const InPort& in : in_) waiting += in.next() != kNever;
  const std::size_t riding = tokens_.size() - unused_.size();
  if (leaving + waiting + riding == 0) return "";
  return fmt::format(
      "ring {}: {} packets ride, {} stops have packets that wait to get on, and {} packets wait to leave",
      node_.value - topology_.resources(), riding, waiting, leaving);
}

}  // namespace carousel::ringbus::cycle
