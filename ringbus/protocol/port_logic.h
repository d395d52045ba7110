#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "ringbus/packets/packet.h"
#include "ringbus/protocol/admission.h"
#include "ringbus/protocol/free_packets.h"
#include "ringbus/protocol/machine.h"
#include "ringbus/resource/resource.h"

namespace carousel::ringbus {

/// The decision about a packet that has arrived at a resource.
enum class PacketFate : std::uint8_t {
  kRetire,     ///< it is back at its owner, which takes in what it brings
  kTestOwn,    ///< it is back at its owner, which now tests its own rays of it, and then takes in what it brings
  kDiscard,    ///< it is back at its owner, which has no use for it any more
  kTest,       ///< it carries rays of this resource; it goes on when they have been tested
  kIdleVisit,  ///< with `topology.visit: all` it is looked through, and goes on since none of its rays is here
  kJoin,       ///< its memberships have reached their home; it goes on without them
  kTakeRays,   ///< its new rays may take slots here; it goes on
  kForward,    ///< it goes on untouched
};

/// The side of a port that needs no clock, the same in every engine: decides what becomes of packets, keeps the
/// resource's own free packets and the new rays that wait for admission, and knows how far a fail-stop has come. An
/// engine adds queues and time. One thread at a time.
class PortLogic {
 public:
  /// Keeps references. `resource` is this port's.
  PortLogic(const Machine& machine, Resource& resource)
      : free(machine.first_packet(resource.id()), machine.topology.directions(), machine.packets_per_direction),
        machine_(machine),
        resource_(resource) {}

  PacketFate fate(const Packet& packet) const {
    if (packet.owner == here()) {
      if (only_forwards()) return PacketFate::kDiscard;
      return tests_own_last(packet) ? PacketFate::kTestOwn : PacketFate::kRetire;
    }
    if (only_forwards()) return PacketFate::kForward;
    switch (packet.kind) {
      case PacketKind::kTest:
        if (has_rays_of(packet)) return PacketFate::kTest;
        return machine_.topology.visits_all() ? PacketFate::kIdleVisit : PacketFate::kForward;
      case PacketKind::kMemberships:
        return packet.home == here() ? PacketFate::kJoin : PacketFate::kForward;
      case PacketKind::kRays:
        return PacketFate::kTakeRays;
    }
    return PacketFate::kForward;
  }
  /// Tells whether a packet carries rays to be tested here, at any time.
  bool has_rays_of(const Packet& packet) const {
    return packet.kind == PacketKind::kTest && machine_.topology.wanted(packet, here());
  }
  /// Tells whether a packet of its own has to be sent out at all.
  bool travels(const Packet& packet) const { return !machine_.stays && machine_.topology.hops(packet) > 0; }
  /// Tells whether a packet of its own goes out first, and its owner's rays are tested when it is back
  /// (`testers.own_rays: after`; US 9633468 lets an issuer test its own rays before the others have tested theirs, or
  /// afterwards).
  bool tests_own_last(const Packet& packet) const {
    return machine_.own_rays_last && has_rays_of(packet) && travels(packet);
  }
  /// Tells whether a packet with rays of this resource goes on when they have been tested.
  bool leaves_after_test(const Packet& packet) const {
    return packet.owner != here() || (travels(packet) && !machine_.own_rays_last);
  }
  /// The port by which a packet leaves.
  std::size_t out_port(const Packet& packet) const { return machine_.topology.out_port(packet, here()); }

  /// Takes in what a packet of its own has brought back; the packet is free again. Returns how many ray IDs have joined
  /// collections.
  std::size_t retire(PacketId id, Packet& packet) {
    const std::size_t joined = resource_.retire(packet);
    free.put(id, packet.direction);
    return joined;
  }
  /// Frees a packet of its own as retire() does, without taking anything in.
  void discard(PacketId id) { free.put(id, machine_.packet(id).direction); }

  // A fail-stop (`faults.resource: {kind: stop}`).

  /// From now on this resource only forwards packets, for good.
  void stop() { stopped_ = true; }
  /// Another resource has stopped: until resume(), all work that was under way comes to nothing.
  void drain() { draining_ = true; }
  /// All work is gone; it begins anew without `stopped`.
  void resume(ResourceId stopped) {
    draining_ = false;
    resource_.exclude(stopped);
  }
  bool stopped() const { return stopped_; }
  bool draining() const { return draining_; }
  bool only_forwards() const { return stopped_ || draining_; }

  // The end, good or bad.

  /// All its packets are at home.
  bool all_home() const { return free.count() == machine_.topology.directions() * machine_.packets_per_direction; }
  /// It holds no collection and no new ray, and waits for no packet.
  bool at_rest() const { return resource_.idle() && resource_.packets_in_flight() == 0 && admission.empty(); }
  /// Describes in one line the work it holds and waits for.
  std::string describe() const;
  /// Names a packet, its owner and its first ray.
  std::string describe(PacketId id) const;

  FreePackets free;
  Admission admission;

 private:
  ResourceId here() const { return resource_.id(); }

  const Machine& machine_;
  Resource& resource_;
  bool stopped_ = false, draining_ = false;
};

}  // namespace carousel::ringbus
