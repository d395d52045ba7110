#include "ringbus/native/native_port.h"

#include <algorithm>
#include <array>
#include <span>

#include <fmt/format.h>

namespace carousel::ringbus {

namespace {

constexpr std::size_t kReceiveBatch = 8;       // packets taken from a link at once: one index update for all
constexpr std::size_t kCompletedBatch = 512;   // rays handed to shading at once, at most a quarter of the slots
constexpr std::size_t kCompletedPause = 4096;  // completed rays after which issuing makes a pause for shading

}  // namespace

NativePort::NativePort(ResourceId id, Machine& machine, float scene_size, EventSink* sink)
    : machine_(machine),
      links_fail_(machine.config.faults.links.any()),
      fault_(ResourceFault::of(machine.config.faults.resource, machine.config.engine.clock_mhz, id)),
      stops_after_(static_cast<std::uint64_t>(machine.config.faults.resource.after_rays)),
      stops_(machine.config.faults.resource.kind == FaultsConfig::Resource::Kind::kStop &&
             machine.config.faults.resource.number == id.value),
      sink_(sink),
      resource_(resource_settings(machine.config, scene_size), machine.accel, *machine.stores[id.value],
                {.events = sink}),
      free_(machine.topology.directions()) {
  const Topology::Ports& ports = machine.topology.ports(id);
  for (const std::uint32_t wire : ports.in)
    in_ports_.push_back({machine.links[wire].get(), machine.topology.wires()[wire].direction});
  for (const std::uint32_t wire : ports.out) out_ports_.push_back({machine.links[wire].get(), {}});
  for (std::uint32_t i = 0; i < machine.packets.size(); ++i)
    if (machine.packets[i].owner == id) free_[machine.packets[i].direction].push_back(PacketId(i));
  local_.owner = id;
  local_.owners.resize((machine.topology.resources() + 63) / 64);
}

bool NativePort::step() {
  if (stops_ && rays_completed_ >= stops_after_) stopped_ = true;
  if (stopped_) {
    bool moved = tick_links();
    moved |= send_egress();
    return receive() || moved;
  }
  // Relaxed, and no read-modify-write: it has one writer.
  beats_.store(beats_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  if (!fault_) return step_now();
  return fault_->step(rays_completed_, [this] { return step_now(); });
}

bool NativePort::tick_links() {
  if (!links_fail_) return false;
  bool moved = false;
  for (const OutPort& exit : out_ports_) moved |= exit.link->tick();
  for (const InPort& entry : in_ports_) entry.link->tick_receiver();
  return moved;
}

bool NativePort::step_now() {
  bool moved = tick_links();
  moved |= send_egress();
  moved |= receive();
  moved |= admit();
  moved |= issue(false);
  // Collections that are not full only when there is nothing better to do: waiting fills them.
  if (!moved) moved = issue(true);
  moved |= send_egress();
  flush_completed(!moved);
  return moved;
}

// ---- packets passing

bool NativePort::send_egress() {
  bool moved = false;
  std::array<PacketId, kReceiveBatch> batch;
  for (OutPort& exit : out_ports_) {
    while (!exit.egress.empty()) {
      const std::size_t count = std::min(batch.size(), exit.egress.size());
      std::copy_n(exit.egress.begin(), count, batch.begin());
      const std::size_t sent = exit.link->try_send({batch.data(), count});
      exit.egress.erase(exit.egress.begin(), exit.egress.begin() + static_cast<std::ptrdiff_t>(sent));
      moved |= sent > 0;
      if (sent < count) {
        stall(StallReason::kLink);
        break;
      }
    }
  }
  return moved;
}

bool NativePort::receive() {
  bool moved = false;
  std::array<PacketId, kReceiveBatch> batch;
  for (const InPort& entry : in_ports_) {
    // On a ring, what cannot leave must not come in, or the hand would be a queue without a bound. Point to
    // point, every packet there is would fit into the hand, so all may come in.
    if (!machine_.topology.direct() && !out_ports_[entry.direction].egress.empty()) continue;
    // No more than a link holds, though the sender may refill it meanwhile.
    std::size_t most = std::min(batch.size(), entry.link->capacity());
    // A hand with something left takes a place that the bubble is counted on for; three such hands can fill the ring in
    // spite of it (tests/models/flow.pml, -DGREEDY_HAND). So what comes in can go on at once, but for a single packet.
    if (!machine_.topology.direct() && machine_.config.topology.flow == Flow::kBubble)
      most = std::min(most, std::max<std::size_t>(1, out_ports_[entry.direction].link->free_places()));
    const std::size_t count = entry.link->try_receive(std::span(batch).first(most));
    for (std::size_t k = 0; k < count; ++k) arrive(batch[k]);
    moved |= count > 0;
  }
  return moved;
}

void NativePort::arrive(PacketId id) {
  Packet& packet = machine_.packet(id);
  if (packet.owner == resource_.id()) return stopped_ ? discard(id) : retire_at_owner(id);
  if (stopped_) return forward(id);
  if (machine_.topology.handles(packet, resource_.id())) {
    switch (packet.kind) {
      case PacketKind::kTest:
        resource_.test(packet);
        break;
      case PacketKind::kMemberships:
        resource_.join(packet);
        break;
      case PacketKind::kRays:
        take_rays(packet);
        break;
    }
  }
  forward(id);
}

void NativePort::forward(PacketId id) {
  out_ports_[machine_.topology.out_port(machine_.packet(id), resource_.id())].egress.push_back(id);
  hop(id);
}

void NativePort::retire_at_owner(PacketId id) {
  Packet& packet = machine_.packet(id);
  if (packet.kind == PacketKind::kRays) {
    // The IDs of the rays that found a slot, and the rays nobody had room for. They wait here and give the packet
    // back, so that rays in flight can go on.
    take_rays(packet);
    RayGroup group;
    for (const PacketMember& member : packet.members) group.ids.push_back(member.ray);
    group.rays.swap(packet.requests);
    group.addresses.swap(packet.addresses);
    wait(std::move(group));
  } else {
    resource_.retire(packet);
  }
  free_[packet.direction].push_back(id);
  // Release: pairs with the acquire in packets_out().
  out_.store(out_.load(std::memory_order_relaxed) - 1, std::memory_order_release);
}

void NativePort::discard(PacketId id) {
  free_[machine_.packet(id).direction].push_back(id);
  // Release: as in retire_at_owner().
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
  const bool admitted = admit_ids();
  return send_rays_round() || admitted;
}

void NativePort::wait(RayGroup&& group) {
  if (!group.ids.empty()) waiting_ids_.push_back(std::move(group.ids));
  if (!group.rays.empty()) waiting_rays_.push_back({{}, std::move(group.rays), std::move(group.addresses)});
}

/// Admits rays while there is room, the oldest first.
bool NativePort::admit_ids() {
  bool moved = false;
  while (!waiting_ids_.empty()) {
    std::vector<RayId>& ids = waiting_ids_.front();
    const std::size_t count = std::min(ids.size(), resource_.admissible());
    if (count > 0) resource_.admit(std::span(ids).first(count));
    moved |= count > 0;
    if (count < ids.size()) {
      stall(StallReason::kStorage);
      ids.erase(ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(count));
      break;
    }
    waiting_ids_.pop_front();
  }
  return moved;
}

/// Sends waiting rays out to look for slots; those that nobody has room for wait on.
bool NativePort::send_rays_round() {
  bool moved = false;
  arrived_.swap(waiting_rays_);
  for (RayGroup& group : arrived_) {
    moved |= send_round(group);
    wait(std::move(group));
  }
  arrived_.clear();
  return moved;
}

/// Gives the rays of a ray packet the slots there are here, this resource's share of them, and writes down their
/// IDs. With `home: local` they start from here; otherwise the packet carries the IDs back to its owner.
void NativePort::take_rays(Packet& packet) {
  const bool addressed = !packet.addresses.empty();
  // The rest of the ring is left its share: the rays left over the resources left, counting this one.
  std::size_t share = packet.requests.size();
  if (!addressed) share = (share + packet.hops_left) / (packet.hops_left + 1);
  if (packet.hops_left > 0) --packet.hops_left;
  const bool stays = machine_.config.collections.home == Home::kLocal;
  RayGroup own;
  std::size_t kept = 0, taken = 0;
  for (std::size_t i = 0; i < packet.requests.size(); ++i) {
    if (taken < share && (!addressed || packet.addresses[i] == resource_.id())) {
      if (const std::optional<RayId> id = machine_.control.load(resource_.id(), packet.requests[i])) {
        ++taken;
        if (stays)
          own.ids.push_back(*id);
        else
          packet.members.push_back({*id, 0});
        continue;
      }
      share = taken;  // no slot is left
    }
    packet.requests[kept] = packet.requests[i];
    if (addressed) packet.addresses[kept] = packet.addresses[i];
    ++kept;
  }
  packet.requests.resize(kept);
  if (addressed) packet.addresses.resize(kept);
  wait(std::move(own));
}

/// Sends a group's rays round the ring to look for slots; they are taken out of the group. Refused when nobody
/// has room for them, or no packet is to be had.
bool NativePort::send_round(RayGroup& group) {
  const bool room = group.addresses.empty()
                        ? machine_.control.free_slots() > 0
                        : std::any_of(group.addresses.begin(), group.addresses.end(),
                                      [&](ResourceId r) { return machine_.control.free_slots(r) > 0; });
  if (!room) {
    stall(StallReason::kSlots);
    return false;
  }
  const bool travels = machine_.topology.resources() > 1;
  // The last packet is left to rays that are under way: only they can free the slots that new ones wait for.
  if (travels && !resource_.idle() && resource_.packets_in_flight() == 0) return false;
  PacketId id;
  Packet* packet = &local_;
  if (travels) {
    if (!free_packet(id)) return false;
    packet = &machine_.packet(id);
  }
  packet->kind = PacketKind::kRays;
  packet->requests = std::move(group.rays);
  packet->addresses = std::move(group.addresses);
  packet->members.clear();
  packet->hops_left = static_cast<std::uint32_t>(machine_.topology.resources() - 1);
  group.rays.clear();
  group.addresses.clear();
  take_rays(*packet);
  if (travels) {
    inject(id);
  } else {
    group.rays = std::move(packet->requests);
    group.addresses = std::move(packet->addresses);
    for (const PacketMember& member : packet->members) group.ids.push_back(member.ray);
  }
  return true;
}

// ---- issuing

bool NativePort::may_inject(std::size_t exit) const {
  // A packet in hand goes first. The bubble rule also leaves a place for the ring's own traffic.
  if (machine_.config.topology.flow == Flow::kNone) return out_ports_[exit].egress.size() < kReceiveBatch;
  if (machine_.topology.direct()) return true;
  if (!out_ports_[exit].egress.empty()) return false;
  return machine_.config.topology.flow != Flow::kBubble || out_ports_[exit].link->free_places() >= 2;
}

bool NativePort::free_packet(PacketId& id) {
  bool blocked = false;
  for (std::size_t i = 0; i < free_.size(); ++i) {
    const std::size_t direction = (next_direction_ + i) % free_.size();
    if (free_[direction].empty()) continue;
    if (!may_inject(direction)) {
      blocked = true;
      continue;
    }
    id = free_[direction].back();
    free_[direction].pop_back();
    next_direction_ = direction + 1;
    return true;
  }
  stall(blocked ? StallReason::kLink : StallReason::kCredits);
  return false;
}

bool NativePort::issue(bool partial) {
  const bool stays = machine_.topology.resources() == 1 || machine_.config.collections.home == Home::kLocal;
  bool moved = false;
  // When only partial collections are left, one at a time: the next look at the links may fill the others.
  // Completed rays go to shading while they are still in cache.
  for (int budget = partial ? 1 : 64; budget > 0 && !resource_.idle() && resource_.completed().size() < kCompletedPause;
       --budget) {
    PacketId id;
    Packet* packet = &local_;
    if (!stays) {
      if (!free_packet(id)) return moved;
      packet = &machine_.packet(id);
    }
    const Resource::Offer offer = resource_.offer(partial, *packet);
    if (offer != Resource::Offer::kPacket) {
      if (!stays) free_[packet->direction].push_back(id);
      if (offer == Resource::Offer::kStorage) stall(StallReason::kStorage);
      return moved;
    }
    moved = true;
    if (packet->kind == PacketKind::kTest) resource_.test(*packet);
    if (stays || machine_.topology.hops(*packet) == 0) {
      resource_.retire(*packet);
      if (!stays) free_[packet->direction].push_back(id);
    } else {
      inject(id);
    }
  }
  return moved;
}

void NativePort::flush_completed(bool all) {
  HitBatch& done = resource_.completed();
  const std::size_t enough = std::min<std::size_t>(kCompletedBatch, resource_.rays().slots() / 4 + 1);
  if (done.empty() || (!all && done.size() < enough)) return;
  if (sink_ != nullptr)
    sink_->record(
        {.kind = EventKind::kComplete, .resource = resource_.id(), .rays = static_cast<std::uint32_t>(done.size())});
  rays_completed_ += done.size();
  machine_.control.free(resource_.id(), resource_.freed_slots());
  resource_.freed_slots().clear();
  HitBatch fresh = machine_.completed.fresh();
  done.swap(fresh);
  machine_.completed.push(std::move(fresh));
}

// ---- the end, good or bad

bool NativePort::drained() const {
  const bool egress_empty =
      std::all_of(out_ports_.begin(), out_ports_.end(), [](const OutPort& exit) { return exit.egress.empty(); });
  return packets_out() == 0 && egress_empty && resource_.idle() && waiting_ids_.empty() && waiting_rays_.empty() &&
         resource_.packets_in_flight() == 0 && machine_.control.free_slots(resource_.id()) == resource_.rays().slots();
}

std::string NativePort::describe() const {
  std::string text = fmt::format("resource {}: {} of {} slots free, {} collections with {} memberships, {} packets out",
                                 resource_.id().value, machine_.control.free_slots(resource_.id()),
                                 resource_.rays().slots(), resource_.collections().collections(),
                                 resource_.collections().memberships(), resource_.packets_in_flight());
  std::size_t rays = 0;
  for (const std::vector<RayId>& ids : waiting_ids_) rays += ids.size();
  for (const RayGroup& group : waiting_rays_) rays += group.rays.size();
  if (rays > 0) text += fmt::format(", {} new rays wait", rays);
  for (const OutPort& exit : out_ports_) {
    if (exit.egress.empty()) continue;
    const Packet& packet = machine_.packet(exit.egress.front());
    text += fmt::format("; packet {} of resource {}", exit.egress.front().value, packet.owner.value);
    if (!packet.members.empty())
      text += fmt::format(" (first ray {}:{})", resource_.rays().layout().owner(packet.members[0].ray).value,
                          resource_.rays().layout().slot(packet.members[0].ray));
    text += fmt::format(" waits for a place in the link to resource {} (depth {}, {} more in hand)",
                        exit.link->to().value, exit.link->capacity(), exit.egress.size() - 1);
  }
  return text;
}

}  // namespace carousel::ringbus
