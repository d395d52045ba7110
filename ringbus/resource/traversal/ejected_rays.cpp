#include "ringbus/resource/traversal/ejected_rays.h"

#include <algorithm>
#include <bit>

namespace carousel::ringbus {

EjectedRays::EjectedRays(const BundlesConfig& config, float scene_size, RayStore& store) : store_(store) {
  if (config.lifetime == BundlesConfig::Lifetime::kReformed || config.split == BundlesConfig::Split::kBuilder)
    builder_.emplace(config, scene_size);
}

void EjectedRays::send(Packet& packet, std::vector<std::uint32_t>& free_bundles) {
  if (!builder_) {
    for (const EjectedRay& ray : rays_) send_alone(packet, ray.slot, ray.mask);
    return;
  }
  std::stable_sort(rays_.begin(), rays_.end(),
                   [](const EjectedRay& a, const EjectedRay& b) { return a.mask < b.mask; });
  for (std::size_t first = 0, end; first < rays_.size(); first = end) {
    for (end = first; end < rays_.size() && rays_[end].mask == rays_[first].mask;) ++end;
    send_bundles(packet, first, end, free_bundles);
  }
}

void EjectedRays::send_alone(Packet& packet, std::uint32_t slot, std::uint8_t mask) {
  store_.record(slot).pending += std::popcount(mask);
  packet.members.push_back({store_.id(slot), mask});
}

/// Sends the rays in [first, end), which all go on to the same children.
void EjectedRays::send_bundles(Packet& packet, std::size_t first, std::size_t end,
                               std::vector<std::uint32_t>& free_bundles) {
  const std::uint8_t mask = rays_[first].mask;
  requests_.clear();
  for (std::size_t i = first; i < end; ++i) {
    const RayRecord& record = store_.record(rays_[i].slot);
    requests_.push_back({record.ray, record.tag});
  }
  builder_->group(requests_, order_, sizes_);
  std::size_t at = 0;
  for (const std::uint8_t size : sizes_) {
    slots_.clear();
    for (std::size_t i = at; i < at + size; ++i) slots_.push_back(rays_[first + order_[i]].slot);
    at += size;
    if (size == 1 || free_bundles.empty()) {
      for (const std::uint32_t slot : slots_) send_alone(packet, slot, mask);
      continue;
    }
    for (const std::uint32_t slot : slots_) ++store_.record(slot).pending;
    const auto tests = static_cast<std::int16_t>(std::popcount(mask));
    packet.members.push_back({store_.make_bundle(free_bundles.back(), slots_, tests), mask});
    free_bundles.pop_back();
  }
}

}  // namespace carousel::ringbus
