#include "ringbus/protocol/ray_rounds.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace carousel::ringbus {

void RayRounds::add(RayGroup& group) {
  if (group.rays.empty()) return;
  waiting_.push_back({{}, std::move(group.rays), std::move(group.addresses)});
  group.rays.clear();
  group.addresses.clear();
}

std::size_t RayRounds::rays() const {
  std::size_t rays = 0;
  for (const RayGroup& group : waiting_) rays += group.rays.size();
  return rays;
}

bool RayRounds::has_room(const RayGroup& group) const {
  if (group.addresses.empty()) return machine_.control.free_slots() > 0;
  return std::any_of(group.addresses.begin(), group.addresses.end(),
                     [&](ResourceId r) { return machine_.control.free_slots(r) > 0; });
}

void RayRounds::load(RayGroup& group, Packet& packet) const {
  packet.kind = PacketKind::kRays;
  packet.requests = std::move(group.rays);
  packet.addresses = std::move(group.addresses);
  packet.members.clear();
  packet.hops_left = static_cast<std::uint32_t>(machine_.topology.resources() - 1);
  group.rays.clear();
  group.addresses.clear();
}

std::vector<RayId> RayRounds::take_slots(Packet& packet) {
  const bool addressed = !packet.addresses.empty();
  // The rest of the ring is left its share: the rays left over the resources left, counting this one.
  std::size_t share = packet.requests.size();
  if (!addressed) share = (share + packet.hops_left) / (packet.hops_left + 1);
  if (packet.hops_left > 0) --packet.hops_left;
  std::vector<RayId> own;
  std::size_t kept = 0, taken = 0;
  for (std::size_t i = 0; i < packet.requests.size(); ++i) {
    if (taken < share && (!addressed || packet.addresses[i] == here_)) {
      if (const std::optional<RayId> id = machine_.control.load(here_, packet.requests[i])) {
        ++taken;
        if (machine_.home_local)
          own.push_back(*id);
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
  return own;
}

RayGroup RayRounds::unload(Packet& packet) const {
  RayGroup group;
  for (const PacketMember& member : packet.members) group.ids.push_back(member.ray);
  group.rays.swap(packet.requests);
  group.addresses.swap(packet.addresses);
  return group;
}

}  // namespace carousel::ringbus
