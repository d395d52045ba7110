#pragma once

#include <cstdint>
#include <optional>

#include "accel/structure/partition.h"
#include "core/config/fields/collections.h"
#include "core/types/ids.h"
#include "ringbus/rays/rank_share.h"

namespace carousel::ringbus {

/// Says at which resource a node's rays are collected (`collections.home`): where their packet was issued, or with
/// `hash` at the resource that a hash of the node names; with `scene.placement: partitioned` one of the rank that has
/// the node, if not all have it.
class Homes {
 public:
  /// For the collections of resource `self`. Keeps a pointer to `partition`, which may be null.
  Homes(Home home, ResourceId self, std::uint32_t resources, const accel::Partition* partition = nullptr)
      : hash_(home == Home::kHash), self_(self), resources_(resources), partition_(partition) {}

  ResourceId of(accel::NodeKey key) const {
    if (!hash_) return self_;
    const std::uint64_t hash = (key.bits() * 0x9e3779b97f4a7c15ull) >> 33;
    if (partition_ != nullptr)
      if (const std::optional<std::uint32_t> rank = partition_->home(key.ref)) {
        const RankShare share(*rank, partition_->ranks(), resources_);
        return ResourceId(share.arc_begin() + static_cast<std::uint32_t>(hash % share.arc_size()));
      }
    const ResourceId home(static_cast<std::uint32_t>(hash % resources_));
    return home == excluded_ ? ResourceId((home.value + 1) % resources_) : home;
  }
  /// The node is at another rank alone: nothing may be read of it here.
  bool away(accel::NodeKey key) const { return partition_ != nullptr && !partition_->here(key.ref); }
  /// From now on `resource`, which has stopped, is no home; the next one takes its nodes.
  void exclude(ResourceId resource) { excluded_ = resource; }

 private:
  bool hash_;
  ResourceId self_;
  std::uint32_t resources_;
  const accel::Partition* partition_;
  std::optional<ResourceId> excluded_;
};

}  // namespace carousel::ringbus
