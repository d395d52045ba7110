#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ringbus/cycle/rings/ring_times.h"
#include "ringbus/cycle/traffic/channel_claims.h"
#include "ringbus/cycle/traffic/traffic_agent.h"
#include "ringbus/cycle/traffic/traffic_source.h"
#include "ringbus/time/fifo.h"
#include "ringbus/time/machine_clocks.h"
#include "ringbus/topology/topology.h"

namespace carousel::ringbus::cycle {

/// A node of a graph without rays: a router with a queue for each virtual channel of each link that leads to it and, at
/// a resource, a source and a sink. There are no places before the links that leave: a packet waits in its queue, and
/// holds up those behind it, until its link is free and a channel that it may take (ChannelPlan) has a place at the
/// other end. Each link that leaves, and the sink, offers itself to one of the links that lead here with a packet for
/// it, by turns; a link that gets several offers takes one, by turns, and the others lapse for that cycle (N. McKeown,
/// The iSLIP scheduling algorithm for input-queued switches, IEEE/ACM Trans. Networking 7 (1999), of one iteration, as
/// in BookSim2). Queues of a link have turns, too. One flit a cycle leaves the queues of a link, or the source, and
/// gets out to the sink. The source puts the head of a packet into the next of as many queues as a link has that has a
/// place, and the other flits behind it, or waits for a place. Where nodes have `credit_cycles`, it hears of a place a
/// cycle and these later, and what it sends then takes `inject_cycles`; elsewhere it knows at once.
///
/// Where links are of one width and no router stores packets whole, flits go one by one, and those of packets on
/// several channels of a link alternate: a channel belongs to a packet from its first flit to its last, and has places
/// for the flits of `depth` packets. The way to the sink has as many channels as the link with most of them. Elsewhere
/// a packet keeps its link until it is over.
///
/// With `claim_cycles` a packet claims its channel first, whether or not that has a place (ChannelClaims), and its head
/// asks for the link so many cycles later. They are a part of the node's cycles if the head finds the queue empty, and
/// come after the last flit of the packet before it otherwise. The flits behind a head have nothing to claim: those
/// that come late catch up by so many cycles. Without `claim_cycles` a packet gets a channel that has a place, and the
/// link, in the same cycle.
///
/// A packet of L flits, from its creation until its last flit is delivered and if no other packet is in its way, takes
///     inject_cycles + sum over its links of (node_cycles + latency_cycles) + L - 1 + eject_cycles
/// where node_cycles are those of the node before the link. Where nodes and links go by several clocks, each flit
/// passes from one to the next as ClockRatio says, and alone() follows it. A packet that changes to a link of another
/// width, or at a router with `forward: whole`, is stored whole and takes its length once more. A ring whose stops have
/// no queues is a node of its own between two wires of a cycle (TrafficRing), and takes RingTimes::alone().
class RoutedNode final : public TrafficAgent {
 public:
  /// By link, and within a link by channel.
  struct Ports {
    std::vector<In> in;
    std::vector<Out> out;
    std::vector<Cycle> claims = {};  ///< by link that leads here: claim_cycles that its cycles have counted already
  };

  /// Keeps references to the topology, the rings and the clocks. `source`: of a resource, from which `packets` are
  /// taken.
  RoutedNode(ResourceId id, const Topology& topology, const RingTimes& rings, const TrafficNodeSettings& settings,
             const MachineClocks& clocks, std::optional<TrafficSource> source, std::uint64_t packets,
             TrafficWindow window, Ports ports);

  Cycle next() const override;
  void run(Cycle end) override;
  std::string describe() const override;

  Moved moved(std::size_t port) const override;
  TrafficOffered offered() const override { return offered_; }
  Cycle busy_in_window(std::size_t port) const override { return busy_before(port, 1) - busy_before(port, 0); }

 private:
  static constexpr std::size_t kNone = ChannelClaims::kNone;

