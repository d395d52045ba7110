#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "scene/model/scene.h"

namespace carousel::shading {

/// One triangle or sphere of one instance that gives off light.
struct EmissivePrimitive {
  std::uint32_t instance = 0, primitive = 0;
  float area = 0;  ///< world; of a triangle
  float flux = 0;  ///< estimated luminance, all emitting sides; 0 if nothing was found by sampling its texture
};

/// Every emissive triangle and sphere of a scene, instance by instance, in the order of the mesh.
class EmissivePrimitives {
 public:
  explicit EmissivePrimitives(const scene::Scene& scene);

  const std::vector<EmissivePrimitive>& all() const { return primitives_; }
  /// Index of a primitive in all(). Precondition: its material is emissive.
  std::uint32_t index_of(const scene::Scene& scene, std::uint32_t instance, std::uint32_t primitive) const {
    return first_[instance] + rank_[scene.instances[instance].mesh.value][primitive];
  }

 private:
  std::vector<EmissivePrimitive> primitives_;
  std::vector<std::uint32_t> first_;              // by instance; empty if the scene has none
  std::vector<std::vector<std::uint32_t>> rank_;  // by mesh and primitive; empty for meshes without any
};

}  // namespace carousel::shading
