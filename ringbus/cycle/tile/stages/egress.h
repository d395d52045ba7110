#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "ringbus/cycle/fabric/ports.h"
#include "ringbus/cycle/tile/stages/packet_needs.h"
#include "ringbus/protocol/answers.h"
#include "ringbus/protocol/port_logic.h"
#include "ringbus/results/cycle_result.h"

namespace carousel::ringbus::cycle {

/// The way of packets out of a resource: their sizes on the links, the egress queues, and the answers that a packet of
/// this resource waits for where others hear it.
class Egress {
 public:
  /// Keeps references.
  Egress(Machine& machine, ResourceId id, const PortLogic& logic, const PacketNeeds& needs, std::vector<OutPort>& ports)
      : machine_(machine),
        id_(id),
        logic_(logic),
        needs_(needs),
        ports_(ports),
        answers_due_(machine.topology.broadcasts() ? machine.packets_per_direction : 0) {}

  OutPort& port(std::size_t number) { return ports_[number]; }
  OutPort& port_of(const Packet& packet) { return ports_[logic_.out_port(packet)]; }

  /// Both note it if there is no place, or no credit that the flow rule asks for.
  bool has_place(const OutPort& port) {
    waits_for_place_ |= !port.has_place();
    return port.has_place();
  }
  bool may_inject(const Packet& packet) {
    const OutPort& port = port_of(packet);
    const bool may = machine_.flow.may_inject(port.has_place(), [&] { return port.spare_places(); });
    waits_for_place_ |= !may;
    return may;
  }
  /// True if dispatch has refused a packet for want of a place or a credit since forget_waits().
  bool waits_for_place() const { return waits_for_place_; }
  void forget_waits() { waits_for_place_ = false; }

  /// Puts a packet into its egress queue, which it does not leave before `ready`. `reserved`: it has a place there.
  void depart(PacketId id, Cycle ready, bool reserved);
  /// Sends what may leave. Returns whether there is a place again in an egress queue that was full.
  bool send(Cycle now) {
    bool room = false;
    for (OutPort& out : ports_) {
      const bool full = !out.has_place();
      room |= out.send(now) && full;
    }
    return room;
  }
  void take_credits(Cycle now) {
    for (OutPort& out : ports_) out.take_credits(now);
  }
  /// The same for what passes by: only credits that something waits for.
  void take_wanted_credits(Cycle now) {
    for (OutPort& out : ports_)
      if (wants_credit_ || !out.empty()) out.take_credits(now);
  }

  /// How many of the resources that hear packet `id`, which is this one's, have not answered yet.
  std::uint32_t& answers_due(PacketId id) { return answers_due_[id.value - machine_.first_packet(id_).value]; }

  /// Notes at the end of an event what the links wait for. `wants_credit`: a packet in dispatch does.
  void look(bool wants_credit) {
    wants_credit_ = may_send_ = awaits_credit_ = wants_credit;
    blocked_from_ = kNever;
    for (const OutPort& out : ports_) {
      may_send_ |= !out.empty();
      awaits_credit_ |= out.awaits_credit();
      blocked_from_ = std::min(blocked_from_, out.blocked_from());
    }
  }
  void look() { look(wants_credit_); }

  // As of the last look():

  bool may_send() const { return may_send_; }            ///< a packet waits to leave, or for credits
  bool awaits_credit() const { return awaits_credit_; }  ///< a packet waits for a credit
  Cycle blocked_from() const { return blocked_from_; }   ///< a packet waits for a credit then; kNever: none
  /// The time after `now` at which a packet can leave, as far as that is known, or at which a credit comes that is
  /// waited for.
  Cycle next_after(Cycle now) const {
    Cycle first = kNever;
    for (const OutPort& out : ports_)
      if (const Cycle at = out.next(wants_credit_); at > now && at < first) first = at;
    return first;
  }

  bool empty() const {
    return std::all_of(ports_.begin(), ports_.end(), [](const OutPort& out) { return out.empty(); });
  }
  std::uint64_t hops() const;
  const PacketKindCounts& sent() const { return sent_; }
  /// The packet that cannot leave by a port, with its first ray; or empty.
  std::string blocked(std::size_t port) const {
    return ports_[port].awaits_credit() ? logic_.describe(ports_[port].front()) : "";
  }
  /// All such packets, a clause each.
  std::string describe() const;

 private:
  void count_sent(const Packet& packet, const PacketLoad& load, bool answers);

  Machine& machine_;
  ResourceId id_;
  const PortLogic& logic_;
  const PacketNeeds& needs_;
  std::vector<OutPort>& ports_;
  std::vector<std::uint32_t> answers_due_;  // by packet of its own
  PacketKindCounts sent_;
  bool waits_for_place_ = false, wants_credit_ = false, may_send_ = false, awaits_credit_ = false;
  Cycle blocked_from_ = kNever;
};

}  // namespace carousel::ringbus::cycle