  /// Packets that have left the source, and wait to be injected.
  struct Waiting {
    TrafficToken token;
    Cycle ready = 0;
  };
  /// The source, and the packet that it has created or will create next.
  struct Source {
    std::optional<TrafficSource> packets;
    std::uint64_t left = 0;  // after that packet
    Waiting next{{}, kNever};
    std::vector<Fifo<Waiting>> queues{};
    std::vector<Fifo<Cycle>> returns{};  // by queue: when a place is known to be free
    Cycle credit_cycles = 0;             // from when something leaves until what takes its place can be there
    std::size_t last = 0;                // the queue that got the last packet
    bool blocked = false;                // the queues that it might take are full
  };
  /// A link that leads here, or the source: one flit a cycle leaves its queues.
  struct Entry {
    std::size_t first = 0, queues = 1, turn = 0;  // of its queues the one that goes first
    std::size_t next_exit = 0;                    // of the exits that offer themselves the one that is taken first
    Cycle free = 0;                               // a flit leaves until then
    Cycle claims = 0;                             // what comes is here so long before a head may leave
  };
  /// A link that leaves, or the sink.
  struct Exit {
    std::uint32_t link = 0;                   // its number
    std::size_t first = 0, channels = 0;      // in out_
    std::uint16_t cycles = 0;                 // of a packet
    std::size_t next_entry = 0, channel = 0;  // the entry that goes first; the channel that went last
    Cycle free = 0;                           // a flit leaves until then
    std::array<Cycle, 2> busy{};              // cycles in which a flit left before the marks that are passed
  };

  void step(Cycle now);
  void pass_marks(Cycle now);
  Cycle busy_before(std::size_t port, std::size_t i) const;
  Cycle busy_at(const Exit& exit, Cycle at) const;
  void create();
  void fill_source(Cycle now);
  Cycle alone(ResourceId to, Cycle there) const;
  void over_link(const Topology::Wire& wire, bool through, std::vector<Cycle>& pieces) const;
  std::size_t next_source_queue(std::size_t queue) const { return queue + 1 < source_.queues.size() ? queue + 1 : 0; }
  bool of_source(std::size_t queue) const { return queue >= in_.size(); }
  /// When the first packet of a queue may leave, as far as the queue goes; kNever without one.
  Cycle ready(std::size_t queue) const;
  const TrafficToken& first(std::size_t queue) const {
    return of_source(queue) ? source_.queues[queue - in_.size()].front().token : in_[queue].front();
  }
  /// The number of a packet's exit; that of the sink is behind those of the links.
  std::size_t exit_of(const TrafficToken& token) const {
    return token.stop == id_.value ? exits_.size() - 1 : topology_.exit(id_, ResourceId(token.stop)).port;
  }
  std::uint32_t class_of(const TrafficToken& token, bool own, const Exit& exit) const {
    return own ? 0 : topology_.channels().after(token.channel, exit.link);
  }
  Cycle tail(std::size_t queue, Cycle now) const;
  bool may_leave(std::size_t queue, std::size_t exit, Cycle now);
  bool is_head(const TrafficToken& token) const { return token.behind + 1 == settings_.pieces; }
  /// The channels that a packet may take: the first, and the one behind the last.
  std::pair<std::size_t, std::size_t> channels_for(const TrafficToken& token, bool own, const Exit& exit) const;
  bool is_sink(const Exit& exit) const { return &exit == &exits_.back(); }
  bool has_place(std::size_t channel, Cycle now) { return channel >= out_.size() || out_[channel].open(now, 1); }
  std::optional<std::size_t> open_channel(std::size_t queue, const Exit& exit, Cycle now);
  Cycle channel_opens(std::size_t queue, const Exit& exit) const;
  /// The packet at the head of a queue has to claim a channel before it asks for its link.
  bool must_claim(std::size_t queue) const { return claim_cycles_ > 0 && claims_.of(queue) == ChannelClaims::kNone; }
  Cycle waits_until(std::size_t queue, const Entry& entry) const;
  void claim(Cycle now);
  void ask(Cycle now);
  std::optional<std::size_t> offer(std::size_t exit) const;
  void move(std::size_t entry, std::size_t exit, Cycle now);
  TrafficToken take(std::size_t queue, Cycle now);

  ResourceId id_;
  const Topology& topology_;
  const RingTimes& rings_;
  TrafficNodeSettings settings_;
  const MachineClocks& clocks_;
  Cycle claim_cycles_;
  std::vector<In> in_;
  std::vector<Out> out_;
  std::vector<Cycle> over_;          // by queue: its first packet stands there since, at the earliest
  std::vector<Cycle> claimed_;       // by queue: its first flit does not leave before
  ChannelClaims claims_{0, 0};       // channels by place in out_, and those of the sink behind
  std::vector<Entry> entries_;       // by link, and the source
  std::vector<Exit> exits_;          // by link, and the sink
  std::vector<std::size_t> asking_;  // by entry and exit: the queue whose first packet may leave there, or kNone
  std::vector<std::optional<std::size_t>> offers_;  // by exit: the entry
  Source source_;
  TrafficOffered offered_;
  Cycle now_ = 0;
  std::size_t marks_passed_ = 0;  // ends of the window
};

}  // namespace carousel::ringbus::cycle
