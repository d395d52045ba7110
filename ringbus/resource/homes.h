#pragma once

#include <cstdint>
#include <optional>

#include "accel/structure/node.h"
#include "core/config/config.h"
#include "core/types/ids.h"

namespace carousel::ringbus {

/// Says at which resource a node's rays are collected (`collections.home`): where their packet was issued, or with
/// `hash` at the resource that a hash of the node names.
class Homes {
 public:
  /// For the collections of resource `self`.
  Homes(Home home, ResourceId self, std::uint32_t resources)
      : hash_(home == Home::kHash), self_(self), resources_(resources) {}

  ResourceId of(accel::NodeKey key) const {
    if (!hash_) return self_;
    const ResourceId home(static_cast<std::uint32_t>(((key.bits() * 0x9e3779b97f4a7c15ull) >> 33) % resources_));
    return home == excluded_ ? ResourceId((home.value + 1) % resources_) : home;
  }
  /// From now on `resource`, which has stopped, is no home; the next one takes its nodes.
  void exclude(ResourceId resource) { excluded_ = resource; }

 private:
  bool hash_;
  ResourceId self_;
  std::uint32_t resources_;
  std::optional<ResourceId> excluded_;
};

}  // namespace carousel::ringbus
