#include "ringbus/native/native_port.h"

#include <algorithm>
#include <array>
#include <limits>
#include <span>

#include <fmt/format.h>

#include "ringbus/schedule/schedule.h"

namespace carousel::ringbus {

namespace {

constexpr std::size_t kReceiveBatch = 8;       // packets taken from a link at once: one index update for all
constexpr std::size_t kCompletedBatch = 512;   // rays handed to shading at once, at most a quarter of the slots
constexpr std::size_t kCompletedPause = 4096;  // completed rays after which issuing makes a pause for shading

std::optional<std::uint64_t> stops_after(const FaultsConfig::Resource& fault, ResourceId id) {
  if (fault.kind != FaultsConfig::Resource::Kind::kStop || fault.number != id.value) return std::nullopt;
  return static_cast<std::uint64_t>(fault.after_rays);
}

/// It is a packet process that serves resources.
bool collects_for_others(const Topology& topology, ResourceId id) {
  const std::vector<std::uint32_t>& managers = topology.manager_of();
  return !managers.empty() && managers[id.value] == id.value;
}

/// A graph that is a ring, or one in each lane, follows the rules of rings (FlowRules), among them the bubble: packets
/// of a direction come and leave by its port.
bool is_rings(const Topology& topology) {
  if (!topology.hubs().empty()) return false;
  const std::size_t directions = topology.directions();
  for (std::uint32_t r = 0; r < topology.resources(); ++r) {
    const Topology::Ports& ports = topology.ports(ResourceId(r));
    if (ports.out.size() != directions || ports.in.size() != directions) return false;
    for (std::size_t d = 0; d < directions; ++d) {
      if (topology.wires()[ports.in[d]].direction != d) return false;
      for (std::uint32_t stop = 0; stop < topology.resources(); ++stop)
        if (stop != r && topology.exit(ResourceId(r), ResourceId(stop), d).port != d) return false;
    }
  }
  return true;
}

}  // namespace

NativePort::NativePort(ResourceId id, NativeMachine& machine, const NativePortSettings& settings, EventSink* sink)
    : machine_(machine.shared),
      completed_(machine.completed),
      gate_(machine.gate.get()),
      sink_(sink),
      resource_(settings.resource, machine_.accel, *machine_.stores[id.value], {.events = sink}),
      logic_(machine_, resource_),
      rounds_(machine_, id),
      links_fail_(settings.faults.links.any()),
      fault_(ResourceFault::of(settings.faults.resource, settings.clock_mhz, id)),
      stops_after_(stops_after(settings.faults.resource, id)),
      routed_(machine_.topology.routed() && !is_rings(machine_.topology)),
      egress_limit_(machine_.flow.egress_limit(kReceiveBatch)),
      stops_{machine.stops.empty() ? nullptr : &machine.stops, resource_.id()},
      egress_places_(machine_.topology.room_for_all() ? std::numeric_limits<std::size_t>::max() : kReceiveBatch) {
  const Topology::Ports& ports = machine_.topology.ports(id);
  for (const std::uint32_t wire : ports.in)
    in_ports_.push_back({machine.links[wire].get(), machine_.topology.wires()[wire].direction, {}});
  for (const std::uint32_t wire : ports.out) out_ports_.push_back({machine.links[wire].get(), wire, {}});
  local_.owner = id;
  local_.owners.resize((machine_.topology.resources() + 63) / 64);
}

bool NativePort::step() {
  if (stops_after_ && rays_done_ >= *stops_after_) stop();
  if (logic_.stopped()) {
    bool moved = tick_links();
    schedule_point();
    moved |= send_egress();
    schedule_point();
    return receive() || moved;
  }
  // Relaxed, and no read-modify-write: it has one writer.
  beats_.store(beats_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  if (!fault_) return step_now();
  return fault_->step(rays_done_, [this] { return step_now(); });
}

bool NativePort::tick_links() {
  if (!links_fail_) return false;
  bool moved = false;
  for (const OutPort& out : out_ports_) moved |= out.link->tick();
  for (const InPort& in : in_ports_) in.link->tick_receiver();
  return moved;
}

bool NativePort::step_now() {
  bool moved = tick_links();
  moved |= send_egress();
  schedule_point();
  moved |= receive();
  schedule_point();
  moved |= admit();
  schedule_point();
  moved |= issue(false);
  if (!moved) moved = issue(true);  // only when there is nothing better to do: waiting fills collections
  schedule_point();
  moved |= send_egress();
  schedule_point();
  flush_completed(!moved);
  visits_.store(visits_now_, std::memory_order_relaxed);  // as for beats_
  return moved;
}

// ---- packets of others

bool NativePort::send_egress() {
  bool moved = false;
  std::array<PacketId, kReceiveBatch> batch;
  for (OutPort& out : out_ports_) {
    while (!out.egress.empty()) {
      const std::size_t count = std::min(batch.size(), out.egress.size());
      std::copy_n(out.egress.begin(), count, batch.begin());
      if (recorder_ != nullptr) [[unlikely]]
        note_sending({batch.data(), count});
      const std::size_t sent = out.link->try_send({batch.data(), count});
      if (recorder_ != nullptr && sent > 0) [[unlikely]]
        note_sent(out, {batch.data(), sent});
      out.egress.erase(out.egress.begin(), out.egress.begin() + static_cast<std::ptrdiff_t>(sent));
      moved |= sent > 0;
      if (sent < count) {
        stall(StallReason::kLink);
        break;
      }
    }
  }
  return moved;
}

std::size_t NativePort::receivable(const InPort& in) const {
  // No more than a link holds, though the sender may refill it meanwhile.
  const std::size_t most = std::min(kReceiveBatch, in.link->capacity());
  if (machine_.topology.direct()) return most;
  const OutPort& out = out_ports_[in.direction];
  return machine_.flow.receivable(most, out.egress.size(), [&] { return out.link->free_places(); });
}

// A packet that waits at the end of a link is one place more than the plan's verdict counts
// (ringbus/topology/graph.cpp), and places that are more cannot close a circle.
bool NativePort::receive_routed() {
  bool moved = false, waits = false;
  std::array<PacketId, kReceiveBatch> batch;
  for (std::size_t i = 0; i < in_ports_.size(); ++i) {
    InPort& in = in_ports_[(turn_ + i) % in_ports_.size()];
    if (in.waiting.empty()) {
      const std::size_t count =
          in.link->try_receive(std::span(batch).first(std::min(kReceiveBatch, in.link->capacity())));
      in.waiting.assign(batch.begin(), batch.begin() + static_cast<std::ptrdiff_t>(count));
    }
    for (; !in.waiting.empty() && may_take_in(in.waiting.front()); moved = true) {
      const PacketId id = in.waiting.front();
      in.waiting.pop_front();
      arrive(id);
    }
    waits |= !in.waiting.empty();
  }
  if (waits) turn_ = (turn_ + 1) % in_ports_.size();  // the next time, another link is the first
  return moved;
}

/// A packet is at home, or can go on from here.
bool NativePort::may_take_in(PacketId id) const {
  const Packet& packet = machine_.packet(id);
  const bool passing = stops_.passes(id);
  if (!passing && packet.owner == resource_.id()) return true;
  return out_ports_[passing ? stops_.port(machine_, id) : logic_.out_port(packet)].egress.size() < egress_places_;
}

bool NativePort::receive() {
  if (routed_) return receive_routed();
  bool moved = false;
  std::array<PacketId, kReceiveBatch> batch;
  for (const InPort& in : in_ports_) {
    const std::size_t most = receivable(in);
    if (most == 0) continue;
    const std::size_t count = in.link->try_receive(std::span(batch).first(most));
    for (std::size_t k = 0; k < count; ++k) arrive(batch[k]);
    moved |= count > 0;
  }
  return moved;
}

void NativePort::arrive(PacketId id) {
  Packet& packet = machine_.packet(id);
  const std::uint64_t begin = recorder_ != nullptr ? recorder_->now() : 0;
  if (stops_.passes(id)) {
    if (recorder_ != nullptr) [[unlikely]]
      note_visit(id, false, begin);
    return pass_on(id, stops_.port(machine_, id));
  }
  const PacketFate fate = logic_.fate(packet);
  switch (fate) {
    case PacketFate::kRetire:
      return retire_at_owner(id, begin);
    case PacketFate::kTestOwn:
      test(packet);
      if (recorder_ != nullptr) [[unlikely]]
        note_visit(id, true, begin);
      return retire_at_owner(id, recorder_ != nullptr ? recorder_->now() : 0);
    case PacketFate::kDiscard:
      logic_.discard(id);
      return packet_returned();
    case PacketFate::kTest:
    case PacketFate::kIdleVisit:  // which is counted there
      test(packet);
      break;
    case PacketFate::kJoin:
      resource_.join(packet);
      break;
    case PacketFate::kTakeRays:
      logic_.admission.add(rounds_.take_slots(packet));
      break;
    case PacketFate::kForward:
      break;
  }
  if (recorder_ != nullptr) [[unlikely]]
    note_visit(id, fate == PacketFate::kTest, begin);
  forward(id);
}

void NativePort::forward(PacketId id) {
  const Packet& packet = machine_.packet(id);
  if (stops_.all != nullptr) (*stops_.all)[id.value] = machine_.topology.next(packet, resource_.id());
  pass_on(id, logic_.out_port(packet));
}

void NativePort::pass_on(PacketId id, std::size_t port) {
  out_ports_[port].egress.push_back(id);
  if (sink_ != nullptr) sink_->record({.kind = EventKind::kHop, .resource = resource_.id(), .packet = id});
}

void NativePort::retire_at_owner(PacketId id, std::uint64_t begin) {
  Packet& packet = machine_.packet(id);
  if (recorder_ != nullptr) [[unlikely]]
    note_retired(id, packet);
  if (packet.kind == PacketKind::kRays) {
    // The rays that found no slot wait here and give the packet back, so that rays in flight can go on.
    logic_.admission.add(rounds_.take_slots(packet));
    wait(rounds_.unload(packet));
    logic_.discard(id);
  } else {
    logic_.retire(id, packet);
  }
  if (recorder_ != nullptr) [[unlikely]]
    note_slice(SliceKind::kRetire, id, begin);
  packet_returned();
}

void NativePort::packet_returned() {
  // Release: pairs with the acquire in packets_out().
  out_.store(out_.load(std::memory_order_relaxed) - 1, std::memory_order_release);
}

void NativePort::inject(PacketId id) {
  // Relaxed: a ray of this packet is still counted, and that count is looked at first.
  out_.store(out_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  forward(id);
}

// ---- new rays

bool NativePort::admit() {
  machine_.control.collect(resource_.id(), arrived_);
  for (RayGroup& group : arrived_) wait(std::move(group));
  arrived_.clear();
  const bool admitted = logic_.admission.admit(resource_, [this](std::span<const RayId> rays) {
    if (collects_for_others(machine_.topology, resource_.id())) rays_done_ += rays.size();
    if (recorder_ != nullptr) [[unlikely]]
      note_admitted(rays);
  });
  if (logic_.admission.short_of_room()) stall(StallReason::kStorage);
  return send_rays_round() || admitted;
}

void NativePort::wait(RayGroup&& group) {
  logic_.admission.add(std::move(group.ids));
  rounds_.add(group);
}

/// Sends waiting rays out to look for slots. Rays for which no resource has room wait on.
bool NativePort::send_rays_round() {
  bool moved = false;
  rounds_.take_waiting(arrived_);
  for (RayGroup& group : arrived_) {
    moved |= send_round(group);
    wait(std::move(group));
  }
  arrived_.clear();
  return moved;
}

/// Sends a group's rays round the ring to look for slots, unless there is no room for them or no packet is free.
bool NativePort::send_round(RayGroup& group) {
  if (!rounds_.has_room(group)) {
    stall(StallReason::kSlots);
    return false;
  }
  if (machine_.topology.resources() == 1) {
    rounds_.load(group, local_);
    logic_.admission.add(rounds_.take_slots(local_));
    group = rounds_.unload(local_);
    return true;
  }
  // The last packet is left to rays that are under way: only they can free the slots that new ones wait for.
  if (!resource_.idle() && resource_.packets_in_flight() == 0) return false;
  const std::optional<PacketId> id = free_packet();
  if (!id) return false;
  Packet& packet = machine_.packet(*id);
  rounds_.load(group, packet);
  logic_.admission.add(rounds_.take_slots(packet));
  inject(*id);
  return true;
}

// ---- issuing

std::optional<PacketId> NativePort::free_packet() {
  const auto may_join = [this](const OutPort& out) {
    return machine_.flow.may_inject(out.egress.size() < egress_limit_, [&] { return out.link->free_places(); });
  };
  const std::optional<PacketId> id = logic_.free.take([&](std::size_t direction) {
    // By which port a packet leaves is known when it is filled. Sent directly, any port has the same limit.
    return routed_ ? std::all_of(out_ports_.begin(), out_ports_.end(), may_join) : may_join(out_ports_[direction]);
  });
  if (!id) stall(logic_.free.none() ? StallReason::kCredits : StallReason::kLink);
  return id;
}

bool NativePort::issue(bool partial) {
  bool moved = false;
  // When only partial collections are left, one at a time: the next look at the links may fill the others.
  // Completed rays go to shading while they are still in cache.
  for (int budget = partial ? 1 : 64; budget > 0 && !resource_.idle() && resource_.completed().size() < kCompletedPause;
       --budget) {
    std::optional<PacketId> id;
    if (!machine_.stays && !(id = free_packet())) return moved;
    Packet& packet = id ? machine_.packet(*id) : local_;
    const Resource::Offer offer = resource_.offer(partial, packet);
    if (offer != Resource::Offer::kPacket) {
      if (id) logic_.discard(*id);
      if (offer == Resource::Offer::kStorage) stall(StallReason::kStorage);
      return moved;
    }
    moved = true;
    const std::uint64_t begin = recorder_ != nullptr ? note_issued(id, packet) : 0;
    const bool tests_now = packet.kind == PacketKind::kTest && !logic_.tests_own_last(packet);
    if (tests_now) test(packet);
    if (recorder_ != nullptr) [[unlikely]]
      note_leaving(id, packet, tests_now, begin);
    if (!id)
      resource_.retire(packet);
    else if (logic_.travels(packet))
      inject(*id);
    else
      logic_.retire(*id, packet);
  }
  return moved;
}

void NativePort::flush_completed(bool all) {
  HitBatch& done = resource_.completed();
  const std::size_t enough = std::min<std::size_t>(kCompletedBatch, resource_.rays().slots() / 4 + 1);
  if (done.empty() || (!all && done.size() < enough)) return;
  HitBatch* const batch = completed_.try_take();
  if (batch == nullptr) return;  // more may complete meanwhile
  schedule_point();
  if (sink_ != nullptr)
    sink_->record(
        {.kind = EventKind::kComplete, .resource = resource_.id(), .rays = static_cast<std::uint32_t>(done.size())});
  rays_done_ += done.size();
  if (recorder_ != nullptr) [[unlikely]]
    note_done(done);
  if (gate_ != nullptr) gate_->send_results(resource_.id(), done, resource_.freed_slots());
  machine_.control.free(resource_.id(), resource_.freed_slots());
  resource_.freed_slots().clear();
  schedule_point();
  done.swap(*batch);
  completed_.push(batch, batch->size());
}

}  // namespace carousel::ringbus
