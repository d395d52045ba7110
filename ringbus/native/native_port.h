#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "ringbus/faults/resource_fault.h"
#include "ringbus/native/machine.h"
#include "ringbus/resource/resource.h"

namespace carousel::ringbus {

/// A resource's place on the ring in the native engine: its links, its packets, and the packets it has in hand.
/// One thread steps it.
class NativePort {
 public:
  NativePort(ResourceId id, Machine& machine, float scene_size, EventSink* sink);

  /// Does what can be done now, in the order that keeps the ring moving: send on, receive, admit, issue.
  /// Returns whether anything moved.
  bool step();

  const Resource& resource() const { return resource_; }
  /// Own packets under way, as of some recent moment. Any thread may call.
  // Acquire: pairs with the release in retire_at_owner; whoever sees a packet home sees what it brought.
  std::uint32_t packets_out() const { return out_.load(std::memory_order_acquire); }
  /// Nothing here: no packet of its own on the way, none in hand, no collection, no new ray.
  bool drained() const;
  /// From now on it only forwards, as one that has stopped does.
  void stop() { stopped_ = true; }
  /// From now on another is known to have stopped. Before the first step.
  void exclude(ResourceId stopped) { resource_.exclude(stopped); }
  /// Counts its steps, but not when it has stopped. Any thread may call.
  // Relaxed: the watcher only wants to see it change.
  std::uint64_t beats() const { return beats_.load(std::memory_order_relaxed); }
  /// One line on what it waits for, with packet and ray IDs. Call when nothing steps.
  std::string describe() const;

 private:
  /// Where packets leave: one link, and those that the link has not taken yet.
  struct OutPort {
    Link* link;
    std::deque<PacketId> egress;
  };

  bool step_now();
  bool tick_links();
  bool send_egress();
  bool receive();
  void arrive(PacketId id);
  void retire_at_owner(PacketId id);
  void discard(PacketId id);
  void forward(PacketId id);
  void inject(PacketId id);

  bool admit();
  void wait(RayGroup&& group);
  bool admit_ids();
  bool send_rays_round();
  bool send_round(RayGroup& group);
  void take_rays(Packet& packet);

  bool issue(bool partial);
  bool may_inject(std::size_t exit) const;
  /// A free packet of a direction it may be sent in; null when there is none.
  bool free_packet(PacketId& id);
  void flush_completed(bool all);

  void stall(StallReason reason) {
    if (sink_ != nullptr) sink_->record({.kind = EventKind::kStall, .resource = resource_.id(), .reason = reason});
  }
  void hop(PacketId id) {
    if (sink_ != nullptr) sink_->record({.kind = EventKind::kHop, .resource = resource_.id(), .packet = id});
  }

  Machine& machine_;
  bool links_fail_;
  std::optional<ResourceFault> fault_;
  std::uint64_t stops_after_ = 0, rays_completed_ = 0;
  bool stops_, stopped_ = false;
  std::atomic<std::uint64_t> beats_{0};
  EventSink* sink_;
  Resource resource_;
  struct InPort {
    Link* link;
    std::uint16_t direction;
  };
  std::vector<InPort> in_ports_;             // incoming links
  std::vector<OutPort> out_ports_;           // a ring: one a direction
  std::vector<std::vector<PacketId>> free_;  // own packets at home, by direction
  std::size_t next_direction_ = 0;
  std::atomic<std::uint32_t> out_{0};           // own packets under way; written by the owner
  Packet local_;                                // never travels: collections that are tested on the spot
  std::deque<std::vector<RayId>> waiting_ids_;  // new rays that have slots, oldest first
  std::vector<RayGroup> waiting_rays_;          // new rays without, oldest first
  std::vector<RayGroup> arrived_;               // scratch of admit() and send_rays_round()
};

}  // namespace carousel::ringbus
