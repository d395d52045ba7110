#include "accel/traverse/hit_oracle.h"

#include "accel/traverse/ray_check.h"

namespace carousel::accel {

HitOracle::HitOracle(const scene::Scene& scene, const AccuracyConfig& accuracy, const AnyHit* any_hit)
    : box_(accuracy.box), primitives_(scene, accuracy, any_hit) {
  std::vector<std::optional<std::uint32_t>> tree_of_mesh(scene.meshes.size());
  for (std::uint32_t i = 0; i < primitives_.instances(); ++i) {
    std::optional<std::uint32_t>& shared = tree_of_mesh[scene.instances[i].mesh.value];
    const bool baked = primitives_.baked(i);
    if (baked || !shared) {
      const auto made = static_cast<std::uint32_t>(meshes_.size());
      meshes_.emplace_back(primitives_.primitives(i), [&](std::uint32_t p) { return primitives_.box(i, p); });
      tree_of_.push_back(made);
      if (!baked) shared = made;
    } else {
      tree_of_.push_back(*shared);
    }
    primitives_.set_model_box(i, meshes_[tree_of_[i]].box());
  }
  instances_.emplace(primitives_.instances(), [&](std::uint32_t i) { return primitives_.world_box(i); });
}

Hit HitOracle::trace(const RayRequest& request) const {
  Hit best;
  if (!valid(request.ray)) return best;
  best.t = request.ray.tmax;
  const OracleBoxTest boxes(request.ray, box_);
  const auto enters = [&](const Aabb& box, float& entry) { return boxes.enters(box, best.t, entry); };
  instances_->walk(enters, [&](std::uint32_t i) {
    float entry;
    return !enters(primitives_.world_box(i), entry) || !trace_instance(request, i, entry, best);
  });
  return best.valid() ? best : Hit{};
}

bool HitOracle::trace_instance(const RayRequest& request, std::uint32_t instance, float entry, Hit& best) const {
  const OraclePrimitives::LocalRay ray = primitives_.local_ray(request.ray, instance, entry);
  bool over = false;
  meshes_[tree_of_[instance]].walk(
      [&](const Aabb& box, float& at) { return ray.boxes.enters(box, best.t, at); },
      [&](std::uint32_t primitive) {
        OraclePrimitives::Candidates found;
        const int count = primitives_.cross(ray, primitive, best.t, found);
        for (int k = 0; k < count && !over; ++k) {
          const OraclePrimitives::Candidate& candidate = found[static_cast<std::size_t>(k)];
          const Hit& hit = candidate.hit;
          // At equal distances the smaller instance wins, and then the smaller primitive.
          const bool nearer = hit.t < best.t ||
                              (hit.t == best.t && (hit.instance < best.instance ||
                                                   (hit.instance == best.instance && hit.primitive < best.primitive)));
          if (!nearer || !primitives_.accepts(request, candidate)) continue;
          best = hit;
          over = takes_any_hit(request.tag);
        }
        return !over;
      });
  return over;
}

std::size_t HitOracle::size_bytes() const {
  std::size_t bytes = instances_->size_bytes() + tree_of_.size() * sizeof(std::uint32_t) + primitives_.size_bytes();
  for (const OracleTree& tree : meshes_) bytes += tree.size_bytes();
  return bytes;
}

std::size_t HitOracle::foretold_bytes(const scene::Scene& scene) {
  std::size_t bytes = OracleTree::most_bytes(scene.instances.size()) +
                      scene.instances.size() * (sizeof(std::uint32_t) + OraclePrimitives::kInstanceBytes);
  for (const scene::Mesh& mesh : scene.meshes)
    bytes += OracleTree::most_bytes(mesh.triangle_count() + mesh.spheres.size());
  return bytes;
}

}  // namespace carousel::accel
