#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "accel/traverse/oracle_primitive.h"
#include "accel/traverse/oracle_tree.h"
#include "core/config/fields/accuracy.h"
#include "core/types/any_hit.h"
#include "core/types/workload.h"
#include "scene/model/scene.h"

namespace carousel::accel {

/// Answers for rays by a second way, with which `verify: reference` compares: the scene's own triangles and spheres, in
/// binary trees of its own, tested one by one in scalar code. It knows no Accel: neither nodes nor blocks, quantised or
/// not, nor groups, planes, elements or merged meshes. docs/reference/verify.md lists what the two share. Immutable
/// once built; any thread may call.
class HitOracle {
 public:
  /// Keeps references to the scene and to `any_hit` (null: every surface is opaque).
  HitOracle(const scene::Scene& scene, const AccuracyConfig& accuracy, const AnyHit* any_hit);

  /// The closest hit; of a ray that any hit ends some hit, which need not be the closest.
  Hit trace(const RayRequest& request) const;
  /// The `k` nearest hits, sorted: by distance, instance, primitive and where they lie on it.
  std::vector<Hit> nearest(const RayRequest& request, std::size_t k) const;
  /// Bytes of the trees and of the records of instances.
  std::size_t size_bytes() const;
  /// At most so many for a scene without flattened instances.
  static std::size_t foretold_bytes(const scene::Scene& scene);

 private:
  /// Lowers `best` to hits in an instance. True if the search is over.
  bool trace_instance(const RayRequest& request, std::uint32_t instance, float entry, Hit& best) const;

  /// Adds to `best`, which has `k` at most, the hits in an instance that are among the nearest; `bound`: no farther
  /// one is.
  void nearest_in_instance(const RayRequest& request, std::uint32_t instance, float entry, std::size_t k, float& bound,
                           std::vector<Hit>& best) const;

  BoxLevel box_;
  OraclePrimitives primitives_;
  std::vector<OracleTree> meshes_;       // in model space, or of one baked instance
  std::vector<std::uint32_t> tree_of_;   // by instance, in meshes_
  std::optional<OracleTree> instances_;  // over world boxes
};

}  // namespace carousel::accel
