#include "ringbus/resource/storage_rule.h"

#include <algorithm>

#include "ringbus/resource/traversal/make_traversal.h"

namespace carousel::ringbus {

std::int64_t most_blocks(const PacketsConfig& packets, const BundlesConfig& bundles, int width) {
  if (packets.made_per == MadePer::kChild) return std::max<std::int64_t>(width, accel::kMaxLeafTriangles);
  return width * std::max<std::int64_t>(1, bundles.size);
}

std::uint32_t reserve_blocks(const CollectionsConfig& collections, const PacketsConfig& packets,
                             const BundlesConfig& bundles, int width, int max_depth) {
  if (one_collection_a_ray(collections.traversal)) return 0;
  const std::int64_t children = most_blocks(packets, bundles, width);
  return static_cast<std::uint32_t>((children - 1) * (max_depth + 1) + children);
}

std::int64_t block_rays(const CollectionsConfig& collections, const PacketsConfig& packets) {
  return one_collection_a_ray(collections.traversal) ? 1 : packets.rays;
}

StorageRule::StorageRule(const CollectionsConfig& config, std::int64_t block_rays, std::uint32_t reserve,
                         std::int64_t collections, const CollectionStore& store)
    : bounded_(config.when_full == WhenFull::kReserve),
      single_(one_collection_a_ray(config.traversal)),
      block_rays_(block_rays),
      blocks_(config.capacity / block_rays),
      reserve_(reserve),
      collections_(collections),
      store_(store) {}

std::size_t StorageRule::admissible() const {
  constexpr std::size_t kAny = std::size_t{1} << 31;
  if (!bounded_) return kAny;
  // Each ray has one ID in the collections, or is in a packet and will come back with one.
  if (single_) return static_cast<std::size_t>(std::max<std::int64_t>(0, blocks_ - rays_held_));
  // Only above half free: the new rays in the root's collection must never crowd out their children.
  const std::int64_t room = store_.free_blocks() - blocks_promised_ - std::max<std::int64_t>(reserve_, blocks_ / 2);
  return room <= 0 ? 0 : static_cast<std::size_t>(room / collections_ * block_rays_);
}

bool StorageRule::fits(std::uint32_t needed, std::uint32_t freed) const {
  return !bounded_ || store_.free_blocks() + freed - blocks_promised_ - needed >= reserve_;
}

void StorageRule::retire(std::uint32_t needed, std::size_t rays, std::size_t joined) {
  blocks_promised_ -= needed;
  if (single_ && bounded_) rays_held_ -= static_cast<std::uint32_t>(rays - joined);
}

}  // namespace carousel::ringbus
