#include "ringbus/resource/traversal/ejected_rays.h"

#include <algorithm>

namespace carousel::ringbus {

EjectedRays::EjectedRays(const BundlesConfig& config, float scene_size, RayStore& store)
    : store_(store), most_(static_cast<std::uint8_t>(config.size)) {
  if (config.lifetime == BundlesConfig::Lifetime::kReformed || config.split != BundlesConfig::Split::kTester)
    builder_.emplace(config, scene_size);
}

void EjectedRays::send(Packet& packet, std::vector<std::uint32_t>& free_bundles) {
  if (!builder_) {
    for (const EjectedRay& ray : rays_) send_alone(packet, ray);
    return;
  }
  std::stable_sort(rays_.begin(), rays_.end(), [](const EjectedRay& a, const EjectedRay& b) { return a < b; });
  for (std::size_t first = 0, end; first < rays_.size(); first = end) {
    for (end = first; end < rays_.size() && (rays_[end] <=> rays_[first]) == 0;) ++end;
    send_bundles(packet, first, end, free_bundles);
  }
}

void EjectedRays::send_alone(Packet& packet, const EjectedRay& ray) {
  store_.record(ray.slot).pending += ray.tests();
  packet.members.push_back({store_.id(ray.slot), ray.mask, ray.mask == 0});
}

/// Sends the rays in [first, end), which all go on to the same children.
void EjectedRays::send_bundles(Packet& packet, std::size_t first, std::size_t end,
                               std::vector<std::uint32_t>& free_bundles) {
  const EjectedRay group = rays_[first];
  requests_.clear();
  for (std::size_t i = first; i < end; ++i) {
    const RayRecord& record = store_.record(rays_[i].slot);
    requests_.push_back({record.ray, record.tag});
  }
  builder_->group(requests_, order_, sizes_, group.most);
  std::size_t at = 0;
  for (const std::uint8_t size : sizes_) {
    slots_.clear();
    for (std::size_t i = at; i < at + size; ++i) slots_.push_back(rays_[first + order_[i]].slot);
    at += size;
    if (size == 1 || free_bundles.empty()) {
      for (const std::uint32_t slot : slots_) send_alone(packet, {slot, group.mask, group.most});
      continue;
    }
    for (const std::uint32_t slot : slots_) ++store_.record(slot).pending;
    const auto tests = static_cast<std::int16_t>(group.tests());
    packet.members.push_back({store_.make_bundle(free_bundles.back(), slots_, tests), group.mask, group.mask == 0});
    free_bundles.pop_back();
  }
}

}  // namespace carousel::ringbus
