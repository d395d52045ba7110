#include "accel/traverse/hit_oracle.h"

#include <algorithm>
#include <tuple>

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

std::vector<Hit> HitOracle::nearest(const RayRequest& request, std::size_t k) const {
  std::vector<Hit> best;
  if (!valid(request.ray)) return best;
  float bound = request.ray.tmax;
  const OracleBoxTest boxes(request.ray, box_);
  const auto enters = [&](const Aabb& box, float& entry) { return boxes.enters(box, bound, entry); };
  instances_->walk(enters, [&](std::uint32_t i) {
    float entry;
    if (enters(primitives_.world_box(i), entry)) nearest_in_instance(request, i, entry, k, bound, best);
    return true;
  });
  return best;
}

void HitOracle::nearest_in_instance(const RayRequest& request, std::uint32_t instance, float entry, std::size_t k,
                                    float& bound, std::vector<Hit>& best) const {
  const auto before = [](const Hit& a, const Hit& b) {
    return std::tie(a.t, a.instance, a.primitive, a.u, a.v) < std::tie(b.t, b.instance, b.primitive, b.u, b.v);
  };
  const OraclePrimitives::LocalRay ray = primitives_.local_ray(request.ray, instance, entry);
  meshes_[tree_of_[instance]].walk(
      [&](const Aabb& box, float& at) { return ray.boxes.enters(box, bound, at); },
      [&](std::uint32_t primitive) {
        OraclePrimitives::Candidates found;
        const int count = primitives_.cross(ray, primitive, bound, found);
        for (int i = 0; i < count; ++i) {
          const OraclePrimitives::Candidate& candidate = found[static_cast<std::size_t>(i)];
          if (candidate.hit.t > bound || !primitives_.accepts(request, candidate)) continue;
          // A sphere that is touched, or a program, may give one hit twice.
          const auto at = std::lower_bound(best.begin(), best.end(), candidate.hit, before);
          if (at != best.end() && !before(candidate.hit, *at)) continue;
          best.insert(at, candidate.hit);
          if (best.size() > k) best.pop_back();
          if (best.size() == k) bound = best.back().t;
        }
        return true;
      });
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
