#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "accel/structure/number_ranges.h"
#include "core/types/ray.h"

namespace carousel::accel {

/// Meshes that have one structure together (`bvh.merge: world`), whose nodes hang in the top level: keys below it have
/// no instance. Their triangles are numbered through in it, mesh by mesh; a hit names a triangle's own instance and
/// number. Immutable once built; any thread may read.
class MergedMeshes {
 public:
  /// The instance that keeps the structure's root, the first of the meshes'; with kNoInstance nothing is merged.
  std::uint32_t instance() const { return instances_.empty() ? kNoInstance : instances_.front(); }
  std::size_t count() const { return instances_.size(); }
  bool holds(std::uint32_t instance) const {
    return std::binary_search(instances_.begin(), instances_.end(), instance);
  }

  struct Name {
    std::uint32_t instance, primitive;
  };
  /// Precondition: `primitive` is less than the sum of the triangles that were added.
  Name name(std::uint32_t primitive) const {
    const NumberRanges::Place place = ranges_.place(primitive);
    return {instances_[place.range], place.index};
  }

  /// The mesh of another instance, whose triangles begin at number `first`. Both ascend.
  void add(std::uint32_t instance, std::uint32_t first) {
    instances_.push_back(instance);
    ranges_.add(first);
  }

 private:
  std::vector<std::uint32_t> instances_;  // one a mesh
  NumberRanges ranges_;                   // likewise
};

}  // namespace carousel::accel
