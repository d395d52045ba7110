#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "ringbus/faults/resource_fault.h"
#include "ringbus/native/native_machine.h"
#include "ringbus/native/native_recorder.h"
#include "ringbus/protocol/port_logic.h"
#include "ringbus/protocol/ray_rounds.h"
#include "ringbus/resource/resource.h"

namespace carousel::ringbus {

/// The parts of the configuration that a port of the native engine follows.
struct NativePortSettings {
  ResourceSettings resource;
  FaultsConfig faults;
  std::int64_t clock_mhz = 1000;
};

/// A resource's place on the ring in the native engine: its links with their egress queues, and the order in which it
/// does its work. The decisions are PortLogic's and FlowRules'. One thread steps it.
class NativePort {
 public:
  /// Keeps references. `sink` may be null.
  NativePort(ResourceId id, NativeMachine& machine, const NativePortSettings& settings, EventSink* sink);
  /// From now on its packets are noted, or the life of a ray.
  void record(NativeRecorder& recorder);

  /// Does all that can be done now, in the order that keeps the ring moving: send on, receive, admit, issue.
  /// Returns whether anything moved.
  bool step();

  const Resource& resource() const { return resource_; }
  /// Own packets under way, as of some recent moment. Any thread may call.
  // Acquire: pairs with the release in packet_returned; a thread that sees a packet at home sees what it brought.
  std::uint32_t packets_out() const { return out_.load(std::memory_order_acquire); }
  /// Nothing is left here: no packet of its own on the way, no egress, and unless it has stopped no collection and no
  /// new ray.
  bool drained() const;
  /// Packets of its own that it did not take in, since it has stopped.
  std::uint64_t packets_discarded() const { return logic_.stopped() ? resource_.packets_in_flight() : 0; }
  /// From now on it only forwards, as a resource that has stopped does.
  void stop() { logic_.stop(); }
  /// From now on another resource is known to have stopped. Before the first step.
  void exclude(ResourceId stopped);
  /// Counts its steps, but not when it has stopped. Any thread may call.
  // Relaxed: the watcher only wants to see it change.
  std::uint64_t beats() const { return beats_.load(std::memory_order_relaxed); }
  /// Visits of packets, and packets of its own that were tested on the spot, since it was made. Any thread may call.
  // Relaxed: the watcher draws them over time.
  std::uint64_t visits() const { return visits_.load(std::memory_order_relaxed); }
  /// One line that says what it waits for, with packet and ray IDs. Call when nothing steps.
  /// Its resource rests by request (`faults.resource`), for a time that ends by itself.
  bool rests() const { return fault_ && fault_->rests(); }
  std::string describe() const;

 private:
  struct InPort {
    Link* link;
    std::uint16_t direction;
    std::deque<PacketId> waiting;  // of a graph: taken off the link; the first one has found no place
  };
  /// The resources for which packets of a graph are bound next, as a resource sees them.
  struct NextStops {
    std::vector<ResourceId>* all;  // by packet; null: packets are not routed
    ResourceId here;

    bool passes(PacketId id) const { return all != nullptr && (*all)[id.value] != here; }
    std::size_t port(const Machine& machine, PacketId id) const {
      return machine.topology.exit(here, (*all)[id.value], machine.packet(id).direction).port;
    }
  };
  /// One link, and the packets that the link has not taken yet.
  struct OutPort {
    Link* link;
    std::uint32_t wire;
    std::deque<PacketId> egress;
  };

  // With a recorder (native_port_record.cpp).
  void note_slice(SliceKind kind, PacketId packet, std::uint64_t begin);
  void note_sending(std::span<const PacketId> packets);
  void note_sent(const OutPort& out, std::span<const PacketId> packets);
  void note_visit(PacketId id, bool tested, std::uint64_t begin);
  void note_admitted(std::span<const RayId> rays);
  std::uint64_t note_issued(std::optional<PacketId> id, const Packet& packet);
  void note_leaving(std::optional<PacketId> id, const Packet& packet, bool tested, std::uint64_t begin);
  void note_retired(PacketId id, const Packet& packet);
  void note_done(const HitBatch& done);
  void note_member(RayFact::Kind kind, std::optional<PacketId> id, const Packet& packet, std::uint64_t at);

  bool step_now();
  bool tick_links();
  bool send_egress();
  bool receive();
  bool receive_routed();
  bool may_take_in(PacketId id) const;
  std::size_t receivable(const InPort& in) const;
  void arrive(PacketId id);
  void retire_at_owner(PacketId id, std::uint64_t begin);
  void packet_returned();
  void forward(PacketId id);
  void pass_on(PacketId id, std::size_t port);
  void test(Packet& packet) {
    ++visits_now_;
    if (gate_ == nullptr || gate_->shapes() == nullptr) return static_cast<void>(resource_.test(packet));
    const accel::NodeKey key = std::exchange(packet.key, gate_->shapes()->key_here(packet));
    resource_.test(packet);
    packet.key = key;
  }
  void inject(PacketId id);

  bool admit();
  void wait(RayGroup&& group);
  bool send_rays_round();
  bool send_round(RayGroup& group);

  bool issue(bool partial);
  /// A free packet of a direction in which it may be sent.
  std::optional<PacketId> free_packet();
  void flush_completed(bool all);

  void stall(StallReason reason) {
    if (sink_ != nullptr) sink_->record({.kind = EventKind::kStall, .resource = resource_.id(), .reason = reason});
  }

  Machine& machine_;
  CompletedQueue& completed_;
  RankGate* gate_;
  EventSink* sink_;
  Resource resource_;
  PortLogic logic_;
  RayRounds rounds_;
  bool links_fail_;
  std::optional<ResourceFault> fault_;
  std::optional<std::uint64_t> stops_after_;  // rays_done_
  std::uint64_t rays_done_ = 0;  // completed here; taken in, if it collects for others, where none completes
  bool closed_ = false;          // the packet process that collects its rays has stopped, so it gets none
  std::atomic<std::uint64_t> beats_{0}, visits_{0};
  std::uint64_t visits_now_ = 0;  // published once a step
  std::vector<InPort> in_ports_;
  std::vector<OutPort> out_ports_;
  bool routed_;  // packets of one link go on by several
  std::size_t egress_limit_;
  NextStops stops_;
  std::size_t egress_places_;          // of a graph, for packets of others
  std::size_t turn_ = 0;               // of a graph: the link whose packets are taken first
  std::atomic<std::uint32_t> out_{0};  // own packets under way; written by the owner
  NativeRecorder* recorder_ = nullptr;
  Recording recording_;
  std::uint64_t sending_since_ = 0;
  std::vector<std::uint64_t> sending_;  // trips of the packets that are being sent
  Packet local_;                        // never travels: collections that are tested on the spot
  std::vector<RayGroup> arrived_;       // scratch of admit() and send_rays_round()
};

}  // namespace carousel::ringbus
