#pragma once

#include <cstdint>
#include <optional>

#include "accel/structure/accel.h"

namespace carousel::ringbus {

/// The subtrees that one visit takes rays through: those of `bvh.treelet_triangles` triangles or fewer, and none unless
/// the traversal is `treelet`. No subtree is one that lies at several ranks.
class Treelets {
 public:
  /// Keeps a reference. Without `most_triangles` no subtree is a treelet.
  Treelets(const accel::Accel& accel, std::optional<std::uint64_t> most_triangles)
      : accel_(accel), most_triangles_(most_triangles) {}

  bool contains(accel::NodeKey key) const {
    return most_triangles_ && accel_.triangles_below(key) <= *most_triangles_ && !spans_ranks(key);
  }

 private:
  /// Below nodes that every rank of a partitioned scene has are shapes of several ranks.
  bool spans_ranks(accel::NodeKey key) const { return accel_.partition && accel_.partition->above(key.ref); }

  const accel::Accel& accel_;
  std::optional<std::uint64_t> most_triangles_;
};

}  // namespace carousel::ringbus
