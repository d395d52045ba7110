#pragma once

#include "accel/box/bundle.h"
#include "accel/structure/accel.h"
#include "core/config/fields/bundles.h"

namespace carousel::ringbus {

/// Says where bundles are split into their rays (`bundles.split_below`, `split_above`, `at_instances`).
class BundleSplitRule {
 public:
  /// Keeps a reference to `accel`. `scene_size` is the scale of `split_below.box_size`.
  BundleSplitRule(const BundlesConfig& config, const accel::Accel& accel, float scene_size);

  /// True if every bundle is split at the inner node `key`, which is `depth` strips below the root.
  bool at_node(accel::NodeKey key, std::uint16_t depth) const;
  /// True if a bundle, in the node's space, is split there for its spread or its silhouette's area: for how large a box
  /// its rays fill by the time they have come as far as the node's middle, seen from where they come.
  bool too_wide(const accel::BundleRecord& bundle, const accel::Node& node) const;
  /// True if the key is below an instance with a transform.
  bool in_model_space(accel::NodeKey key) const;

 private:
  const accel::Accel& accel_;
  BundlesConfig::SplitBelow below_;
  BundlesConfig::SplitAbove above_;
  bool at_instances_;
  float smallest_box_;  // an extent; 0: any
};

}  // namespace carousel::ringbus
